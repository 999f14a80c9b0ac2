// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/decompositions.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>

namespace tactus::signal {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

namespace {

using PivotedQr = Eigen::ColPivHouseholderQR<MatrixXd>;

PivotedQr pivoted(const MatrixXd& a, double smallest_pivot) {
  PivotedQr qr;
  qr.setThreshold(smallest_pivot);
  qr.compute(a);
  return qr;
}

}  // namespace

VectorXd solve_least_squares(const MatrixXd& a, const VectorXd& b) { return PivotedQr(a).solve(b); }

MatrixXd solve_shortest(const MatrixXd& a, const MatrixXd& b) {
  return Eigen::CompleteOrthogonalDecomposition<MatrixXd>(a).solve(b);
}

Regression regress(const MatrixXd& a, const VectorXd& b, double smallest_pivot) {
  const PivotedQr qr = pivoted(a, smallest_pivot);
  const Eigen::Index columns = a.cols();
  if (qr.rank() < columns) return {.idle = qr.colsPermutation().indices()[qr.rank()], .x = {}, .spread = {}};
  const MatrixXd inverse_r = qr.matrixR()
                                 .topLeftCorner(columns, columns)
                                 .triangularView<Eigen::Upper>()
                                 .solve(MatrixXd::Identity(columns, columns));
  return {.idle = std::nullopt,
          .x = qr.solve(b),
          .spread = qr.colsPermutation() * VectorXd(inverse_r.rowwise().squaredNorm())};
}

Eigen::Index rank(const MatrixXd& a, double smallest_pivot) { return pivoted(a, smallest_pivot).rank(); }

VectorXd solve_definite(const MatrixXd& a, const VectorXd& b) { return Eigen::LDLT<MatrixXd>(a).solve(b); }

MatrixXd inverse_of_definite(const MatrixXd& a) {
  return Eigen::LDLT<MatrixXd>(a).solve(MatrixXd::Identity(a.rows(), a.cols()));
}

MatrixXd solve(const MatrixXd& a, const MatrixXd& b) { return a.partialPivLu().solve(b); }
MatrixXcd complex_solve(const MatrixXcd& a, const MatrixXcd& b) { return a.partialPivLu().solve(b); }

MatrixXd inverse(const MatrixXd& a) { return a.inverse(); }

SymmetricEigen symmetric_eigen(const MatrixXd& a) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(a);
  return {.values = solver.eigenvalues(), .vectors = solver.eigenvectors()};
}

VectorXd symmetric_eigenvalues(const MatrixXd& a) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(a, Eigen::EigenvaluesOnly).eigenvalues();
}

ComplexEigen complex_eigen(const MatrixXcd& a) {
  const Eigen::ComplexEigenSolver<MatrixXcd> solver(a);
  return {.values = solver.eigenvalues(), .vectors = solver.eigenvectors()};
}

VectorXcd complex_eigenvalues(const MatrixXcd& a) {
  return Eigen::ComplexEigenSolver<MatrixXcd>(a, false).eigenvalues();
}

}  // namespace tactus::signal
