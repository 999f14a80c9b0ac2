#include <tactus/signal/steady_kalman.hpp>

#include <Eigen/Dense>
#include <unsupported/Eigen/MatrixFunctions>

namespace tactus::signal {

namespace {

template <int Order>
using Matrix = Eigen::Matrix<double, Order, Order>;

/// The covariance of the prediction in the steady state, by doubling: round k has seen 2^k samples.
template <int Order>
Matrix<Order> steady_covariance(const Matrix<Order>& transition, const Matrix<Order>& noise,
                                double measurement_variance) {
  constexpr int rounds = 60;
  Matrix<Order> a = transition.transpose();
  Matrix<Order> g = Matrix<Order>::Zero();
  g(0, 0) = 1.0 / measurement_variance;
  Matrix<Order> h = noise;
  for (int round = 0; round < rounds; ++round) {
    const Matrix<Order> shrunk = (Matrix<Order>::Identity() + g * h).partialPivLu().inverse();
    const Matrix<Order> next_g = g + a * shrunk * g * a.transpose();
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
  constexpr int order = static_cast<int>(Order);
  using Row = Eigen::Matrix<double, order, order, Eigen::RowMajor>;
  const Matrix<order> f = Eigen::Map<const Row>(drift.front().data());
  const Matrix<order> density = Eigen::Map<const Eigen::Vector<double, order>>(noise_density.data()).asDiagonal();
  Matrix<2 * order> pair;
  pair << -f, density, Matrix<order>::Zero(), f.transpose();
  const Matrix<2 * order> exponential = (pair * dt.value).exp();
  const Matrix<order> transition = exponential.template bottomRightCorner<order, order>().transpose();
  const Matrix<order> noise = transition * exponential.template topRightCorner<order, order>();

  const Matrix<order> covariance = steady_covariance<order>(transition, noise, measurement_variance);
  const Eigen::Vector<double, order> gain = covariance.col(0) / (covariance(0, 0) + measurement_variance);
  SteadyKalman<Order> filter;
  Eigen::Map<Row>(filter.transition.front().data()) = transition;
  Eigen::Map<Eigen::Vector<double, order>>(filter.gain.data()) = gain;
  const Matrix<order> error_transition =
      (Matrix<order>::Identity() - gain * Eigen::Vector<double, order>::UnitX().transpose()) * transition;
  filter.stable = gain.allFinite() && error_transition.eigenvalues().cwiseAbs().maxCoeff() < 1.0;
  return filter;
}

template SteadyKalman<2> steady_kalman(const SquareMatrix<2>&, const std::array<double, 2>&, double, Seconds);
template SteadyKalman<3> steady_kalman(const SquareMatrix<3>&, const std::array<double, 3>&, double, Seconds);

}  // namespace tactus::signal
