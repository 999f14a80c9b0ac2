// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/simulation/teleoperator/fault_moment.hpp>

#include <algorithm>
#include <cmath>

namespace tactus::simulation {

/// What is between a site's gate and the current of a motor: a drive that may fail, with an enable line. Of a plan
/// that is for another part or site it is a sound one.
///
/// One that is cooled poorly has a winding whose warmth follows the square of the force with the time constant below,
/// 1 being as warm as it may become, at the force `size` for ever. One of a `slow_stop` whose `size` is above 0 lets
/// its force fall no faster than `size` N/s.
class FaultyActuator {
 public:
  /// Of a winding that is cooled poorly.
  static constexpr double winding_s = 10.0;

  FaultyActuator(const FaultPlan& plan, FaultSite site, double tick_s)
      : plan_(plan), here_(plan.site == site), tick_s_(tick_s), cools_(std::exp(-tick_s / winding_s)) {}

  /// The force in N that the drive is made to give, from the commanded one; none where it is not `enabled`. Once
  /// a tick. Real-time safe.
  double step(double commanded_N, bool enabled, const FaultMoment& moment) noexcept {
    if (!moment.during) last_N_ = commanded_N;
    // An old command states that the drive is enabled, too.
    if (here_ && plan_.kind == FaultKind::stale_commands && moment.during) return obey_old(commanded_N, moment);
    if (here_ && plan_.kind == FaultKind::slow_stop && plan_.size > 0.0 && moment.during) return follow(commanded_N);
    if (!enabled) return 0.0;
    if (!here_ || !moment.during) return commanded_N;
    switch (plan_.kind) {
      case FaultKind::motor_reversed:
        return -commanded_N;
      case FaultKind::torque_constant:
        return plan_.size * commanded_N;
      case FaultKind::actuator_dead:
      case FaultKind::power_lost:
        return 0.0;
      case FaultKind::actuator_stuck:
        return plan_.size;
      case FaultKind::actuator_saturated:
        return std::clamp(commanded_N, -plan_.size, plan_.size);
      case FaultKind::suspend:
        return misses_ticks(plan_, moment) ? obey_old(commanded_N, moment) : commanded_N;
      case FaultKind::actuator_hot: {
        const double share = commanded_N / plan_.size;
        warmth_ = share * share + cools_ * (warmth_ - share * share);
        return commanded_N;
      }
      default:
        return commanded_N;
    }
  }
  /// Of a winding that is cooled poorly; above 1 it is damaged.
  [[nodiscard]] double warmth() const noexcept { return warmth_; }

 private:
  /// A drive that keeps its power until its force has fallen to zero, at the rate limit with which it may grow.
  double follow(double commanded_N) noexcept {
    const double most_N = plan_.size * tick_s_;
    return last_N_ += std::clamp(commanded_N - last_N_, -most_N, most_N);
  }
  /// A drive whose commands stay the same. It releases them once they are `size` s old.
  double obey_old(double commanded_N, const FaultMoment& moment) noexcept {
    if (moment.begins) last_N_ = commanded_N;
    return moment.since_s < plan_.size ? last_N_ : 0.0;
  }

  FaultPlan plan_;
  bool here_;
  double tick_s_;
  double last_N_ = 0.0;  ///< commanded before the fault
  double cools_;         ///< in a tick
  double warmth_ = 0.0;
};

}  // namespace tactus::simulation
