// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/json.hpp>
#include <tactus/runtime/servo/servo_presentation.hpp>
#include <tactus/simulation/experiments/faults/experiment.hpp>
#include <tactus/simulation/real_time/real_time_faults.hpp>

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace tactus::real_time {

namespace {

using experiments::FaultOutcome;
using experiments::FaultRun;
using experiments::FaultsParams;
using simulation::FaultPlan;

constexpr std::size_t side_by_side = 6;
constexpr double longest_cut_s = 1.0;

/// What came of a run, and how the clock was kept meanwhile.
struct Played {
  FaultOutcome outcome;
  std::int64_t missed_ticks = 0;
  std::int64_t longest_gap_ticks = 0;
  std::int64_t late_ours = 0;
};

/// Runs in batches, each from the first to the last tick of the longest of its runs. What came of them keeps their
/// order; the last are missing where the end was asked for.
Result<std::vector<Played>> play(std::vector<FaultRun>& runs, const runtime::ServoThreadParams& servo,
                                 const runtime::EndRequest& end, runtime::ServoReport& all,
                                 const experiments::Progress& progress) {
  std::vector<Played> played;
  for (std::size_t first = 0; first < runs.size(); first += side_by_side) {
    const std::span<FaultRun> batch(runs.data() + first, std::min(side_by_side, runs.size() - first));
    const auto report = runtime::run_servo(servo, [batch, &end](const station::Tick& tick) noexcept {
      bool more = false;
      for (FaultRun& run : batch) more = run.step(tick.missed) || more;
      return more && !end.asked();
    });
    if (!report) return report.error();
    all.add(*report);
    if (end.asked()) break;
    for (const FaultRun& run : batch) {
      played.push_back({.outcome = run.outcome(),
                        .missed_ticks = report->missed,
                        .longest_gap_ticks = report->longest_gap,
                        .late_ours = report->late_ours()});
    }
    progress(static_cast<double>(played.size()) / static_cast<double>(runs.size()));
  }
  return played;
}

/// The runs of a row that did not survive, each run once more with no tick missed.
std::vector<experiments::LostInRealTime> lost_of(const experiments::FaultRow& row, const FaultsParams& params,
                                                 const std::vector<FaultPlan>& plans, std::span<const Played> played) {
  std::vector<experiments::LostInRealTime> lost;
  if (!row.monitored) return lost;
  for (std::size_t i = 0; i < played.size(); ++i) {
    const auto rule = experiments::broken_rule(row, plans[i], played[i].outcome, params);
    if (rule.empty()) continue;
    const auto on_time = experiments::run_fault(experiments::params_of(row, params), plans[i]);
    lost.push_back({.row = row,
                    .failure = {.number = plans[i].choice, .rule = rule},
                    .missed_ticks = played[i].missed_ticks,
                    .longest_gap_ticks = played[i].longest_gap_ticks,
                    .late_ours = played[i].late_ours,
                    .survives_on_time = on_time && experiments::broken_rule(row, plans[i], *on_time, params).empty()});
  }
  return lost;
}

}  // namespace

Result<experiments::Outcome> run_faults_in_real_time(
    const experiments::Request& request, const runtime::ServoThreadParams& servo, const experiments::Progress& progress,
    const std::function<Result<const runtime::EndRequest*>()>& listen) {
  if (auto error = experiments::refuse_variations(request)) return *std::move(error);
  const auto params = request.document.read<FaultsParams>();
  if (!params) return params.error();
  runtime::ServoThreadParams clock = servo;
  clock.rate_Hz = params->servo.rate_Hz;
  if (auto error = check_servo_thread(clock)) return *std::move(error);
  const auto table = experiments::run_faults(*params, [&progress](double done) { progress(0.5 * done); });
  if (!table) return request.document.locate(table.error());

  experiments::FaultsInRealTime real{.params = *params, .tallies = {}, .lost = {}, .timing = {}, .timing_json = {}};
  real.params.task.seeds = params->task.real_time_seeds;
  real.params.task.longest_cut_s = std::min(longest_cut_s, params->task.longest_cut_s);
  const auto rows = experiments::fault_rows(params->task.only);
  std::vector<FaultRun> runs;
  for (const auto& row : rows) {
    const auto of = experiments::params_of(row, real.params);
    for (const FaultPlan& plan : experiments::draw_plans(row, real.params)) {
      auto run = FaultRun::make(of, plan);
      if (!run) return request.document.locate(run.error());
      runs.push_back(*std::move(run));
    }
  }
  const auto end = listen();
  if (!end) return end.error();
  const runtime::ProcessRights process;  // once for all runs
  runtime::ServoReport kept;
  const auto played = play(runs, clock, **end, kept, [&progress](double done) { progress(0.5 + 0.5 * done); });
  if (!played) return played.error();
  const auto seeds = static_cast<std::size_t>(real.params.task.seeds);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const std::size_t first = std::min(row * seeds, played->size());
    const std::span of_row(played->data() + first, std::min(seeds, played->size() - first));
    std::vector<FaultOutcome> outcomes;
    for (const Played& run : of_row) outcomes.push_back(run.outcome);
    const std::vector<FaultPlan> plans = experiments::draw_plans(rows[row], real.params);
    real.tallies.push_back(experiments::tally(rows[row], real.params, plans, outcomes));
    const auto lost = lost_of(rows[row], real.params, plans, of_row);
    real.lost.insert(real.lost.end(), lost.begin(), lost.end());
  }
  real.timing = {timing_table(kept), late_ticks_table(kept)};
  real.timing_json = servo_json(kept);
  const bool interrupted = played->size() < runs.size();
  if (interrupted) {
    report::Table told({{"runs at the real clock"}, {"of"}}, "Interrupted");
    told.add_row({std::to_string(played->size()), std::to_string(runs.size())});
    real.timing.insert(real.timing.begin(), told);
  }
  auto outcome = experiments::present_faults(request, *params, *table, real);
  if (interrupted) {
    auto document = report::parse_json<nlohmann::ordered_json>(outcome.json);
    document["real_time"]["interrupted"] = {{"runs", played->size()}, {"of", runs.size()}};
    outcome.json = report::json_text(document);
  }
  return outcome;
}

}  // namespace tactus::real_time
