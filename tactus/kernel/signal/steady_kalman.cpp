// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/decompositions.hpp>
#include <tactus/kernel/signal/matrix_functions.hpp>
#include <tactus/kernel/signal/steady_kalman.hpp>

#include <algorithm>
#include <complex>
#include <span>

#include <Eigen/Core>

namespace tactus::signal {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowByRow = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The covariance of the prediction in the steady state, by doubling: round k has seen 2^k samples.
MatrixXd steady_covariance(const MatrixXd& transition, const MatrixXd& noise, double measurement_variance) {
  constexpr int rounds = 60;
  const auto identity = MatrixXd::Identity(transition.rows(), transition.cols());
  MatrixXd a = transition.transpose();
  MatrixXd g = MatrixXd::Zero(transition.rows(), transition.cols());
  g(0, 0) = 1.0 / measurement_variance;
  MatrixXd h = noise;
  for (int round = 0; round < rounds; ++round) {
    const MatrixXd shrunk = inverse(identity + g * h);
    const MatrixXd next_g = g + a * shrunk * g * a.transpose();
    h += a.transpose() * h * shrunk * a;
    a = a * shrunk * a;
    g = next_g;
  }
  return h;
}

}  // namespace

template <std::size_t Order>
SteadyKalman<Order> steady_kalman(const SquareMatrix<Order>& drift, const std::array<double, Order>& noise_density,
                                  double measurement_variance, Seconds dt) {
  constexpr auto order = static_cast<Eigen::Index>(Order);
  const MatrixXd f = Eigen::Map<const RowByRow>(drift.front().data(), order, order);
  RowByRow exponential = RowByRow::Zero(2 * order, 2 * order);
  exponential.topLeftCorner(order, order) = -f * dt.value;
  for (Eigen::Index i = 0; i < order; ++i) {
    exponential(i, order + i) = noise_density[static_cast<std::size_t>(i)] * dt.value;
  }
  exponential.bottomRightCorner(order, order) = f.transpose() * dt.value;
  exponentiate({exponential.data(), static_cast<std::size_t>(exponential.size())}, 2 * Order);
  const MatrixXd transition = exponential.bottomRightCorner(order, order).transpose();
  const MatrixXd noise = transition * exponential.topRightCorner(order, order);

  const MatrixXd covariance = steady_covariance(transition, noise, measurement_variance);
  const VectorXd gain = covariance.col(0) / (covariance(0, 0) + measurement_variance);
  SteadyKalman<Order> filter;
  Eigen::Map<RowByRow>(filter.transition.front().data(), order, order) = transition;
  Eigen::Map<VectorXd>(filter.gain.data(), order) = gain;
  RowByRow error_transition = transition;
  error_transition -= gain * transition.row(0);
  double slowest = 0.0;
  if (gain.allFinite()) {
    const std::span<const double> entries(error_transition.data(), static_cast<std::size_t>(error_transition.size()));
    for (const std::complex<double>& value : eigenvalues(entries, Order)) {
      slowest = std::max(slowest, std::abs(value));
    }
  }
  filter.stable = gain.allFinite() && slowest < 1.0;
  return filter;
}

template SteadyKalman<2> steady_kalman(const SquareMatrix<2>&, const std::array<double, 2>&, double, Seconds);
template SteadyKalman<3> steady_kalman(const SquareMatrix<3>&, const std::array<double, 3>&, double, Seconds);

}  // namespace tactus::signal
