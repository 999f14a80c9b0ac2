#pragma once

#include <tactus/simulation/fault_moment.hpp>

namespace tactus::simulation {

/// What a faulty force sensor at the slave's tip reports of a true reading. Of a plan that is for another part it is a
/// sound one.
class FaultyForceSensor {
 public:
  explicit FaultyForceSensor(const FaultPlan& plan) : plan_(plan) {}

  /// The reading in N that reaches the site, from the true one. Once a tick. Real-time safe.
  double step(double force_N, const FaultMoment& moment) noexcept {
    if (!moment.during) return force_N;
    switch (plan_.kind) {
      case FaultKind::force_dropout:
        return 0.0;
      case FaultKind::force_bias:
        return force_N + plan_.size;
      default:
        return force_N;
    }
  }

 private:
  FaultPlan plan_;
};

}  // namespace tactus::simulation
