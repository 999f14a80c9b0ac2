#pragma once

#include <tactus/simulation/fault_moment.hpp>

namespace tactus::simulation {

/// Whether a site's process lives and is stepped at a tick. Of a plan that is for another part or site it always is.
class FaultyClock {
 public:
  FaultyClock(const FaultPlan& plan, FaultSite site) : plan_(plan), here_(plan.site == site) {}

  enum class Beat {
    steps,
    stands,  ///< not stepped: its motor keeps the last force
    dead     ///< the process is gone; started again with the next beat
  };
  /// Once a tick. Real-time safe.
  Beat step(const FaultMoment& moment) noexcept {
    if (!here_ || !moment.during) return Beat::steps;
    switch (plan_.kind) {
      case FaultKind::restart:
        return Beat::dead;
      case FaultKind::stall:
        return Beat::stands;
      default:
        return Beat::steps;
    }
  }

 private:
  FaultPlan plan_;
  bool here_;
};

}  // namespace tactus::simulation
