#include <tactus/experiments/faults/experiment.hpp>
#include <tactus/runtime/real_time_faults.hpp>
#include <tactus/runtime/servo_presentation.hpp>

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace tactus::runtime {

namespace {

using experiments::FaultOutcome;
using experiments::FaultRun;
using experiments::FaultsParams;
using simulation::FaultPlan;

constexpr std::size_t side_by_side = 6;
constexpr double longest_cut_s = 1.0;

/// Runs in batches, each from the first to the last tick of the longest of its runs. The outcomes keep their order; the
/// last are missing where the end was asked for.
Result<std::vector<FaultOutcome>> play(std::vector<FaultRun>& runs, const ServoThreadParams& servo,
                                       const EndRequest& end, ServoReport& all, const experiments::Progress& progress) {
  std::size_t over = 0;
  for (std::size_t first = 0; first < runs.size(); first += side_by_side) {
    const std::span<FaultRun> batch(runs.data() + first, std::min(side_by_side, runs.size() - first));
    const auto report = run_servo(servo, [batch, &end](const station::Tick& tick) noexcept {
      bool more = false;
      for (FaultRun& run : batch) more = run.step(tick.missed) || more;
      return more && !end.asked();
    });
    if (!report) return report.error();
    all.add(*report);
    if (end.asked()) break;
    over = first + batch.size();
    progress(static_cast<double>(over) / static_cast<double>(runs.size()));
  }
  std::vector<FaultOutcome> outcomes;
  for (std::size_t i = 0; i < over; ++i) outcomes.push_back(runs[i].outcome());
  return outcomes;
}

}  // namespace

Result<experiments::Outcome> run_faults_in_real_time(const experiments::Request& request,
                                                     const ServoThreadParams& servo,
                                                     const experiments::Progress& progress,
                                                     const std::function<Result<const EndRequest*>()>& listen) {
  if (auto error = experiments::refuse_variations(request)) return *std::move(error);
  const auto params = request.document.read<FaultsParams>();
  if (!params) return params.error();
  ServoThreadParams clock = servo;
  clock.rate_Hz = params->servo.rate_Hz;
  if (auto error = check_servo_thread(clock)) return *std::move(error);
  const auto table = experiments::run_faults(*params, [&progress](double done) { progress(0.5 * done); });
  if (!table) return request.document.locate(table.error());

  experiments::FaultsInRealTime real{.params = *params, .tallies = {}, .timing = {}, .timing_json = {}};
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
  const ProcessRights process;  // once for all runs
  ServoReport kept;
  const auto outcomes = play(runs, clock, **end, kept, [&progress](double done) { progress(0.5 + 0.5 * done); });
  if (!outcomes) return outcomes.error();
  const auto seeds = static_cast<std::size_t>(real.params.task.seeds);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const auto first = outcomes->begin() + static_cast<std::ptrdiff_t>(std::min(row * seeds, outcomes->size()));
    const auto last = outcomes->begin() + static_cast<std::ptrdiff_t>(std::min((row + 1) * seeds, outcomes->size()));
    real.tallies.push_back(
        experiments::tally(rows[row], real.params, experiments::draw_plans(rows[row], real.params), {first, last}));
  }
  real.timing = {timing_table(kept), late_ticks_table(kept)};
  real.timing_json = servo_json(kept);
  const bool interrupted = outcomes->size() < runs.size();
  if (interrupted) {
    report::Table told({{"runs at the real clock"}, {"of"}}, "Interrupted");
    told.add_row({std::to_string(outcomes->size()), std::to_string(runs.size())});
    real.timing.insert(real.timing.begin(), told);
  }
  auto outcome = experiments::present_faults(request, *params, *table, real);
  if (interrupted) {
    auto document = nlohmann::ordered_json::parse(outcome.json);
    document["real_time"]["interrupted"] = {{"runs", outcomes->size()}, {"of", runs.size()}};
    outcome.json = document.dump(2) + "\n";
  }
  return outcome;
}

}  // namespace tactus::runtime
