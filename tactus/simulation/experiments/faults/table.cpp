// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/faults/table.hpp>
#include <tactus/simulation/teleoperator/parallel.hpp>
#include <tactus/simulation/teleoperator/quantile.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

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

FaultPlan PlanSource::next() {
  while (true) {
    const FaultPlan plan = draw_plan(row_->kind, drawn_++, params_->task.seed, params_->task.longest_cut_s);
    if (!controls_ || row_->control.shows(plan, *params_)) return plan;
  }
}

std::vector<FaultPlan> draw_plans(const FaultRow& row, const FaultsParams& params) {
  PlanSource source(row, params, false);
  std::vector<FaultPlan> plans;
  for (std::int64_t i = 0; i < params.task.seeds; ++i) plans.push_back(source.next());
  return plans;
}

FaultTally tally(const FaultRow& row, const FaultsParams& params, const std::vector<FaultPlan>& plans,
                 const std::vector<FaultOutcome>& outcomes) {
  FaultTallier tallier(row, params.task.diverged_above_J);
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    tallier.add(plans[i], outcomes[i], broken_rule(row, plans[i], outcomes[i], params));
  }
  return std::move(tallier).finish();
}

void FaultTallier::add(const FaultPlan& plan, const FaultOutcome& outcome, std::string_view rule) {
  ++sum_.tried;
  if (rule.empty()) {
    ++sum_.survived;
  } else {
    if (sum_.failures.size() < FaultTally::most_failures) sum_.failures.push_back({plan.choice, rule});
    const auto place = std::ranges::lower_bound(sum_.broken, rule, {}, &BrokenRule::rule);
    const bool known = place != sum_.broken.end() && place->rule == rule;
    ++(known ? place : sum_.broken.insert(place, {.rule = rule, .first = plan.choice}))->count;
  }
  sum_.diverged += outcome.given_J > diverged_above_J_;
  sum_.simulated_s += plan.start_s + plan.length_s;
  if (outcome.stopped) stop_s_.push_back(outcome.time_to_stop_s);
  if (outcome.detection_ticks >= 0) detection_.push_back(static_cast<double>(outcome.detection_ticks));
  experiments::add(sum_.worst, outcome);
}

FaultTally FaultTallier::finish() && {
  sum_.stopped = static_cast<std::int64_t>(stop_s_.size());
  sum_.detected = static_cast<std::int64_t>(detection_.size());
  if (!stop_s_.empty()) {
    sum_.time_to_stop_median_s = simulation::quantile(stop_s_, 0.5);
    sum_.time_to_stop_most_s = simulation::quantile(stop_s_, 1.0);
  }
  if (!detection_.empty()) {
    sum_.detection_ticks_median = simulation::quantile(detection_, 0.5);
    sum_.detection_ticks_most = simulation::quantile(detection_, 1.0);
  }
  return std::move(sum_);
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

void run_in_stretches(std::size_t count, const std::function<void(std::size_t first, std::size_t size)>& prepare,
                      const std::function<void(std::size_t place)>& run,
                      const std::function<void(std::size_t place)>& take, const std::function<void(double)>& progress) {
  for (std::size_t first = 0; first < count; first += most_runs_at_once) {
    const std::size_t size = std::min(most_runs_at_once, count - first);
    prepare(first, size);
    simulation::for_each_in_parallel(size, run, [&](double share) {
      progress((static_cast<double>(first) + share * static_cast<double>(size)) / static_cast<double>(count));
    });
    for (std::size_t place = 0; place < size; ++place) take(place);
  }
}

Result<FaultTable> run_faults(const FaultsParams& params, const std::function<void(double)>& progress) {
  if (auto error = validate(params)) return *std::move(error);
  const auto rows = chosen_rows(params);
  if (!rows) return rows.error();
  struct Block {
    const FaultRow& row;
    bool controls;
    simulation::Teleoperator::Params params;
  };
  std::vector<Block> blocks;
  for (const FaultRow& row : *rows) {
    Block block{row, false, params_of(row, params)};
    // What can be made once can be made always: a plan changes no parameter of the parts.
    FaultPlan nothing{.start_s = 0.0, .impairment = {}};
    if (const auto tried = run_fault(block.params, nothing); !tried) return tried.error();
    blocks.push_back(block);
    if (row.control.switch_off == nullptr) continue;
    block.controls = true;
    simulation::Teleoperator::Params off = block.params;
    row.control.switch_off(off, nothing);
    if (const auto tried = run_fault(off, nothing); !tried) return tried.error();
    blocks.push_back(std::move(block));
  }
  const auto seeds = static_cast<std::size_t>(params.task.seeds);
  struct Run {
    std::size_t block = 0;
    FaultPlan plan{.impairment = {}};
    FaultOutcome outcome;
  };
  std::vector<Run> runs;
  std::size_t drawn = 0, taken = 0;
  std::optional<PlanSource> source;
  std::optional<FaultTallier> tallier;
  FaultTable table;
  run_in_stretches(
      blocks.size() * seeds,
      [&](std::size_t /*first*/, std::size_t size) {
        runs.resize(size);
        for (Run& run : runs) {
          run.block = drawn / seeds;
          const Block& block = blocks[run.block];
          if (drawn++ % seeds == 0) source.emplace(block.row, params, block.controls);
          run.plan = source->next();
        }
      },
      [&](std::size_t place) {
        Run& run = runs[place];
        const Block& block = blocks[run.block];
        simulation::Teleoperator::Params of = block.params;
        FaultPlan plan = run.plan;
        if (block.controls) block.row.control.switch_off(of, plan);
        run.outcome = run_fault(of, plan).value();
      },
      [&](std::size_t place) {
        const Run& run = runs[place];
        const Block& block = blocks[run.block];
        if (taken++ % seeds == 0) tallier.emplace(block.row, params.task.diverged_above_J);
        tallier->add(run.plan, run.outcome, broken_rule(block.row, run.plan, run.outcome, params));
        if (taken % seeds == 0) (block.controls ? table.controls : table.rows).push_back(std::move(*tallier).finish());
      },
      progress);
  return table;
}

}  // namespace tactus::experiments
