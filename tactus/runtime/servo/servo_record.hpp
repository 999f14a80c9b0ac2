// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/signals.hpp>
#include <tactus/runtime/servo/servo_thread.hpp>

#include <cstdint>

namespace tactus::runtime {

/// How the clock of the servo went, for the log: one record for each step.
struct ServoRecord {
  std::int64_t tick = 0;
  std::int64_t missed = 0;
  double lateness_s = 0.0;
  double previous_duration_s = 0.0;
  std::int64_t previous_cause = 0;
  static constexpr auto signals() {
    return List{
        observed("tick", &ServoRecord::tick, units::none, "", "", "", "Number of the deadline, missed ones counted."),
        observed("missed", &ServoRecord::missed, units::none, "", "", "", "Deadlines missed right before this one."),
        observed("lateness_s", &ServoRecord::lateness_s, units::second, "", "", "", "From the deadline to the step."),
        observed("previous_duration_s", &ServoRecord::previous_duration_s, units::second, "", "", "",
                 "How long the step before took."),
        observed(
            "previous_cause", &ServoRecord::previous_cause, units::none, "", "", "",
            "Why the step before was late: 0 it was not, 1 computing, 2 blocking, 3 paging, 4 waking, 5 preempted, "
            "6 stalled.")};
  }
};

/// The record of a step. Real-time safe.
inline ServoRecord recorded(const station::Tick& tick) noexcept {
  return {.tick = tick.number,
          .missed = tick.missed,
          .lateness_s = 1e-9 * static_cast<double>(tick.began_ns - tick.deadline_ns),
          .previous_duration_s = 1e-9 * static_cast<double>(tick.previous_duration_ns),
          .previous_cause = static_cast<std::int64_t>(tick.previous_cause)};
}

}  // namespace tactus::runtime
