// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/experiment_of.hpp>
#include <tactus/simulation/experiments/tapping/figures.hpp>
#include <tactus/simulation/experiments/tapping/presentation.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>
#include <tactus/simulation/teleoperator/parallel.hpp>

namespace tactus::experiments {

namespace {

/// Taps through the teleoperator: one row for each combination of the varied parameters (paper A, Fig. 13).
class TappingExperiment final : public ExperimentOf<TappingParams> {
  Result<Outcome> run(const Request& request, const Progress& progress) const override;
};

Result<Outcome> TappingExperiment::run(const Request& request, const Progress& progress) const {
  struct Prepared {
    TappingEnsemble ensemble;
    double observation_s;
  };
  const auto cases =
      prepare_cases<TappingParams, Prepared>(request, [](const TappingParams& params) -> Result<Prepared> {
        auto ensemble = TappingEnsemble::make(params);
        if (!ensemble) return ensemble.error();
        return Prepared{*std::move(ensemble), params.task.observation_s};
      });
  if (!cases) return cases.error();

  // One list of all taps of all combinations, so that the last one keeps no core waiting.
  struct Job {
    std::size_t run, tap;
  };
  std::vector<Job> jobs;
  std::vector<std::vector<TapResult>> results;
  for (const auto& one : cases->all) {
    for (std::size_t tap = 0; tap < one.prepared.ensemble.size(); ++tap) jobs.push_back({results.size(), tap});
    results.emplace_back(one.prepared.ensemble.size());
  }
  simulation::for_each_in_parallel(
      jobs.size(),
      [&](std::size_t i) {
        const auto [run, tap] = jobs[i];
        results[run][tap] = cases->all[run].prepared.ensemble.run(tap);
      },
      progress);

  std::vector<TappingRun> runs;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const auto& [settings, prepared] = cases->all[i];
    const std::vector<TapResult>& taps = results[i];
    TappingRun run{.settings = settings,
                   .metrics = summarise(taps),
                   .observation_s = prepared.observation_s,
                   .first_touch_s = 0.0,
                   .trace = {}};
    const std::size_t shown = median_tap(taps);
    run.first_touch_s = taps[shown].first_touch_s;
    prepared.ensemble.run(shown, &run.trace);
    runs.push_back(std::move(run));
  }

  const report::Table table = tapping_table(runs);
  std::vector<report::Figure> figures = tapping_figures(runs);
  const std::string verdict = tapping_verdict(runs);
  report::Page page = tapping_page(request, verdict, table, figures);
  Outcome outcome = outcome_of({.text = verdict + "\n\n" + table.to_text(),
                                .json = tapping_json(request, runs),
                                .page = std::move(page),
                                .figures = std::move(figures)},
                               request, cases->first_configuration);
  for (TappingRun& run : runs) outcome.traces.push_back({std::move(run.settings), std::move(run.trace)});
  return outcome;
}

}  // namespace

std::unique_ptr<const Experiment> tapping_experiment() { return std::make_unique<TappingExperiment>(); }

}  // namespace tactus::experiments
