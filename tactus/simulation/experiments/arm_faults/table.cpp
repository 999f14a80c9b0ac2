// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/kernel/station/watched_arm.hpp>
#include <tactus/simulation/experiments/arm_faults/arm_faults.hpp>
#include <tactus/simulation/experiments/faults/presentation.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tactus::experiments {

namespace {

/// Of the arm's joints by its URDF, and of drives that run the damping that either site asks for, as a rig file must
/// allow it.
Joints<station::DeviceLimits> limits_of(const DescribedArm& described, const ArmTappingParams& params) {
  Joints<station::DeviceLimits> limits(described.joints.size());
  const auto leader_damping = params.control.drive_damping.of(limits.size());
  const auto follower_gains = params.control.follower.gains.of(limits.size());
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const arm::JointLimits& joint = described.arm.chain.joints[i].limits;
    limits[i].damping_N_s_per_m =
        std::max(leader_damping[i].damping_N_m_s_per_rad, follower_gains[i].damping_N_m_s_per_rad);
    limits[i].velocity_step_m_per_s = described.arm.motors[i].velocity_step_rad_per_s;
    limits[i].force_N = joint.effort_N_m;
    limits[i].velocity_m_per_s = joint.velocity_rad_per_s;
    limits[i].position_m = std::max(std::fabs(joint.lower_rad), std::fabs(joint.upper_rad));
  }
  return limits;
}

std::string_view broken_by_model(const FaultOutcome& outcome) {
  // Of standards for people next to robots none states what an arm may do before it is armed: these are what a hand
  // that rests on it bears without a start.
  constexpr double most_rad = 0.03, most_rad_per_s = 0.5;
  const ArmHarm& arms = *outcome.arms;
  if (outcome.active_in_fault) return "followed though the model is wrong";
  if (arms.moved_rad > most_rad || arms.leapt_rad_per_s > most_rad_per_s) return "a joint leapt";
  return arms.had_power && outcome.detection_ticks < 0 ? "not detected" : "";
}

std::string_view broken_by_arms(const FaultPlan& plan, const FaultOutcome& outcome, const ArmTappingParams& params) {
  const ArmHarm& arms = *outcome.arms;
  if (arms.fastest_joint_share > control::SafetyGate::fault_factor) return "a joint faster than its gate lets it be";
  if (arms.sank_m > params.faults.bounds.sank_m) return "an arm sank that was to be carried";
  if (plan.kind == FaultKind::configurations_differ) {
    return outcome.active_in_fault ? "armed although the sites differ" : arms.named ? "" : "the key was not named";
  }
  if (plan.kind == FaultKind::model_wrong) return broken_by_model(outcome);
  if (!is_wired_so(plan)) return {};
  if (outcome.active_in_fault) return "followed though a joint was wired wrongly";
  return outcome.detection_ticks < 0 ? "not detected" : "";
}

}  // namespace

arm_plants::ArmPlant::Params ArmFaultBench::held_leader() const {
  arm_plants::ArmPlant::Params held = setup.leader.arm;
  held.carried_kg = setup.params.person.hand.mass_kg;
  return held;
}

double ArmFaultBench::wired_s() const {
  const control::SupervisionParams& supervision = setup.params.rig.supervision;
  constexpr double begins_s = 0.5;
  return begins_s + 2.0 * supervision.blend_s + setup.params.rig.support.raise_s +
         control::SupportRaiseOf<Joints<control::Message>>::settles_s +
         2.0 * static_cast<double>(leader_gates.size()) * (supervision.probe.duration_s + supervision.blend_s);
}

Result<ArmFaultBench> make_arm_fault_bench(const ArmTappingParams& params, const std::filesystem::path& folder) {
  if (Check wrong = station::refuse_tare(params)) return *std::move(wrong);
  auto setup = set_up_arm_pair(params, folder);
  if (!setup) return setup.error();
  const Joints<station::DeviceLimits> leader_limits = limits_of(setup->leader, params),
                                      follower_limits = limits_of(setup->follower, params);
  // What can be made once can be made always: a plan changes no parameter of the parts.
  if (const auto sites = station::supervise_arms(params, *setup, leader_limits, follower_limits, {}); !sites) {
    return sites.error();
  }
  arm_plants::ArmPlant::Params held = setup->leader.arm;
  held.carried_kg = params.person.hand.mass_kg;
  auto leader = arm_plants::ArmPlant::make(held, setup->leader.start);
  if (!leader) return under("arm", leader.error());
  auto follower = arm_plants::ArmPlant::make(setup->follower.arm, setup->follower.start);
  if (!follower) return under(station::differs(params.arm) ? "arm.follower" : "arm", follower.error());
  const Seconds tick{1.0 / params.servo.rate_Hz};
  const auto leader_watch = station::motor_watch(params, setup->leader),
             follower_watch = station::motor_watch(params, setup->follower);
  if (!leader_watch) return leader_watch.error();
  if (!follower_watch) return follower_watch.error();
  if (const auto contact = mechanics::Environment::make(params.wall.environment(), tick); !contact) {
    return under("wall", contact.error());
  }
  if (const auto person = arm_plants::ToolOperator::make(params.person, tick, leader->tool()); !person) {
    return under("operator", person.error());
  }
  const auto delay = static_cast<std::size_t>(params.servo.extra_delay_cycles);
  return ArmFaultBench{.setup = *setup,
                       .leader_limits = leader_limits,
                       .follower_limits = follower_limits,
                       .leader_gates = joint_gates(params.rig.leader_gate, leader_limits),
                       .follower_gates = joint_gates(params.rig.follower_gate, follower_limits),
                       .leader_watch = *leader_watch,
                       .follower_watch = *follower_watch,
                       .leader = {*std::move(leader), leader_limits, delay},
                       .follower = {*std::move(follower), follower_limits, delay}};
}

