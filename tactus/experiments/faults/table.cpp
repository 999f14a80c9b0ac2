#include <tactus/experiments/faults/table.hpp>
#include <tactus/simulation/parallel.hpp>
#include <tactus/simulation/quantile.hpp>

#include <algorithm>
#include <cmath>

namespace tactus::experiments {

namespace {

void add(SiteHarm& worst, const SiteHarm& one) {
  worst.given_J = std::max(worst.given_J, one.given_J);
  worst.speed_m_per_s = std::max(worst.speed_m_per_s, one.speed_m_per_s);
  worst.strayed_m = std::max(worst.strayed_m, one.strayed_m);
  worst.peak_force_N = std::max(worst.peak_force_N, one.peak_force_N);
  worst.release_s = std::max(worst.release_s, one.release_s);
  worst.pressing_N = std::max(worst.pressing_N, one.pressing_N);
  worst.drive_step_N = std::max(worst.drive_step_N, one.drive_step_N);
}

void add(FaultOutcome& worst, const FaultOutcome& one) {
  worst.not_finite += one.not_finite;
  worst.stale_applied += one.stale_applied;
  worst.steps_above_rate += one.steps_above_rate;
  worst.forces_above_limit += one.forces_above_limit;
  worst.active_without_arming += one.active_without_arming;
  worst.peak_force_N = std::max(worst.peak_force_N, one.peak_force_N);
  worst.given_J = std::max(worst.given_J, one.given_J);
  worst.resume_step_N = std::max(worst.resume_step_N, one.resume_step_N);
  worst.release_s = std::max(worst.release_s, one.release_s);
  worst.fault_N = std::max(worst.fault_N, one.fault_N);
  worst.winding_warmth = std::max(worst.winding_warmth, one.winding_warmth);
  add(worst.master, one.master);
  add(worst.slave, one.slave);
  if (!one.arms) return;
  if (!worst.arms) worst.arms.emplace();
  for_each_signal<ArmHarm>([&](const auto& signal) {
    double& most = *worst.arms.*signal.member;
    most = std::max(most, *one.arms.*signal.member);
  });
}

}  // namespace

std::vector<FaultPlan> draw_plans(const FaultRow& row, const FaultsParams& params) {
  std::vector<FaultPlan> plans;
  for (std::int64_t i = 0; i < params.task.seeds; ++i) {
    plans.push_back(draw_plan(row.kind, i, params.task.seed, params.task.longest_cut_s));
  }
  return plans;
}

std::vector<FaultPlan> draw_control_plans(const FaultRow& row, const FaultsParams& params) {
  if (row.control.shows == nullptr) return draw_plans(row, params);
  std::vector<FaultPlan> plans;
  for (std::int64_t i = 0; static_cast<std::int64_t>(plans.size()) < params.task.seeds; ++i) {
    const FaultPlan plan = draw_plan(row.kind, i, params.task.seed, params.task.longest_cut_s);
    if (row.control.shows(plan, params)) plans.push_back(plan);
  }
  return plans;
}

FaultTally tally(const FaultRow& row, const FaultsParams& params, const std::vector<FaultPlan>& plans,
                 const std::vector<FaultOutcome>& outcomes) {
  std::vector<std::string_view> broken_rules;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    broken_rules.push_back(broken_rule(row, plans[i], outcomes[i], params));
  }
  return tally(row, plans, outcomes, broken_rules, params.task.diverged_above_J);
}

FaultTally tally(const FaultRow& row, const std::vector<FaultPlan>& plans, const std::vector<FaultOutcome>& outcomes,
                 const std::vector<std::string_view>& broken_rules, double diverged_above_J) {
  FaultTally sum{.row = row, .failures = {}, .worst = {}};
  std::vector<double> stop_s, detection;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const FaultOutcome& one = outcomes[i];
    ++sum.tried;
    if (const auto rule = broken_rules[i]; rule.empty()) {
      ++sum.survived;
    } else {
      sum.failures.push_back({plans[i].choice, rule});
    }
    sum.diverged += one.given_J > diverged_above_J;
    sum.simulated_s += plans[i].start_s + plans[i].length_s;
    if (one.stopped) stop_s.push_back(one.time_to_stop_s);
    if (one.detection_ticks >= 0) detection.push_back(static_cast<double>(one.detection_ticks));
    add(sum.worst, one);
  }
  sum.stopped = static_cast<std::int64_t>(stop_s.size());
  sum.detected = static_cast<std::int64_t>(detection.size());
  if (!stop_s.empty()) {
    sum.time_to_stop_median_s = simulation::quantile(stop_s, 0.5);
    sum.time_to_stop_most_s = simulation::quantile(stop_s, 1.0);
  }
  if (!detection.empty()) {
    sum.detection_ticks_median = simulation::quantile(detection, 0.5);
    sum.detection_ticks_most = simulation::quantile(detection, 1.0);
  }
  return sum;
}

Error unknown_row(const std::string& key, const std::string& id, const std::vector<FaultRow>& rows) {
  std::string ids;
  for (const FaultRow& row : rows) ids += (ids.empty() ? "" : ", ") + std::string(row.id);
  return {.code = ErrorCode::out_of_bounds,
          .parameter = key,
          .message = "\"" + id + "\" is the id of no row: one of " + ids,
          .place = {}};
}

Result<std::vector<FaultRow>> chosen_rows(const FaultsParams& params) {
  auto rows = fault_rows(params.task.only);
  if (!rows.empty()) return rows;
  return unknown_row("task.only", params.task.only, fault_rows());
}

Result<FaultTable> run_faults(const FaultsParams& params, const std::function<void(double)>& progress) {
  if (auto error = validate(params)) return *std::move(error);
  const auto rows = chosen_rows(params);
  if (!rows) return rows.error();
  struct Block {
    const FaultRow& row;
    bool controls;
    simulation::Teleoperator::Params params;
    std::vector<FaultPlan> plans;
    std::vector<FaultOutcome> outcomes;
  };
  const auto seeds = static_cast<std::size_t>(params.task.seeds);
  std::vector<Block> blocks;
  for (const FaultRow& row : *rows) {
    Block block{row, false, params_of(row, params), draw_plans(row, params), std::vector<FaultOutcome>(seeds)};
    // What can be made once can be made always: a plan changes no parameter of the parts.
    FaultPlan nothing{.start_s = 0.0, .impairment = {}};
    if (const auto tried = run_fault(block.params, nothing); !tried) return tried.error();
    blocks.push_back(block);
    if (row.control.switch_off == nullptr) continue;
    block.controls = true;
    block.plans = draw_control_plans(row, params);
    simulation::Teleoperator::Params off = block.params;
    row.control.switch_off(off, nothing);
    if (const auto tried = run_fault(off, nothing); !tried) return tried.error();
    blocks.push_back(std::move(block));
  }
  simulation::for_each_in_parallel(
      blocks.size() * seeds,
      [&](std::size_t index) {
        Block& block = blocks[index / seeds];
        const std::size_t i = index % seeds;
        simulation::Teleoperator::Params of = block.params;
        FaultPlan plan = block.plans[i];
        if (block.controls) block.row.control.switch_off(of, plan);
        block.outcomes[i] = run_fault(of, plan).value();
      },
      progress);
  FaultTable table;
  for (const Block& block : blocks) {
    (block.controls ? table.controls : table.rows).push_back(tally(block.row, params, block.plans, block.outcomes));
  }
  return table;
}

}  // namespace tactus::experiments
