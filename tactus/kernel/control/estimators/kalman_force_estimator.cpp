// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/estimators/kalman_force_estimator.hpp>
#include <tactus/kernel/signal/checks.hpp>
#include <tactus/kernel/signal/steady_kalman.hpp>

#include <cmath>
#include <cstddef>

namespace tactus::control {

Result<KalmanForceEstimator> KalmanForceEstimator::make(const Params& params, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  const double mass_kg = params.model.mass_kg;
  const signal::SquareMatrix<3> drift{
      {{0.0, 1.0, 0.0}, {0.0, -params.model.viscous_damping_N_s_per_m / mass_kg, 1.0 / mass_kg}, {0.0, 0.0, 0.0}}};
  const auto filter = signal::steady_kalman<3>(
      drift, {0.0, std::pow(params.model_noise_N / mass_kg, 2), std::pow(params.force_walk_N, 2)},
      params.position_noise_m * params.position_noise_m, dt);
  if (!filter.stable) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "position_noise_m",
                 .message = "no stable gain can be computed from " + rounded_number(params.position_noise_m) +
                            " m of position noise and the noises of force and model: bring them nearer together",
                 .place = {}};
  }
  KalmanForceEstimator estimator;
  estimator.friction_ = params.model.friction;
  estimator.actuator_gain_ = params.model.actuator_gain;
  estimator.transition_ = filter.transition;
  // A held force acts as the state of the environment's force does.
  estimator.input_ = {filter.transition[0][2], filter.transition[1][2], 0.0};
  estimator.gain_ = filter.gain;
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
