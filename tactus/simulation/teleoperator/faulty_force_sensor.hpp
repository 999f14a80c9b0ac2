// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/simulation/teleoperator/fault_moment.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace tactus::simulation {

/// What a faulty force sensor at the slave's tip reports of a true reading. Of a plan that is for another part it is a
/// sound one.
class FaultyForceSensor {
 public:
  FaultyForceSensor(const FaultPlan& plan, double tick_s) : plan_(plan) {
    if (plan.kind != FaultKind::force_sensor_late) return;
    past_N_.resize(static_cast<std::size_t>(std::max(std::lround(plan.size / tick_s), 1L)));
  }

  /// The reading in N that reaches the site, from the true one. Once a tick. Real-time safe.
  double step(double force_N, const FaultMoment& moment) noexcept {
    if (moment.before || moment.begins) began_N_ = force_N;
    const double past_N = remember(force_N);
    if (!moment.during) return force_N;
    switch (plan_.kind) {
      case FaultKind::force_dropout:
        return 0.0;
      case FaultKind::force_bias:
        return force_N + plan_.size;
      case FaultKind::force_sensor_stuck:
        return began_N_;
      case FaultKind::force_sensor_gain:
        return plan_.size * force_N;
      case FaultKind::force_sensor_reversed:
        return -force_N;
      case FaultKind::force_sensor_drift:
        return force_N + plan_.size * moment.since_s;
      case FaultKind::force_sensor_late:
        return past_N;
      default:
        return force_N;
    }
  }

 private:
  /// The reading of `size` ago, where the plan asks for it.
  double remember(double force_N) noexcept {
    if (past_N_.empty()) return force_N;
    std::swap(past_N_[next_], force_N);
    next_ = (next_ + 1) % past_N_.size();
    return force_N;
  }

  FaultPlan plan_;
  double began_N_ = 0.0;        ///< the reading when the fault began
  std::vector<double> past_N_;  ///< a ring
  std::size_t next_ = 0;
};

}  // namespace tactus::simulation
