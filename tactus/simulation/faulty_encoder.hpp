#pragma once

#include <tactus/simulation/fault_moment.hpp>

#include <cmath>

namespace tactus::simulation {

/// What a faulty encoder reports of a true reading. Of a plan that is for another part or site it is a sound one.
class FaultyEncoder {
 public:
  FaultyEncoder(const FaultPlan& plan, FaultSite site) : plan_(plan), here_(plan.site == site) {}

  /// The reading in m that reaches the site, from the true one. Once a tick. Real-time safe.
  double step(double position_m, const FaultMoment& moment) noexcept {
    if (moment.before || moment.begins) began_m_ = position_m;
    if (!here_) return position_m;
    switch (plan_.kind) {
      case FaultKind::encoder_spike:
        return moment.begins ? position_m + plan_.size : position_m;
      case FaultKind::encoder_wrap:
        return moment.during ? position_m + plan_.size : position_m;
      case FaultKind::encoder_freeze:
        return moment.during ? began_m_ : position_m;
      default:
        return position_m;
    }
  }

 private:
  FaultPlan plan_;
  bool here_;
  double began_m_ = 0.0;  ///< the reading when the fault began
};

}  // namespace tactus::simulation
