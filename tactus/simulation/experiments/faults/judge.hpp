// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/packet.hpp>
#include <tactus/simulation/experiments/faults/outcome.hpp>
#include <tactus/simulation/experiments/faults/plan.hpp>
#include <tactus/simulation/experiments/faults/witness.hpp>
#include <tactus/simulation/teleoperator/fault_moment.hpp>

namespace tactus::experiments {

/// Follows both sites through a run and writes down what came of the fault.
class FaultJudge {
 public:
  /// One site at a tick, after it was stepped.
  struct SiteView {
    control::SiteState state = control::SiteState::configure;
    bool gone = false;    ///< its process is dead
    double step_N = 0.0;  ///< largest change of a force of its actuators
    bool left_workspace = false;
    SiteTruth truth{};
  };

  FaultJudge(const HarmWitness& at_master, const HarmWitness& at_slave, double tick_s)
      : tick_s_(tick_s), at_master_(at_master), at_slave_(at_slave) {}

  /// Once a tick; the fault ends at `end_s`.
  void see(const SiteView& master, const SiteView& slave, const FaultMoment& moment, double end_s,
           FaultOutcome& outcome);
  /// Whether the operator must clear and arm after the fault.
  [[nodiscard]] bool rearms() const { return rearms_; }

 private:
  void see_states(const SiteView& master, const SiteView& slave, const FaultMoment& moment, bool before_rearming,
                  FaultOutcome& outcome);

  double tick_s_;
  HarmWitness at_master_, at_slave_;
  EnergyWitness energy_;
  bool rearms_ = false;
  bool left_[2] = {false, false};  ///< master, slave: `active` after the fault began
  double stopped_at_s_ = 0.0;      ///< neither site active any more
  double latched_at_s_ = -1.0;     ///< both sites, first; negative is never
};

}  // namespace tactus::experiments
