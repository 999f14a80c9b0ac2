// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/agreed_parameters.hpp>
#include <tactus/kernel/station/agreed_arms.hpp>
#include <tactus/simulation/experiments/arm_faults/plan.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_pair.hpp>

#include <array>
#include <cstddef>
#include <vector>

namespace tactus::experiments {

/// What the program of a site takes both arms for: what the run states, or what a plan makes of it at its site. A wrong
/// model is one file, from which both sites are started.
struct FaultyArmConfiguration {
  ArmTappingParams params;
  station::DescribedArms arms;

  /// The keys in which sites are made to differ, one for each choice.
  static constexpr std::array keys{"arm.tool.z_m",
                                   "rig.leader_gate.force_limit_N",
                                   "rig.follower_gate.velocity_limit_m_per_s",
                                   "rig.supervision.watchdog.timeout_s",
                                   "control.force_gain",
                                   "rig.gripper.stiffness_N_m_per_rad",
                                   "arm"};
  static std::size_t key_of(const FaultPlan& plan) { return static_cast<std::size_t>(plan.choice) % keys.size(); }

  FaultyArmConfiguration(const ArmPairSetup& setup, const FaultPlan& plan, FaultSite site);

  /// What it must have in common with the other site.
  [[nodiscard]] station::AgreedArms agreed() const { return station::agreed_arms(params, arms); }

 private:
  void differ(std::size_t key);
  void overstate(const FaultPlan& plan);
};

}  // namespace tactus::experiments
