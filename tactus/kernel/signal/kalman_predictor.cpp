// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/checks.hpp>
#include <tactus/kernel/signal/kalman_predictor.hpp>
#include <tactus/kernel/signal/steady_kalman.hpp>

#include <cmath>
#include <numbers>
#include <string>

namespace tactus::signal {

Result<KalmanPredictor> KalmanPredictor::make(const Params& params, Seconds dt) {
  if (Check error = check(params, dt)) return *std::move(error);
  KalmanPredictor predictor;
  predictor.sample_time_s_ = dt.value;
  predictor.horizon_ticks_ = params.horizon_s / dt.value;
  // In ticks and deviations of a sample, in which the numbers of the Riccati equation lie near one another.
  const double ratio = params.process_noise / params.measurement_noise;
  bool stable = false;
  if (params.kinematics == Kinematics::constant_velocity) {
    const double density = ratio * ratio * std::pow(dt.value, 3);
    const auto filter = steady_kalman<2>({{{0.0, 1.0}, {0.0, 0.0}}}, {0.0, density}, 1.0, Seconds{1.0});
    predictor.gain_ = {filter.gain[0], filter.gain[1], 0.0};
    stable = filter.stable;
  } else {
    const double density = ratio * ratio * std::pow(dt.value, 5);
    const auto filter =
        steady_kalman<3>({{{0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 0.0}}}, {0.0, 0.0, density}, 1.0, Seconds{1.0});
    predictor.gain_ = filter.gain;
    stable = filter.stable;
  }
  if (!stable) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "process_noise",
                 .message = "no stable gain can be computed for " + rounded_number(params.process_noise) +
                            " with a measurement noise of " + rounded_number(params.measurement_noise) +
                            ": bring them nearer together",
                 .place = {}};
  }
  return predictor;
}

double KalmanPredictor::step(double input) noexcept {
  const double innovation = input - state_[0];
  const double position = state_[0] + gain_[0] * innovation;
  const double velocity = state_[1] + gain_[1] * innovation;
  const double acceleration = state_[2] + gain_[2] * innovation;
  state_ = {position + velocity + 0.5 * acceleration, velocity + acceleration, acceleration};
  return position + horizon_ticks_ * (velocity + 0.5 * horizon_ticks_ * acceleration);
}

std::complex<double> KalmanPredictor::response(double frequency_Hz) const noexcept {
  // Estimate over innovation e, both times (1 − w)³: triangular, as the kinematics are.
  const auto w = std::polar(1.0, -2.0 * std::numbers::pi * frequency_Hz * sample_time_s_);
  const auto d = 1.0 - w;
  const auto acceleration = gain_[2] * d * d;
  const auto velocity = gain_[1] * d * d + w * gain_[2] * d;
  const auto position = gain_[0] * d * d + w * (gain_[1] * d + w * gain_[2] + 0.5 * gain_[2] * d);
  const auto input = d * d * d + w * (position + velocity + 0.5 * acceleration);
  return (position + horizon_ticks_ * (velocity + 0.5 * horizon_ticks_ * acceleration)) / input;
}

double KalmanPredictor::white_noise_gain() const noexcept {
  constexpr double most_ticks = 1e7;
  KalmanPredictor copy = *this;
  copy.reset();
  double sum = 0.0;
  double newer = 0.0;  // of the squares since the last doubling of the ticks
  double doubled = 64.0;
  for (double tick = 0.0; tick < most_ticks; ++tick) {
    const double sample = copy.step(tick == 0.0 ? 1.0 : 0.0);
    newer += sample * sample;
    if (tick < doubled) continue;
    sum += newer;
    if (newer <= 1e-24 * sum) break;
    newer = 0.0;
    doubled *= 2.0;
  }
  return std::sqrt(sum + newer);
}

}  // namespace tactus::signal
