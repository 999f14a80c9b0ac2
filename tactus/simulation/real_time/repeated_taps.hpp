// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/site_supervisor.hpp>
#include <tactus/kernel/mechanics/minimum_jerk.hpp>
#include <tactus/kernel/station/device.hpp>
#include <tactus/runtime/servo/site_device.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>
#include <tactus/simulation/real_time/simulated_devices.hpp>

#include <memory>

namespace tactus::real_time {

/// How an operator taps again and again: there, press, back, rest, with the mean speed and depth of an experiment's
/// taps.
class RepeatedTaps {
 public:
  explicit RepeatedTaps(const experiments::TappingParams& params);
  [[nodiscard]] double position_m(double time_s) const noexcept;
  [[nodiscard]] double start_m() const noexcept { return there_.start_m; }

 private:
  mechanics::MinimumJerk there_;
  mechanics::MinimumJerk back_;
  double period_s_;
};

/// Who taps on and on, and waits where the hand is while the site does not follow it.
class PatientOperator final : public runtime::SimulatedOperator {
 public:
  PatientOperator(const RepeatedTaps& path, double tick_s) : path_(path), tick_s_(tick_s) {}
  /// Once a tick. Real-time safe.
  Intent step() noexcept {
    const double now_s = path_s_;
    if (follows_) path_s_ += tick_s_;
    return {.now_m = path_.position_m(now_s), .at_next_tick_m = path_.position_m(path_s_)};
  }
  void follow(bool follows) noexcept override { follows_ = follows; }

 private:
  RepeatedTaps path_;
  double tick_s_;
  double path_s_ = 0.0;
  bool follows_ = false;
};

/// The device of a site as an experiment describes it, at rest where the taps begin. Errors: those of clock and plant.
Result<runtime::SiteDevice> simulated_device(const experiments::TappingParams& params, control::SiteRole role);

}  // namespace tactus::real_time
