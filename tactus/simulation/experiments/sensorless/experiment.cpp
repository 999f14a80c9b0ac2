// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/experiment_of.hpp>
#include <tactus/simulation/experiments/sensorless/presentation.hpp>
#include <tactus/simulation/teleoperator/parallel.hpp>

#include <utility>

namespace tactus::experiments {

namespace {

/// Sources of the slave's force, cancellation and delay: one row for each combination, and one picture.
class SensorlessExperiment final : public ExperimentOf<SensorlessParams> {
  /// Errors besides those of every experiment: `inconsistent` for a varied key.
  Result<Outcome> run(const Request& request, const Progress& progress) const override;
};

constexpr std::string_view sensorless_title = "Teleoperation without a force sensor";

report::Page page_of(const Request& request, const report::Table& table, const report::Figure& figure,
                     const std::vector<std::string>& verdicts) {
  report::Page page(request.name + ": " + std::string(sensorless_title));
  page.paragraph(
      "The same hand taps the same wall through the same devices; the force that comes back is the slave's sensor's, "
      "or "
      "an estimate from its motor force and encoder.");
  page.figure(figure);
  for (const std::string& sentence : verdicts) page.paragraph(sentence);
  page.table(table);
  page.definitions(
      {{"settled, settling", "Share of the taps that settle, and the median time. –: half of them or more do not."},
       {"hand error",
        "Spectral error, 20 Hz to 1 kHz, between what the hand should feel (true contact force times gain, saturated) "
        "and the force on the hand, median over the taps; only where 95 % of them settle."},
       {"force error",
        "RMS difference between the force that the slave sent and the true contact force, from first touch on, median "
        "over the taps."},
       {"false force", "Force of the master's motor over a reach of 60 mm in 0.5 s that meets nothing."},
       {"gain limit",
        "Largest force gain up to which every gain that was tried settled, to 2 %: at least 95 % of the taps, the "
        "median within 100 ms plus two round trips. ≥: the search ended there. <: not even its lowest gain settled."},
       {"at … N", "The same with a display that saturates later."}});
  return page;
}

Result<Outcome> SensorlessExperiment::run(const Request& request, const Progress& progress) const {
  if (Check error =
          refuse_variations(request, "this experiment varies what it compares by itself: set one value with --set")) {
    return *std::move(error);
  }
  const auto params = request.document.read<SensorlessParams>();
  if (!params) return params.error();
  const auto rows = sensorless_cases(*params);
  if (!rows) return request.document.locate(rows.error());
  std::vector<SensorlessScore> scores(rows->size());
  simulation::for_each_in_parallel(
      rows->size() * sensorless_parts.size(),
      [&](std::size_t i) {
        const std::size_t row = rows->size() - 1 - i % rows->size();  // the longest delay first
        score_part(sensorless_parts[i / rows->size()], (*rows)[row], params->task, scores[row]);
      },
      progress);

  const report::Table table = sensorless_table(*rows, scores, *params);
  const std::vector<std::string> verdicts = sensorless_verdicts(*rows, scores, *params);
  report::Figure figure = sensorless_figure(*rows, scores, *params);
  std::string text;
  for (const std::string& sentence : verdicts) text += sentence + "\n";
  text += "\n" + table.to_text();
  report::Page page = page_of(request, table, figure, verdicts);
  return outcome_of({.text = std::move(text),
                     .json = sensorless_json(request.name, *rows, scores, *params),
                     .page = std::move(page),
                     .figures = {std::move(figure)}},
                    request, configuration::to_toml(*params));
}

}  // namespace

std::unique_ptr<const Experiment> sensorless_experiment() { return std::make_unique<SensorlessExperiment>(); }

}  // namespace tactus::experiments
