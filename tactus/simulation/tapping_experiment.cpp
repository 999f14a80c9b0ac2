#include <tactus/configuration/json_schema.hpp>
#include <tactus/configuration/reference.hpp>
#include <tactus/simulation/parallel.hpp>
#include <tactus/simulation/presentation.hpp>
#include <tactus/simulation/tapping.hpp>
#include <tactus/simulation/tapping_experiment.hpp>
#include <tactus/simulation/tapping_figures.hpp>

#include <nlohmann/json.hpp>

namespace tactus::simulation {

namespace {

constexpr std::string_view tapping_title = "Tapping a wall through the teleoperator";

report::Table table_of(const std::vector<TappingRun>& runs) {
  std::vector<report::Column> columns = settings_columns(runs.front().settings);
  columns.insert(columns.end(), {{"taps"},
                                 {"settled", "%"},
                                 {"settling, median", "ms"},
                                 {"settling, p90", "ms"},
                                 {"contacts"},
                                 {"peak force", "N"},
                                 {"residual", "mN RMS"},
                                 {"verdict", "", report::Column::Align::left}});
  report::Table table(columns, std::string(tapping_title));
  for (const TappingRun& run : runs) {
    const TappingMetrics& m = run.metrics;
    // A quantile that falls on a tap that never settled is only a lower bound.
    const auto settling = [&](double seconds) {
      return (seconds >= run.observation_s ? "> " : "") + report::number(1e3 * seconds, 3);
    };
    std::vector<std::string> cells = settings_cells(run.settings);
    cells.insert(cells.end(),
                 {std::to_string(m.taps), report::number(100.0 * m.settled_fraction, 3),
                  settling(m.settling_time_median_s), settling(m.settling_time_p90_s), format_number(m.contacts_median),
                  report::number(m.peak_force_N, 3), report::number(1e3 * m.residual_rms_N, 3), name_of(m.verdict)});
    table.add_row(cells);
  }
  return table;
}

std::string json_of(const Request& request, const std::vector<TappingRun>& runs) {
  nlohmann::ordered_json document{{"experiment", request.name}, {"runs", nlohmann::ordered_json::array()}};
  for (const TappingRun& run : runs) {
    const TappingMetrics& m = run.metrics;
    document["runs"].push_back({{"set", nlohmann::ordered_json::parse(settings_json(run.settings))},
                                {"metrics",
                                 {{"taps", m.taps},
                                  {"settled_fraction", m.settled_fraction},
                                  {"settling_time_median_s", m.settling_time_median_s},
                                  {"settling_time_p90_s", m.settling_time_p90_s},
                                  {"contacts_median", m.contacts_median},
                                  {"peak_force_N", m.peak_force_N},
                                  {"residual_rms_N", m.residual_rms_N},
                                  {"verdict", name_of(m.verdict)}}}});
  }
  return document.dump(2) + "\n";
}

std::string page_of(const Request& request, const report::Table& table, const std::vector<report::Figure>& figures,
                    std::string_view configuration) {
  report::Page page(request.name + ": " + std::string(tapping_title));
  page.paragraph(
      "A person reaches through the teleoperator onto a wall and presses. The force measured at the slave's tip, times "
      "the force gain, is displayed to the hand, saturated. Each row of the table is an ensemble of taps that differ "
      "in speed, depth, tremor and model error; each picture shows one of them, the one with the median settling "
      "time.");
  page.table(table);
  page.definitions(
      {{"settling",
        "From first touch until the contact force above 15 Hz stays below a tenth of its peak. A tap that "
        "does not get there enters the quantiles with the whole observation window, marked >."},
       {"contacts", "How often the tip met the wall within the observation window, median."},
       {"peak force", "Largest contact force of a tap, median."},
       {"residual", "RMS of the contact force above 15 Hz over the last 100 ms, median."},
       {"verdict",
        "settled: at least 95 % of the taps settled, the median within 100 ms. limit-cycle: fewer than half "
        "settled. diverged: a safety gate latched or a device left its workspace. ringing: all else."}});
  for (const report::Figure& figure : figures) page.figure(figure);
  add_provenance(page, request, configuration);
  return page.to_html();
}

}  // namespace

std::string TappingExperiment::schema() const {
  return configuration::json_schema<TappingParams>("tactus experiment: tapping");
}

std::string TappingExperiment::reference() const {
  return configuration::reference_markdown<TappingParams>("Experiment `tapping`");
}

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
  for_each_in_parallel(
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

  const report::Table table = table_of(runs);
  std::vector<report::Figure> figures = tapping_figures(runs);
  std::string html = page_of(request, table, figures, cases->first_configuration);
  Outcome outcome{.text = table.to_text(),
                  .json = json_of(request, runs),
                  .html = std::move(html),
                  .figures = std::move(figures),
                  .traces = {},
                  .configuration = cases->first_configuration};
  for (TappingRun& run : runs) outcome.traces.push_back({std::move(run.settings), std::move(run.trace)});
  return outcome;
}

}  // namespace tactus::simulation
