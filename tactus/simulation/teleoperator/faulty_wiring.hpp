// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/simulation/teleoperator/fault_moment.hpp>

namespace tactus::simulation {

/// The cables from a site's sensors to its inputs. Swapped, each signal is read at the scale of the other: both are
/// taken as analogue, with the same volts at the end of their range. Of a plan for something else nothing is swapped.
class FaultyWiring {
 public:
  FaultyWiring(const FaultPlan& plan, FaultSite site)
      : swapped_(plan.kind == FaultKind::channels_swapped && plan.site == site) {}

  /// Puts what arrives at the two inputs in place of what the sensors read. Once a tick. Real-time safe.
  void step(double& position_m, double& force_N, const FaultMoment& moment) const noexcept {
    if (!swapped_ || !moment.during) return;
    const double position_read_m = force_N * metre_per_newton;
    force_N = position_m / metre_per_newton;
    position_m = position_read_m;
  }

 private:
  static constexpr double metre_per_newton = 0.2 / 10.0;  ///< of the ends of the ranges
  bool swapped_;
};

}  // namespace tactus::simulation
