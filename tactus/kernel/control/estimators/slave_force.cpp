// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/estimators/slave_force.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <type_traits>

namespace tactus::control {

Result<SlaveForce> SlaveForce::make(const Params& params, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  const auto with = [](const char* group, const auto& estimator) -> Result<SlaveForce> {
    if (!estimator) return under(group, estimator.error());
    return SlaveForce(*estimator);
  };
  switch (params.source) {
    case SlaveForceSource::sensor:
      break;
    case SlaveForceSource::inverse_model:
      return with("inverse_model", InverseModelEstimator::make(params.inverse_model, dt));
    case SlaveForceSource::disturbance_observer:
      return with("disturbance_observer", DisturbanceObserver::make(params.disturbance_observer, dt));
    case SlaveForceSource::momentum_observer:
      return with("momentum_observer", MomentumObserver::make(params.momentum_observer, dt));
    case SlaveForceSource::kalman:
      return with("kalman", KalmanForceEstimator::make(params.kalman, dt));
  }
  return SlaveForce(Sensor{});
}

double SlaveForce::step(const Input& input) noexcept {
  if (!started_) start_m_ = input.motor_position_m;
  started_ = true;
  const SlaveMotionSample sample{.command = input.acted_N, .position = input.motor_position_m - start_m_};
  return std::visit(
      [&](auto& source) {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(source)>, Sensor>) {
          return input.tip_force_N;
        } else {
          return -source.step(sample).force;
        }
      },
      source_);
}

void SlaveForce::reset() noexcept {
  std::visit(
      [](auto& source) {
        if constexpr (requires { source.reset(); }) source.reset();
      },
      source_);
  started_ = false;
}

}  // namespace tactus::control
