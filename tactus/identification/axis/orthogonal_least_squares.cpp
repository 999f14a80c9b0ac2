// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/orthogonal_least_squares.hpp>

#include <cmath>
#include <string>

#include <Eigen/Dense>

namespace tactus::identification {

Result<std::vector<RankedRegressor>> rank_regressors(std::span<const double> regressors, std::size_t columns,
                                                     std::span<const double> observations, std::size_t most) {
  const std::size_t rows = observations.size();
  if (columns == 0 || rows == 0 || regressors.size() != rows * columns) {
    return Error{ErrorCode::inconsistent,
                 {},
                 std::to_string(columns) + " regressors of " + std::to_string(rows) + " observations need " +
                     std::to_string(rows * columns) + " values and at least one, not " +
                     std::to_string(regressors.size()),
                 {}};
  }
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::MatrixXd fresh =
      Eigen::Map<const Rows>(regressors.data(), static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
  Eigen::VectorXd rest = Eigen::Map<const Eigen::VectorXd>(observations.data(), static_cast<Eigen::Index>(rows));
  if (!fresh.allFinite() || !rest.allFinite()) {
    return Error{ErrorCode::out_of_bounds, {}, "the data of the fit hold a value that is not a finite number", {}};
  }
  const double squares = rest.squaredNorm();
  if (squares == 0.0) return Error{ErrorCode::inconsistent, {}, "all observations are 0: there is nothing to fit", {}};
  const Eigen::VectorXd lengths = fresh.colwise().norm();

  constexpr double least_new = 1e-8, least_rest = 1e-24;
  const auto n = static_cast<double>(rows);
  double criterion = n * std::log(squares / n);
  std::vector<RankedRegressor> chosen;
  while (chosen.size() < most && rest.squaredNorm() > least_rest * squares) {
    Eigen::Index best = -1;
    double largest = 0.0;
    for (Eigen::Index column = 0; column < fresh.cols(); ++column) {
      const double length = fresh.col(column).norm();
      if (!(length > least_new * lengths[column])) continue;
      const double explained = std::pow(fresh.col(column).dot(rest) / length, 2);
      if (explained > largest) largest = explained, best = column;
    }
    if (best < 0) break;
    const Eigen::VectorXd direction = fresh.col(best).normalized();
    const Eigen::VectorXd left = rest - direction * direction.dot(rest);
    const double next = n * std::log(left.squaredNorm() / n) + static_cast<double>(chosen.size() + 1) * std::log(n);
    if (!(next < criterion)) break;
    criterion = next;
    rest = left;
    chosen.push_back({static_cast<std::size_t>(best), largest / squares});
    fresh -= direction * (direction.transpose() * fresh);
    fresh.col(best).setZero();
  }
  return chosen;
}

}  // namespace tactus::identification
