// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <thread>
#include <utility>

/// In place of the library of your robot: two joints behind a controller that is reached by one call per millisecond.
/// The call blocks until the next millisecond, as those of research interfaces do, and as long as `hiccup` asks for.
class StandInRobot {
 public:
  static constexpr std::size_t joints = 2;
  struct State {
    std::array<double, joints> position_rad{}, velocity_rad_per_s{};
  };

  void connect() { next_ = std::chrono::steady_clock::now(); }
  /// The next call blocks for so long.
  void hiccup(std::chrono::milliseconds length) { hiccup_ = length; }

  /// Sends a torque to each joint, and returns the state a millisecond later.
  State cycle(const std::array<double, joints>& torque_Nm) {
    std::this_thread::sleep_for(std::exchange(hiccup_, std::chrono::milliseconds(0)));
    // The robot has moved for as long as really passed; without a command for 50 ms it drops the torque by itself.
    constexpr std::chrono::milliseconds step(1), watchdog(50);
    const auto now = std::chrono::steady_clock::now();
    const bool in_time = now - next_ < watchdog;
    while (next_ <= now) {
      for (std::size_t i = 0; i < joints; ++i) {
        constexpr double inertia_kg_m2 = 0.1, damping_Nms_per_rad = 0.2, step_s = 0.001;
        const double torque = (in_time ? torque_Nm[i] : 0.0) - damping_Nms_per_rad * state_.velocity_rad_per_s[i];
        state_.velocity_rad_per_s[i] += step_s * torque / inertia_kg_m2;
        state_.position_rad[i] += step_s * state_.velocity_rad_per_s[i];
      }
      next_ += step;
    }
    std::this_thread::sleep_until(next_);
    return state_;
  }

 private:
  State state_;
  std::chrono::steady_clock::time_point next_;
  std::chrono::milliseconds hiccup_{0};
};
