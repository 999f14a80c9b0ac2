// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/matrix_functions.hpp>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <unsupported/Eigen/MatrixFunctions>

namespace tactus::signal {

namespace {

using RowByRow = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace

void exponentiate(std::span<double> matrix, std::size_t size) {
  const auto rows = static_cast<Eigen::Index>(size);
  Eigen::Map<RowByRow> map(matrix.data(), rows, rows);
  const Eigen::MatrixXd before = map;
  map = before.exp();
}

std::vector<std::complex<double>> eigenvalues(std::span<const double> matrix, std::size_t size) {
  const auto rows = static_cast<Eigen::Index>(size);
  const Eigen::MatrixXd copy = Eigen::Map<const RowByRow>(matrix.data(), rows, rows);
  const Eigen::VectorXcd values = copy.eigenvalues();
  return {values.begin(), values.end()};
}

}  // namespace tactus::signal