FaultPlan draw_arm_plan(const FaultRow& row, const ArmFaultBench& bench, std::int64_t index) {
  const ArmTappingParams& params = bench.setup.params;
  control::SafetyGate::Params gate = params.rig.leader_gate;
  gate.encoder.fastest_m_per_s =
      std::max(gate.encoder.fastest_m_per_s, params.rig.follower_gate.encoder.fastest_m_per_s);
  return draw_arm_plan(row.kind, index, params.task.seed, gate, params.servo.rate_Hz, bench.wired_s());
}

std::string_view broken_arm_rule(const FaultRow& row, const FaultPlan& plan, const FaultOutcome& outcome,
                                 const ArmTappingParams& params) {
  if (const auto rule = broken_rule_of_all(outcome); !rule.empty()) return rule;
  if (!is_there_at_start(plan) && !outcome.became_active) return "did not follow before";
  if (row.resumes && !outcome.active_at_end) return not_resumed;
  const auto& bounds = params.faults.bounds;
  if (const auto bound = broken_bound(outcome, bounds, bounds.release_s); !bound.empty()) return bound;
  if (const auto rule = broken_by_arms(plan, outcome, params); !rule.empty()) return rule;
  if (row.kind == FaultKind::none) return tripped_on_clean_data(outcome);
  const double rate_Hz = params.servo.rate_Hz;
  return broken_duty(arm_duty_of(plan, params.rig.supervision, rate_Hz), plan, outcome, rate_Hz);
}

Result<FaultTable> run_arm_faults(const ArmFaultBench& bench, const Progress& progress) {
  const ArmTappingParams& params = bench.setup.params;
  const std::vector<FaultRow> rows = arm_fault_rows(params.faults.only);
  if (rows.empty()) return unknown_row("faults.only", params.faults.only, arm_fault_rows());
  const auto seeds = static_cast<std::size_t>(params.faults.seeds);
  struct Run {
    std::size_t number = 0;
    FaultPlan plan{.impairment = {}};
    FaultOutcome outcome;
  };
  std::vector<Run> runs;
  std::optional<FaultTallier> tallier;
  FaultTable table;
  run_in_stretches(
      rows.size() * seeds,
      [&](std::size_t first, std::size_t size) {
        runs.resize(size);
        for (std::size_t place = 0; place < size; ++place) {
          const std::size_t number = first + place;
          runs[place].number = number;
          runs[place].plan = draw_arm_plan(rows[number / seeds], bench, static_cast<std::int64_t>(number % seeds));
        }
      },
      [&](std::size_t place) { runs[place].outcome = run_arm_fault(bench, runs[place].plan); },
      [&](std::size_t place) {
        const Run& run = runs[place];
        const FaultRow& row = rows[run.number / seeds];
        if (run.number % seeds == 0) tallier.emplace(row, params.faults.bounds.given_J);
        tallier->add(run.plan, run.outcome, broken_arm_rule(row, run.plan, run.outcome, params));
        if ((run.number + 1) % seeds == 0) table.rows.push_back(std::move(*tallier).finish());
      },
      progress);
  return table;
}

Result<Outcome> arm_faults(const Request& request, const Progress& progress) {
  if (auto error = refuse_variations(request)) return *std::move(error);
  const auto params = request.document.read<ArmTappingParams>();
  if (!params) return params.error();
  const auto bench = make_arm_fault_bench(*params, std::filesystem::path(request.document.name()).parent_path());
  if (!bench) return request.document.locate(bench.error());
  const auto table = run_arm_faults(*bench, progress);
  if (!table) return request.document.locate(table.error());
  const FaultsShown shown{
      .kind = std::string(name_of(params->task.kind)),
      .subject =
          "Two supervised arms, an operator who taps a stiff surface through them, and one fault in each run, drawn by "
          "its "
          "seed, at a joint that is drawn too. A witness outside of the sites reads what reaches the motors, what was "
          "sent when, and what becomes of both tools.",
      .seeds = params->faults.seeds,
      .rate_Hz = params->servo.rate_Hz,
      .rate_limit_N_per_s = params->rig.leader_gate.rate_limit_N_per_s,
      .configuration = configuration::to_toml(*params),
      .motors_give = "N m"};
  return present_faults(request, shown, *table, std::nullopt);
}

}  // namespace tactus::experiments
