// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/configuration/document.hpp>
#include <tactus/kernel/station/supervised_arms.hpp>
#include <tactus/simulation/experiments/arm_faults/plan.hpp>
#include <tactus/simulation/experiments/experiment.hpp>
#include <tactus/simulation/experiments/faults/table.hpp>

#include <filesystem>
#include <string_view>

/// Two supervised arms in virtual time, an operator who taps a surface through them, and one fault: the table of faults
/// of arms. Gates and supervision are those of `[rig]`, as real motors have them.
namespace tactus::experiments {

/// What all runs have in common, checked.
struct ArmFaultBench {
  ArmPairSetup setup;
  Joints<station::DeviceLimits> leader_limits, follower_limits;      ///< of the arms, from their URDFs
  Joints<control::SafetyGate::Params> leader_gates, follower_gates;  ///< of each joint, within these
  arm_control::MotorWatch leader_watch, follower_watch;
  arm_plants::ArmDevice leader, follower;  ///< at rest, in nobody's hand
  [[nodiscard]] double tick_s() const { return 1.0 / setup.params.servo.rate_Hz; }
  /// The leader with the mass of the hand that holds it.
  [[nodiscard]] arm_plants::ArmPlant::Params held_leader() const;
  /// How long motors that are wired wrongly are looked at: until every one would have been tried, and some more.
  [[nodiscard]] double wired_s() const;
};

/// Reads the URDFs, from `folder` on. Errors: those of `set_up_arm_pair` and `supervise_arms`.
Result<ArmFaultBench> make_arm_fault_bench(const ArmTappingParams& params, const std::filesystem::path& folder);

/// Plan number `index` of a row.
FaultPlan draw_arm_plan(const FaultRow& row, const ArmFaultBench& bench, std::int64_t index);
/// Runs one plan. An arm lies on a rest until its site compensates gravity. Once the drives of a site have no power its
/// arm falls, and whoever clears the fault catches it first. The bounds on positions, velocities and energy hold for an
/// arm that has power; the bounds on forces on people always hold.
FaultOutcome run_arm_fault(const ArmFaultBench& bench, const FaultPlan& plan);
/// The rule that a run broke, in words; empty where it kept everything that its row asks for.
std::string_view broken_arm_rule(const FaultRow& row, const FaultPlan& plan, const FaultOutcome& outcome,
                                 const ArmTappingParams& params);

/// Runs the rows that the parameters ask for on all cores; equal parameters give equal results, however many cores
/// there are. Errors: `out_of_bounds` for the id of no row.
Result<FaultTable> run_arm_faults(const ArmFaultBench& bench, const Progress& progress);

/// The table of faults for a document that `is_of_arms`. Errors carry the place of the value that caused them.
Result<Outcome> arm_faults(const Request& request, const Progress& progress);

}  // namespace tactus::experiments
