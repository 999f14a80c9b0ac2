// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/contact_metrics.hpp>
#include <tactus/simulation/experiments/tapping/tap_observer.hpp>

#include <algorithm>
#include <cmath>

namespace tactus::experiments {

namespace {

/// A slave that has not met the wall this long after the reach has ended never will.
constexpr double touch_timeout_s = 0.2;
constexpr double workspace_m = 1.0;

}  // namespace

TapObserver::TapObserver(const Tap& tap, double observation_s)
    : tick_s_(1.0 / tap.params.servo.rate_Hz),
      observation_s_(observation_s),
      slave_workspace_m_(workspace_m * tap.params.control.position_scale),
      last_(ticks_in(tap.path.start_time_s + tap.path.duration_s + touch_timeout_s, tick_s_)) {
  // Filled and emptied, so that every page of it is there.
  contact_force_N_.resize(last_ + ticks_in(observation_s, tick_s_));
  contact_force_N_.clear();
}

bool TapObserver::observe(const simulation::Teleoperator::Record& record, bool healthy,
                          const std::optional<simulation::StoppedSite>& stopped) noexcept {
  contact_force_N_.push_back(record.contact_force_N);
  peak_force_N_ = std::max(peak_force_N_, record.peak_contact_force_N);
  if (record.touched) {
    ++contacts_;
    if (!result_.touched) {
      result_.touched = true;
      result_.first_touch_s = record.touched_at_s;
      first_touch_ = ticks_;
      last_ = ticks_ + ticks_in(observation_s_, tick_s_);
    }
  }
  // Written so that a NaN counts as outside.
  const bool inside =
      std::fabs(record.master_position_m) < workspace_m && std::fabs(record.tip_position_m) < slave_workspace_m_;
  result_.diverged = !inside || !healthy;
  result_.stopped = stopped;
  return ++ticks_ < last_ && !result_.diverged && !stopped;
}

TapResult TapObserver::result() const {
  TapResult result = result_;
  if (result.touched) result.metrics = judge_contact(contact_force_N_, first_touch_, tick_s_);
  result.metrics.settled = result.metrics.settled && result.touched && !result.diverged && !result.stopped;
  if (!result.metrics.settled) result.metrics.settling_time_s = observation_s_;
  result.metrics.contacts = contacts_;
  result.metrics.peak_force_N = peak_force_N_;
  return result;
}

}  // namespace tactus::experiments
