// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/core/units.hpp>
#include <tactus/kernel/mechanics/minimum_jerk.hpp>
#include <tactus/kernel/signal/low_pass.hpp>

#include <algorithm>
#include <utility>

namespace tactus::live {

/// A tap that is the same every time: rest before the wall, reach through it as the median operator of the tapping
/// experiment does, press, and go home.
struct ScriptedTap {
  static constexpr double depth_m = 0.007;       ///< before and beyond the wall
  static constexpr double speed_m_per_s = 0.06;  ///< at the wall
  static constexpr double rest_s = 0.05;         ///< before the reach
  static constexpr double press_s = 0.6;         ///< after it
  static constexpr double return_s = 0.4;        ///< the way home
  double wall_m = 0.01;
  double approach_s = 0.0;  ///< from the place of rest to where it starts; 0 begins there

  [[nodiscard]] double start_m() const { return wall_m - depth_m; }
  /// Where the hand is at time 0.
  [[nodiscard]] double begin_m() const { return approach_s > 0.0 ? 0.0 : start_m(); }
  [[nodiscard]] mechanics::MinimumJerk reach() const {
    return {.start_m = start_m(),
            .end_m = wall_m + depth_m,
            .start_time_s = rest_s,
            .duration_s = mechanics::MinimumJerk::duration_for(2.0 * depth_m, speed_m_per_s)};
  }
  [[nodiscard]] double position_m(double since_begin_s) const {
    const double time_s = since_begin_s - approach_s;
    if (time_s < 0.0) {
      const mechanics::MinimumJerk approach{
          .start_m = 0.0, .end_m = start_m(), .start_time_s = 0.0, .duration_s = approach_s};
      return approach.position_m(since_begin_s);
    }
    const mechanics::MinimumJerk there = reach();
    const double leave_s = there.start_time_s + there.duration_s + press_s;
    if (time_s < leave_s) return there.position_m(time_s);
    const mechanics::MinimumJerk home{
        .start_m = there.end_m, .end_m = 0.0, .start_time_s = leave_s, .duration_s = return_s};
    return home.position_m(time_s);
  }
  [[nodiscard]] double duration_s() const { return approach_s + rest_s + reach().duration_s + press_s + return_s; }
};

/// Where the visitor means the hand to be. What a mouse, a finger or a key asks for jumps from event to event; a
/// greatest speed and two first-order low-passes of 8 Hz, together −3 dB at 5.1 Hz, make of it what a hand does that
/// taps. A mouse is faster than that, and presses the handle so far into the wall that the display stays at its limit
/// and nothing rings. Zero is the place of rest.
class Hand {
 public:
  /// A little above that of the scripted tap.
  static constexpr double fastest_m_per_s = 0.07;
  /// Of a hand that moves across: nothing is tapped there.
  static constexpr double fastest_across_m_per_s = 0.2;

  static Result<Hand> make(Seconds dt, double fastest = fastest_m_per_s) {
    const auto low_pass = signal::LowPass::make({.cutoff_Hz = 8.0}, dt);
    if (!low_pass) return low_pass.error();
    return Hand(*low_pass, dt, fastest);
  }

  /// Where it is wanted. A script that runs has precedence.
  void aim(double target_m) noexcept { target_m_ = target_m; }
  void begin(const ScriptedTap& tap) noexcept {
    tap_ = tap;
    tap_time_s_ = 0.0;
    next_m_ = tap.begin_m();
    target_m_ = 0.0;
    tapping_ = true;
  }
  /// At rest at zero.
  void reset() noexcept {
    first_.reset();
    second_.reset();
    next_m_ = target_m_ = followed_m_ = 0.0;
    tapping_ = false;
  }

  /// The path now and at the next tick.
  std::pair<double, double> step() noexcept {
    const double now_m = next_m_;
    if (tapping_) {
      tap_time_s_ += dt_s_;
      next_m_ = tap_.position_m(tap_time_s_);
      // It ends at zero, where the filters have stayed.
      if (tap_time_s_ >= tap_.duration_s()) reset();
    } else {
      const double most_m = fastest_ * dt_s_;
      followed_m_ += std::clamp(target_m_ - followed_m_, -most_m, most_m);
      next_m_ = second_.step(first_.step(followed_m_));
    }
    return {now_m, next_m_};
  }
  [[nodiscard]] double target_m() const noexcept { return tapping_ ? next_m_ : target_m_; }

 private:
  Hand(const signal::LowPass& low_pass, Seconds dt, double fastest)
      : first_(low_pass), second_(low_pass), dt_s_(dt.value), fastest_(fastest) {}
  signal::LowPass first_;
  signal::LowPass second_;
  double dt_s_;
  double fastest_;  ///< in m/s
  double target_m_ = 0.0;
  double followed_m_ = 0.0;  ///< the target, at no more than the greatest speed
  double next_m_ = 0.0;
  ScriptedTap tap_;
  double tap_time_s_ = 0.0;
  bool tapping_ = false;
};

}  // namespace tactus::live
