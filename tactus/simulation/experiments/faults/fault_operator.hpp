// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/site_supervisor.hpp>
#include <tactus/simulation/experiments/faults/plan.hpp>
#include <tactus/simulation/experiments/faults/schedule.hpp>
#include <tactus/simulation/teleoperator/fault_moment.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace tactus::experiments {

/// The operator of a run: where the hand means to be and which buttons are pressed when. Drawn by the plan's seed.
class FaultOperator {
 public:
  /// `wall_m` is where the slave meets the wall, on the master's side. Who `waits` keeps the hand still while the
  /// motors are tried on arming.
  FaultOperator(const FaultPlan& plan, double wall_m, bool waits)
      : wall_m_(wall_m), waits_(waits), rests_at_s_(plan.start_s + plan.length_s), task_(task_of(plan.kind)) {
    signal::Random random = signal::Random(static_cast<std::uint64_t>(plan.seed)).fork(3);
    phase_cycles_ = random.uniform();
    tap_Hz_ = random.uniform(0.6, 1.2);
    depth_m_ = random.uniform(0.004, 0.012);
  }

  /// Taps as a raised cosine, the wall in the middle of the way; or hovers before it, or kneads it, or
  /// leans on it and stays.
  [[nodiscard]] double path_m(double time_s) const noexcept {
    using std::numbers::pi;
    time_s = waits_ ? moving_s(time_s) : time_s;
    const double lean_s = time_s - fault_schedule::press_s;
    const double leant = 0.5 * (1.0 - std::cos(pi * std::clamp(2.0 * lean_s, 0.0, 1.0)));
    if (task_ == Task::leans) return wall_m_ + depth_m_ * (2.0 * leant - 1.0);
    const double middle_m = task_ == Task::kneads   ? wall_m_ + kneaded_share * leant * depth_m_
                            : task_ == Task::hovers ? wall_m_ - depth_m_ - hover_m
                                                    : wall_m_;
    return middle_m - depth_m_ * std::cos(2.0 * pi * (tap_Hz_ * time_s + 0.1 * phase_cycles_));
  }
  /// When the hand, where it taps, is deepest in the wall, at `time_s` or after.
  [[nodiscard]] double deepest_after_s(double time_s) const noexcept {
    const double cycles = tap_Hz_ * time_s + 0.1 * phase_cycles_ - 0.5;
    return time_s + (std::ceil(cycles) - cycles) / tap_Hz_;
  }
  /// How far to either side of the wall the path goes.
  [[nodiscard]] double depth_m() const noexcept { return depth_m_; }
  [[nodiscard]] double wall_m() const noexcept { return wall_m_; }

  /// What is pressed: what starts a session, and after the fault's end at `end_s`, where that is needed, what starts it
  /// again.
  [[nodiscard]] static control::SiteRequests presses(double now_s, double end_s, bool rearms) noexcept {
    using namespace fault_schedule;
    const auto within = [now_s](double begin_s) { return now_s >= begin_s && now_s < begin_s + button_s; };
    control::SiteRequests pressed{.align = within(align_s), .arm = within(arm_s), .dead_man = now_s >= press_s};
    if (now_s > end_s + look_after_s && rearms) {
      pressed.clear = within(end_s + clear_after_s);
      pressed.align = within(end_s + realign_after_s);
      pressed.arm = within(end_s + rearm_after_s);
      pressed.dead_man = now_s >= end_s + repress_after_s;
    }
    return pressed;
  }

 private:
  enum class Task { taps, hovers, kneads, leans };
  /// How far into the wall kneading is centred, over the depth.
  static constexpr double kneaded_share = 3.0;
  /// How far before the wall a slave has the room in which its motor is tried.
  static constexpr double hover_m = 0.006;

  /// What is seen by forces alone needs some, and a motor that is tried needs room.
  static Task task_of(FaultKind kind) {
    switch (kind) {
      case FaultKind::delayed_wall:
      case FaultKind::delay_asymmetric:
      case FaultKind::delay_creeping:
      case FaultKind::actuator_hot:
      case FaultKind::slow_stop:
        return Task::leans;
      case FaultKind::torque_constant:
      case FaultKind::actuator_dead:
      case FaultKind::actuator_saturated:
      case FaultKind::power_lost:
      case FaultKind::force_sensor_stuck:
      case FaultKind::force_sensor_gain:
      case FaultKind::force_sensor_reversed:
      case FaultKind::force_sensor_drift:
      case FaultKind::force_sensor_late:
        return Task::kneads;
      case FaultKind::motor_reversed:
      case FaultKind::encoder_reversed:
      case FaultKind::encoder_scale:
      case FaultKind::channels_swapped:
        return Task::hovers;
      default:
        return Task::taps;
    }
  }
  /// Of `time_s`, what the hand does not wait.
  [[nodiscard]] double moving_s(double time_s) const noexcept {
    using namespace fault_schedule;
    const double began_s = std::max(time_s - still_until_s, 0.0);
    const double rested_s = std::clamp(time_s - rests_at_s_, 0.0, settled_after_s);
    return std::max(began_s - rested_s, 0.0);
  }

  double wall_m_;
  bool waits_;
  double rests_at_s_;
  Task task_;
  double phase_cycles_ = 0.0, tap_Hz_ = 1.0, depth_m_ = 0.01;
};

}  // namespace tactus::experiments
