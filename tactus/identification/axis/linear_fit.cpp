// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/linear_fit.hpp>
#include <tactus/identification/axis/refusal.hpp>
#include <tactus/kernel/signal/decompositions.hpp>

#include <cmath>
#include <string>

#include <Eigen/Core>

namespace tactus::identification {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr double smallest_pivot = 1e-10;

}  // namespace

Result<LinearFit> fit_linear(std::span<const double> regressors, std::size_t columns,
                             std::span<const double> observations) {
  const std::size_t rows = observations.size();
  if (columns == 0 || regressors.size() != rows * columns) {
    return inconsistent("a fit of " + std::to_string(columns) + " parameters to " + std::to_string(rows) +
                        " observations needs " + std::to_string(rows * columns) + " regressor values, not " +
                        std::to_string(regressors.size()));
  }
  if (rows <= columns) {
    return inconsistent(std::to_string(rows) + " observations cannot determine " + std::to_string(columns) +
                        " parameters and their uncertainty; record more samples");
  }
  const Eigen::Map<const Matrix> a(regressors.data(), static_cast<Eigen::Index>(rows),
                                   static_cast<Eigen::Index>(columns));
  const Eigen::Map<const Eigen::VectorXd> b(observations.data(), static_cast<Eigen::Index>(rows));
  if (!a.allFinite() || !b.allFinite()) {
    return Error{ErrorCode::out_of_bounds, {}, "the data of the fit hold a value that is not a finite number", {}};
  }

  Eigen::VectorXd lengths = a.colwise().norm();
  for (Eigen::Index column = 0; column < lengths.size(); ++column) {
    if (lengths[column] == 0) lengths[column] = 1;
  }
  const Eigen::MatrixXd scaled = a * lengths.cwiseInverse().asDiagonal();
  const signal::Regression found = signal::regress(scaled, b, smallest_pivot);
  if (found.idle) {
    return inconsistent("the data cannot distinguish the parameters: column " + std::to_string(*found.idle) +
                        " of the regressors adds nothing to the others; excite the device more richly");
  }

  const double squares = (scaled * found.x - b).squaredNorm();
  const double variance = squares / static_cast<double>(rows - columns);

  LinearFit fit;
  for (Eigen::Index column = 0; column < a.cols(); ++column) {
    fit.parameters.push_back(found.x[column] / lengths[column]);
    fit.standard_errors.push_back(std::sqrt(variance * found.spread[column]) / lengths[column]);
  }
  fit.residual_rms = std::sqrt(squares / static_cast<double>(rows));
  return fit;
}

}  // namespace tactus::identification
