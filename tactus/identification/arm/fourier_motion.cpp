// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/arm/fourier_motion.hpp>

#include <cmath>
#include <numbers>
#include <utility>

namespace tactus::arm_identification {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Columns of length 1 that span what is orthogonal to `to`: those of Householder's reflection but the first.
MatrixXd orthogonal_to(const VectorXd& to) {
  VectorXd mirror = to;
  mirror[0] += to.norm();
  const MatrixXd reflection =
      MatrixXd::Identity(to.size(), to.size()) - 2.0 / mirror.squaredNorm() * mirror * mirror.transpose();
  return reflection.rightCols(to.size() - 1);
}

}  // namespace

FourierMotion::FourierMotion(double period_s, int harmonics, MatrixXd coordinates)
    : period_s_(period_s), harmonics_(harmonics), coordinates_(std::move(coordinates)) {}

MatrixXd FourierMotion::rows(double period_s, int harmonics, double time_s) {
  const double base = 2.0 * std::numbers::pi / period_s;
  MatrixXd of_sines(3, harmonics);
  MatrixXd of_cosines(3, harmonics);
  VectorXd order(harmonics);
  for (int k = 1; k <= harmonics; ++k) {
    const double w = base * k;
    const double s = std::sin(w * time_s);
    const double c = std::cos(w * time_s);
    of_sines.col(k - 1) << s / w, c, -w * s;
    of_cosines.col(k - 1) << -c / w, s, w * c;
    order[k - 1] = k;
  }
  MatrixXd found(3, coordinates(harmonics));
  found.col(0) << 1.0, 0.0, 0.0;
  found.middleCols(1, harmonics - 1) = of_sines * orthogonal_to(VectorXd::Ones(harmonics));
  found.rightCols(harmonics - 1) = of_cosines * orthogonal_to(order);
  return found;
}

FourierMotion::State FourierMotion::at(double time_s) const {
  const MatrixXd by_coordinate = rows(period_s_, harmonics_, time_s);
  return {coordinates_ * by_coordinate.row(0).transpose(), coordinates_ * by_coordinate.row(1).transpose(),
          coordinates_ * by_coordinate.row(2).transpose()};
}

FourierMotion FourierMotion::scaled(double share) const {
  MatrixXd smaller = coordinates_;
  smaller.rightCols(smaller.cols() - 1) *= share;
  return {period_s_, harmonics_, std::move(smaller)};
}

}  // namespace tactus::arm_identification
