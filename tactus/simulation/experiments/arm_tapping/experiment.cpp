// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/arm_tapping/arm_taps.hpp>
#include <tactus/simulation/experiments/arm_tapping/presentation.hpp>
#include <tactus/simulation/experiments/experiment_of.hpp>
#include <tactus/simulation/teleoperator/parallel.hpp>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <string>
#include <utility>

namespace tactus::experiments {

namespace {

/// Taps through two simulated arms: one row for each combination of the varied keys.
class ArmTappingExperiment final : public ExperimentOf<ArmTappingParams> {
  Result<Outcome> run(const Request& request, const Progress& progress) const override;
};

Result<Outcome> ArmTappingExperiment::run(const Request& request, const Progress& progress) const {
  const std::filesystem::path folder = std::filesystem::path(request.document.name()).parent_path();
  const auto cases = prepare_cases<ArmTappingParams, ArmTaps>(
      request, [&](const ArmTappingParams& params) { return ArmTaps::make(params, folder); });
  if (!cases) return cases.error();

  // One list of all taps and reaches of all combinations, so that the last one keeps no core waiting.
  struct Job {
    std::size_t run, tap;  ///< a tap beyond the last is the reach, one beyond that a hold
  };
  struct Results {
    std::vector<ArmTapResult> taps;
    ArmReach reach;
    std::vector<ArmHold> holds;
    ArmTrace trace;  ///< of the first tap
  };
  std::vector<Job> jobs;
  std::vector<Results> results;
  for (const auto& one : cases->all) {
    const std::size_t holds = one.prepared.holds();
    for (std::size_t tap = 0; tap <= one.prepared.size() + holds; ++tap) jobs.push_back({results.size(), tap});
    results.push_back({.taps = std::vector<ArmTapResult>(one.prepared.size()),
                       .reach = {},
                       .holds = std::vector<ArmHold>(holds),
                       .trace = {}});
  }
  simulation::for_each_in_parallel(
      jobs.size(),
      [&](std::size_t i) {
        const auto [run, tap] = jobs[i];
        const ArmTaps& taps = cases->all[run].prepared;
        Results& found = results[run];
        if (tap == taps.size()) {
          found.reach = taps.reach();
        } else if (tap > taps.size()) {
          found.holds[tap - taps.size() - 1] = taps.hold(tap - taps.size() - 1);
        } else {
          found.taps[tap] = taps.run(tap, tap == 0 ? &found.trace : nullptr);
        }
      },
      progress);

  std::vector<ArmTappingRun> runs;
  std::vector<report::Figure> figures;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const auto& [settings, taps] = cases->all[i];
    runs.push_back({settings, summarise(results[i].taps, results[i].reach, results[i].holds)});
    std::vector<report::Figure> of_run = arm_figures(settings, taps, results[i].trace);
    std::move(of_run.begin(), of_run.end(), std::back_inserter(figures));
  }
  const report::Table table = arm_table(runs);
  const std::string verdict = arm_verdict(runs);
  report::Page page = arm_page(request, verdict, table, figures);
  return outcome_of({.text = verdict + "\n\n" + table.to_text(),
                     .json = arm_json(request, runs),
                     .page = std::move(page),
                     .figures = std::move(figures)},
                    request, cases->first_configuration);
}

}  // namespace

std::unique_ptr<const Experiment> arm_tapping_experiment() { return std::make_unique<ArmTappingExperiment>(); }

}  // namespace tactus::experiments
