// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/architecture.hpp>
#include <tactus/kernel/station/device.hpp>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>

/// A device of other physics than any of ours, with the limits and parameters that drive it.
namespace tactus::station {

inline constexpr Seconds period{200e-6};

/// A tick at its deadline, as a clock that is never late gives it.
inline Tick tick(std::int64_t number, std::int64_t missed = 0) {
  const std::int64_t deadline_ns = 200'000 * number;
  return {.number = number, .missed = missed, .deadline_ns = deadline_ns, .began_ns = deadline_ns};
}

/// A carriage of 0.2 kg with a damper of 4 N s/m, and a spring to where a hand is or a wall begins, stepped once a tick
/// (semi-implicit Euler). It says that it is no simulation.
class Carriage final : public Device {
 public:
  explicit Carriage(const DeviceLimits& limits, bool simulated = false) : limits_(limits), simulated_(simulated) {}

  double hand_N_per_m = 0.0, hand_m = 0.0;  ///< at a master
  double wall_N_per_m = 0.0, wall_m = 0.0;  ///< at a slave
  DeviceCommand command{.enabled = false};
  DeviceHealth state = DeviceHealth::good;
  double largest_step_N = 0.0;

  [[nodiscard]] DeviceLimits limits() const override { return limits_; }
  [[nodiscard]] bool simulated() const noexcept override { return simulated_; }
  DeviceReading read(const Tick&) noexcept override {
    const double hand_N = hand_N_per_m * (hand_m - position_m_);
    const double wall_N = position_m_ > wall_m ? wall_N_per_m * (position_m_ - wall_m) : 0.0;
    const double motor_N = command.enabled ? command.force_N : 0.0;
    velocity_m_per_s_ += period.value * (motor_N + hand_N - wall_N - 4.0 * velocity_m_per_s_) / 0.2;
    position_m_ += period.value * velocity_m_per_s_;
    return {.position_m = position_m_, .force_N = hand_N_per_m > 0.0 ? hand_N : wall_N};
  }
  void write(const DeviceCommand& given) noexcept override {
    const double before_N = command.enabled ? command.force_N : 0.0;
    command = given;
    largest_step_N = std::fmax(largest_step_N, std::fabs((given.enabled ? given.force_N : 0.0) - before_N));
  }
  [[nodiscard]] DeviceHealth health() const noexcept override { return state; }
  [[nodiscard]] double position_m() const { return position_m_; }
  void carry_to(double position_m) { position_m_ = position_m; }

 private:
  DeviceLimits limits_;
  bool simulated_;
  double position_m_ = 0.0, velocity_m_per_s_ = 0.0;
};

inline constexpr DeviceLimits limits{
    .force_N = 4.0, .rate_N_per_s = 1000.0, .velocity_m_per_s = 2.0, .position_m = 0.05};

/// Every number that is no time, half of its default.
template <Described T>
void choose(T& params) {
  for_each_field<T>([&](const auto& f) {
    using Value = typename std::remove_cvref_t<decltype(f)>::value_type;
    if constexpr (Described<Value>) {
      choose(params.*f.member);
    } else if constexpr (std::is_same_v<Value, double>) {
      if (std::string(f.unit.suffix) != units::second.suffix) params.*f.member *= 0.5;
    }
  });
}

/// What somebody must have chosen before a device that is not simulated is driven.
inline control::ControlParams chosen() {
  control::ControlParams control;
  choose(control.gate);
  choose(control.slave_gate);
  // Within the 4 N of the device, or nothing could ever reach them.
  for (control::SafetyGate::Params* gate : {&control.gate, &control.slave_gate}) {
    gate->encoder.frozen_force_N = gate->encoder.unbalanced_force_N = 3.0;
    gate->reversal = {.force_N = 3.0, .gained_m_per_s = 0.5};
  }
  control.supervision.force_sensor.residual_limit_N = 3.0;
  control.supervision.probe.force_N = 0.5;
  control.supervision.probe.least_m = 2e-5;
  return control;
}

}  // namespace tactus::station
