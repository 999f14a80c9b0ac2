// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/experiment_of.hpp>
#include <tactus/simulation/experiments/tapping/figures.hpp>
#include <tactus/simulation/experiments/tapping/presentation.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>
#include <tactus/simulation/tasks/bytes.hpp>
#include <tactus/simulation/tasks/work.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tactus::experiments {

namespace {

/// Taps through the teleoperator: one row for each combination of the varied parameters (paper A, Fig. 13).
class TappingExperiment final : public ExperimentOf<TappingParams> {
  Result<Outcome> run(const Request& request, const Progress& progress) const override;
  bool has_tasks() const override { return true; }
};

/// A tap of one combination, as a task.
struct TapTask {
  std::uint64_t run = 0, tap = 0;
};

std::string bytes_of(const TapTask& task) { return tasks::ByteWriter().put(task.run).put(task.tap).take(); }

/// Calls `field` for each number of a result in the order of its bytes; which site stopped it comes after these.
void for_each_number_of_tap(auto& result, auto&& field) {
  field(result.metrics.contacts);
  field(result.metrics.settled);
  field(result.metrics.settling_time_s);
  field(result.metrics.peak_force_N);
  field(result.metrics.residual_rms_N);
  field(result.touched);
  field(result.diverged);
  field(result.first_touch_s);
}

std::string bytes_of(const TapResult& result) {
  tasks::ByteWriter bytes;
  for_each_number_of_tap(result, [&bytes](const auto& number) { bytes.put(number); });
  bytes.put(result.stopped ? std::optional(result.stopped->site) : std::nullopt);
  bytes.put(result.stopped ? std::optional(result.stopped->cause) : std::nullopt);
  return bytes.take();
}

/// Whether the bytes are a result.
bool read_tap(std::string_view bytes, TapResult& result) {
  tasks::ByteReader reader(bytes);
  for_each_number_of_tap(result, [&reader](auto& number) { reader.get(number); });
  std::optional<control::SiteRole> site;
  std::optional<control::SiteCause> cause;
  reader.get(site);
  reader.get(cause);
  if (site && cause) result.stopped = simulation::StoppedSite{.site = *site, .cause = *cause};
  return reader.complete();
}

Error no_tap(const char* what) {
  return {.code = ErrorCode::failed,
          .parameter = {},
          .message = std::string(what) + " cannot be read: start the job again",
          .place = {}};
}

Result<Outcome> TappingExperiment::run(const Request& request, const Progress& progress) const {
  struct Prepared {
    TappingEnsemble ensemble;
    double observation_s;
    std::string configuration;
  };
  const auto cases =
      prepare_cases<TappingParams, Prepared>(request, [](const TappingParams& params) -> Result<Prepared> {
        auto ensemble = TappingEnsemble::make(params);
        if (!ensemble) return ensemble.error();
        return Prepared{*std::move(ensemble), params.task.observation_s, configuration::to_toml(params)};
      });
  if (!cases) return cases.error();

  // One list of all taps of all combinations, so that the last one keeps no core waiting.
  std::vector<TapTask> taps;
  std::vector<std::vector<TapResult>> results;
  std::string description = "tapping\n";
  for (const auto& one : cases->all) {
    for (std::size_t tap = 0; tap < one.prepared.ensemble.size(); ++tap) taps.push_back({results.size(), tap});
    results.emplace_back(one.prepared.ensemble.size());
    description += one.prepared.configuration + "\n";
  }
  auto work = tasks::Work::begin(
      request.place, {.description = std::move(description), .run = [&](std::string_view key) -> Result<std::string> {
                        tasks::ByteReader reader(key);
                        const auto run = reader.get<std::uint64_t>(), tap = reader.get<std::uint64_t>();
                        if (!reader.complete() || run >= results.size() || tap >= results[run].size()) {
                          return no_tap("the key of a tap");
                        }
                        return bytes_of(cases->all[run].prepared.ensemble.run(tap));
                      }});
  if (!work) return work.error();
  if (!work->leads()) return Outcome{};
  if (auto error = work->run(
          {.count = taps.size(), .key = [&](std::size_t i) { return bytes_of(taps[i]); }},
          [&](std::size_t i, std::string_view value, tasks::Origin) -> Check {
            if (read_tap(value, results[taps[i].run][taps[i].tap])) return {};
            return no_tap("the result of a tap");
          },
          progress)) {
    return *std::move(error);
  }

  std::vector<TappingRun> runs;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const auto& [settings, prepared] = cases->all[i];
    const std::vector<TapResult>& of_run = results[i];
    TappingRun run{.settings = settings,
                   .metrics = summarise(of_run),
                   .observation_s = prepared.observation_s,
                   .first_touch_s = 0.0,
                   .trace = {}};
    const std::size_t shown = median_tap(of_run);
    run.first_touch_s = of_run[shown].first_touch_s;
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
