// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/mechanics/minimum_jerk.hpp>
#include <tactus/simulation/experiments/contact_metrics.hpp>
#include <tactus/simulation/teleoperator/teleoperator.hpp>

#include <cstddef>
#include <optional>
#include <vector>

namespace tactus::experiments {

/// One tap: the teleoperator and the path that the operator intends.
struct Tap {
  simulation::Teleoperator::Params params;
  mechanics::MinimumJerk path;
};

/// One tap as it went.
struct TapResult {
  ContactMetrics metrics;
  bool touched = false;
  bool diverged = false;  ///< a bare site's gate latched, or the master or the slave left its workspace of 1 m
  std::optional<simulation::StoppedSite> stopped = {};  ///< by supervision, which ends the tap
  double first_touch_s = 0.0;
};

/// Follows one tap tick by tick, in virtual or in real time, and judges it.
class TapObserver {
 public:
  TapObserver(const Tap& tap, double observation_s);

  /// Takes the next tick; `healthy` is whether no safety gate has latched, `stopped` which site supervision has
  /// stopped. False once the tap is over. Real-time safe: all room is taken when the observer is made.
  bool observe(const simulation::Teleoperator::Record& record, bool healthy,
               const std::optional<simulation::StoppedSite>& stopped = {}) noexcept;
  /// The most ticks that it can take.
  [[nodiscard]] std::size_t most_ticks() const { return contact_force_N_.capacity(); }
  /// What the ticks so far amount to.
  [[nodiscard]] TapResult result() const;

 private:
  double tick_s_;
  double observation_s_;
  double slave_workspace_m_;
  std::size_t last_;  ///< ticks that will be taken, as far as is known
  std::size_t ticks_ = 0;
  std::size_t first_touch_ = 0;
  int contacts_ = 0;
  double peak_force_N_ = 0.0;
  std::vector<double> contact_force_N_;
  TapResult result_;
};

}  // namespace tactus::experiments
