#pragma once

#include <tactus/simulation/fault_moment.hpp>

#include <algorithm>

namespace tactus::simulation {

/// What stands between a site's gate and the current of a motor: a drive that may fail, with an enable line and a
/// supply. Of a plan that is for another part or site it is a sound one.
class FaultyActuator {
 public:
  FaultyActuator(const FaultPlan& plan, FaultSite site) : plan_(plan), here_(plan.site == site) {}

  /// The force in N that the drive is made to give, from the one that it is told. Once a tick. Real-time safe.
  double step(double commanded_N, const FaultMoment& moment) noexcept {
    if (!moment.during) last_N_ = commanded_N;
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
      case FaultKind::stale_commands:
        return obey_old(commanded_N, moment);
      default:
        return commanded_N;
    }
  }

 private:
  /// A drive whose commands stay the same. It lets go of them once they are `size` s old.
  double obey_old(double commanded_N, const FaultMoment& moment) noexcept {
    if (moment.begins) last_N_ = commanded_N;
    return moment.since_s < plan_.size ? last_N_ : 0.0;
  }

  FaultPlan plan_;
  bool here_;
  double last_N_ = 0.0;  ///< told before the fault
};

}  // namespace tactus::simulation
