#include <tactus/control/kalman_force_estimator.hpp>
#include <tactus/signal/checks.hpp>

#include <cmath>
#include <cstddef>

#include <Eigen/Dense>
#include <unsupported/Eigen/MatrixFunctions>

namespace tactus::control {

namespace {

using Matrix = Eigen::Matrix3d;
using Vector = Eigen::Vector3d;

/// What the continuous model becomes over a tick.
struct Sampled {
  Matrix transition;
  Vector input;
  Matrix noise;
};

Sampled sample(const KalmanForceEstimator::Params& params, Seconds dt) {
  const double mass = params.model.mass_kg;
  Matrix f = Matrix::Zero();
  f(0, 1) = 1.0;
  f(1, 1) = -params.model.viscous_damping_N_s_per_m / mass;
  f(1, 2) = 1.0 / mass;
  Matrix density = Matrix::Zero();
  density(1, 1) = std::pow(params.model_noise_N / mass, 2);
  density(2, 2) = std::pow(params.force_walk_N, 2);
  Eigen::Matrix<double, 6, 6> pair = Eigen::Matrix<double, 6, 6>::Zero();
  pair << -f, density, Matrix::Zero(), f.transpose();
  const Eigen::Matrix<double, 6, 6> exponential = (pair * dt.value).exp();
  Sampled sampled;
  sampled.transition = exponential.bottomRightCorner<3, 3>().transpose();
  sampled.noise = sampled.transition * exponential.topRightCorner<3, 3>();
  // A held force acts as the state of the environment's force does.
  sampled.input << sampled.transition(0, 2), sampled.transition(1, 2), 0.0;
  return sampled;
}

/// The covariance of the prediction in the steady state, by doubling: round k has seen 2^k samples.
Matrix steady_covariance(const Sampled& sampled, double position_variance) {
  constexpr int rounds = 60;
  Matrix a = sampled.transition.transpose();
  Matrix g = Matrix::Zero();
  g(0, 0) = 1.0 / position_variance;
  Matrix h = sampled.noise;
  for (int round = 0; round < rounds; ++round) {
    const Matrix shrunk = (Matrix::Identity() + g * h).partialPivLu().inverse();
    const Matrix next_g = g + a * shrunk * g * a.transpose();
    h += a.transpose() * h * shrunk * a;
    a = a * shrunk * a;
    g = next_g;
  }
  return h;
}

}  // namespace

Result<KalmanForceEstimator> KalmanForceEstimator::make(const Params& params, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  const Sampled sampled = sample(params, dt);
  const double variance = params.position_noise_m * params.position_noise_m;
  const Matrix covariance = steady_covariance(sampled, variance);
  const Vector gain = covariance.col(0) / (covariance(0, 0) + variance);
  const Matrix error_transition = (Matrix::Identity() - gain * Vector::UnitX().transpose()) * sampled.transition;
  if (!gain.allFinite() || !(error_transition.eigenvalues().cwiseAbs().maxCoeff() < 1.0)) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "position_noise_m",
                 .message = "no stable gain can be computed from " + format_number(params.position_noise_m) +
                            " m of position noise and the noises of force and model: bring them nearer together",
                 .place = {}};
  }
  KalmanForceEstimator estimator;
  estimator.friction_ = params.model.friction;
  estimator.actuator_gain_ = params.model.actuator_gain;
  for (std::size_t row = 0; row < 3; ++row) {
    const auto r = static_cast<Eigen::Index>(row);
    for (std::size_t column = 0; column < 3; ++column) {
      estimator.transition_[row][column] = sampled.transition(r, static_cast<Eigen::Index>(column));
    }
    estimator.input_[row] = sampled.input[r];
    estimator.gain_[row] = gain[r];
  }
  return estimator;
}

ForceEstimate KalmanForceEstimator::step(const SlaveMotionSample& sample) noexcept {
  if (!started_) state_[0] = sample.position;
  started_ = true;
  const double innovation = sample.position - state_[0];
  State corrected = state_;
  for (std::size_t i = 0; i < 3; ++i) corrected[i] += gain_[i] * innovation;
  const double known_N = actuator_gain_ * sample.command - friction_(corrected[1]);
  for (std::size_t i = 0; i < 3; ++i) {
    state_[i] = input_[i] * known_N;
    for (std::size_t j = 0; j < 3; ++j) state_[i] += transition_[i][j] * corrected[j];
  }
  return {.force = corrected[2]};
}

}  // namespace tactus::control
