// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/json.hpp>
#include <tactus/simulation/experiments/experiment_of.hpp>
#include <tactus/simulation/experiments/hydraulic_chirp/hydraulic_chirp.hpp>

#include <algorithm>
#include <cmath>
#include <tuple>

#include <nlohmann/json.hpp>

namespace tactus::experiments {

namespace {

constexpr std::string_view hydraulic_chirp_title = "Valve current in free motion, measured and from an inverse model";

/// The current of a servo-hydraulic slave's valve, measured and as an inverse model says it (paper B, Fig. 7).
class HydraulicChirpExperiment final : public SweepOf<HydraulicChirpParams, HydraulicChirpResult> {
  Check check(const HydraulicChirpParams& params) const override { return experiments::check(params); }
  Result<HydraulicChirpResult> run_one(const HydraulicChirpParams& params) const override {
    return run_hydraulic_chirp(params);
  }
  Presentation present(const Request& request, const Runs& runs) const override;
};
using HydraulicChirpRun = HydraulicChirpExperiment::Run;

double percent_of_full(const HydraulicChirpRun& run, double current_mA) {
  return 100.0 * current_mA / run.params.slave.valve.rated_current_mA;
}

report::Table table_of(const std::vector<HydraulicChirpRun>& runs) {
  report::Table table = table_of_runs(runs.front().settings,
                                      {{"inverse model", "", report::Column::Align::left},
                                       {"Tp", "ms"},
                                       {"error", "mA MAE"},
                                       {"of full current", "%"},
                                       {"below 2 Hz", "mA MAE"},
                                       {"of full current", "%"}},
                                      std::string(hydraulic_chirp_title));
  for (const HydraulicChirpRun& run : runs) {
    for (const CurrentScore& score : run.found.scores) {
      add_row(table, run.settings,
              {score.name, score.blocks > 0 ? report::number(1e3 * score.time_constant_s, 3) : std::string("-"),
               report::number(score.mae_mA, 3), report::number(percent_of_full(run, score.mae_mA), 2),
               report::number(score.mae_below_2_Hz_mA, 3),
               report::number(percent_of_full(run, score.mae_below_2_Hz_mA), 2)});
    }
  }
  return table;
}

/// The current over the whole chirp, the error, and a closer look at the last tenth.
report::Figure figure_of(const HydraulicChirpRun& run) {
  report::Figure figure{.title = "Valve current along the chirp",
                        .caption =
                            "Above: the error of the inverse model's current. Below: the currents at the end of "
                            "the chirp. Compare Fig. 7 of Saków et al. " +
                            settings_caption(run.settings),
                        .columns = 1,
                        .panels = {}};
  const report::Axis time{.label = "time", .unit = "s"};
  report::Panel errors{.title = {}, .x = time, .y = {.label = "error", .unit = "mA"}, .lines = {}, .rules = {}};
  report::Panel close{.title = {}, .x = time, .y = {.label = "current", .unit = "mA"}, .lines = {}, .rules = {}};
  const auto& samples = run.found.run;
  const double close_from_s = 0.95 * samples.back().time_s;
  report::Line measured{.name = "measured", .x = {}, .y = {}, .colour = 7};
  for (const auto& sample : samples) {
    if (sample.time_s < close_from_s) continue;
    measured.x.push_back(sample.time_s);
    measured.y.push_back(sample.current_mA);
  }
  close.lines.push_back(std::move(measured));
  int colour = 0;
  for (const CurrentScore& score : run.found.scores) {
    if (score.blocks != 0 && score.name != "2 blocks") continue;  // the rest is in the table
    report::Line error{.name = score.name, .x = {}, .y = {}, .colour = colour};
    report::Line current = error;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      error.x.push_back(samples[i].time_s);
      error.y.push_back(score.estimate_mA[i] - samples[i].current_mA);
      if (samples[i].time_s < close_from_s) continue;
      current.x.push_back(samples[i].time_s);
      current.y.push_back(score.estimate_mA[i]);
    }
    errors.lines.push_back(std::move(error));
    close.lines.push_back(std::move(current));
    ++colour;
  }
  figure.panels = {std::move(errors), std::move(close)};
  return figure;
}

/// What the best of the blocks leaves beside no prediction.
std::string sentence_of(const HydraulicChirpRun& run) {
  const auto& scores = run.found.scores;
  const auto plain =
      std::find_if(scores.begin(), scores.end(), [](const CurrentScore& one) { return one.blocks == 0; });
  const auto best = std::min_element(scores.begin(), scores.end(), [](const CurrentScore& a, const CurrentScore& b) {
    return std::tuple(a.blocks == 0, a.mae_mA) < std::tuple(b.blocks == 0, b.mae_mA);
  });
  if (plain == scores.end() || best->blocks == 0) return "Only one prediction was tried.";
  return "In free motion the estimate is off by " + report::number(percent_of_full(run, best->mae_mA), 2) +
         " % of the full current with " + best->name + ", by " +
         report::number(percent_of_full(run, plain->mae_mA), 2) + " % with " + plain->name + ".";
}

std::string json_of(const HydraulicChirpRun& run) {
  auto variants = nlohmann::ordered_json::array();
  for (const CurrentScore& score : run.found.scores) {
    variants.push_back({{"estimator", score.name},
                        {"blocks", score.blocks},
                        {"time_constant_s", score.time_constant_s},
                        {"mae_mA", score.mae_mA},
                        {"percent_of_rated_current", percent_of_full(run, score.mae_mA)},
                        {"mae_below_2_Hz_mA", score.mae_below_2_Hz_mA},
                        {"percent_of_rated_current_below_2_Hz", percent_of_full(run, score.mae_below_2_Hz_mA)}});
  }
  const auto& friction = run.found.fitted.model.friction;
  return report::json_line(nlohmann::ordered_json{{"metrics",
                                                   {{"model",
                                                     {{"damping_N", friction.force_N},
                                                      {"linear", friction.linear},
                                                      {"quadratic", friction.quadratic},
                                                      {"offset_N", friction.offset_N},
                                                      {"apparent_mass_kg", run.found.fitted.apparent_mass_kg},
                                                      {"fit_residual_rms_mA", run.found.fitted.residual_rms_mA}}},
                                                    {"variants", variants}}}});
}

Presentation HydraulicChirpExperiment::present(const Request& request, const Runs& runs) const {
  const report::Table table = table_of(runs);
  const std::string verdict = verdict_of_each(runs, [](const auto& run) { return sentence_of(run); });
  std::vector<report::Figure> figures;
  for (const HydraulicChirpRun& run : runs) figures.push_back(figure_of(run));

  report::Page page(request.name + ": " + std::string(hydraulic_chirp_title));
  page.paragraph(verdict);
  page.paragraph(
      "A servo-hydraulic slave follows a chirp and touches nothing. An inverse model, identified on another motion, "
      "says "
      "from the measured position which current that took; its error would be felt as force.");
  page.table(table);
  page.definitions(
      {{"error", "Mean absolute difference of the measured and the estimated current along the chirp."},
       {"below 2 Hz", "The same while the chirp is below 2 Hz."},
       {"Tp",
        "Time constant of each block, the one that leaves least of the motion on which the model was identified."},
       {"apparent mass",
        "What the fit of the current on acceleration comes to. It holds the lags of valve and sensors, "
        "which the mass as weighed does not."}});
  for (const report::Figure& figure : figures) page.figure(figure);
  return {.text = verdict + "\n\n" + table.to_text(),
          .json = runs_json(request, runs, [](const auto& run) { return json_of(run); }),
          .page = std::move(page),
          .figures = std::move(figures)};
}

}  // namespace

std::unique_ptr<const Experiment> hydraulic_chirp_experiment() { return std::make_unique<HydraulicChirpExperiment>(); }

}  // namespace tactus::experiments
