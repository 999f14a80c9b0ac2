// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/json.hpp>
#include <tactus/simulation/experiments/experiment_of.hpp>
#include <tactus/simulation/experiments/inverse_model_chirp/inverse_model_chirp.hpp>

#include <nlohmann/json.hpp>

namespace tactus::experiments {

namespace {

constexpr std::string_view inverse_model_chirp_title = "Force felt in free motion through an inverse model";

/// Force felt in free motion through an inverse model (paper B, Fig. 5).
class InverseModelChirpExperiment final : public SweepOf<InverseModelChirpParams, InverseModelChirpResult> {
  Check check(const InverseModelChirpParams& params) const override { return experiments::check(params); }
  Result<InverseModelChirpResult> run_one(const InverseModelChirpParams& params) const override {
    return run_inverse_model_chirp(params);
  }
  Presentation present(const Request& request, const Runs& runs) const override;
};
using ChirpRun = InverseModelChirpExperiment::Run;

std::string label(const InverseModelVariant& variant) {
  if (variant.blocks == 0) return variant.name;
  return std::to_string(variant.blocks) + (variant.blocks == 1 ? " block" : " blocks");
}

report::Table table_of(const std::vector<ChirpRun>& runs) {
  report::Table table = table_of_runs(runs.front().settings,
                                      {{"estimator", "", report::Column::Align::left},
                                       {"Tp", "ms"},
                                       {"chirp", "N RMS"},
                                       {"below 2 Hz", "N RMS"},
                                       {"multisine", "N RMS"},
                                       {"multisine below 2 Hz", "N RMS"}},
                                      std::string(inverse_model_chirp_title));
  for (const ChirpRun& run : runs) {
    for (const InverseModelVariant& one : run.found.variants) {
      add_row(table, run.settings,
              {label(one), one.blocks > 0 ? report::number(1e3 * one.time_constant_s, 4) : std::string("-"),
               report::number(one.chirp.rms_N, 3), report::number(one.chirp.below_2_Hz_N, 3),
               report::number(one.multisine.rms_N, 3), report::number(one.multisine.below_2_Hz_N, 3)});
    }
  }
  return table;
}

report::Table band_table(const std::vector<ChirpRun>& runs) {
  report::Table table =
      table_of_runs(runs.front().settings, {{"two blocks", "", report::Column::Align::left}, {"Tp", "ms"}},
                    "The time constant, three ways");
  for (const ChirpRun& run : runs) {
    const auto add = [&](const std::string& how, double time_constant_s) {
      add_row(table, run.settings, {how, report::number(1e3 * time_constant_s, 5)});
    };
    add("closed form", run.found.closed_form_s);
    add("numeric limit", run.found.limit_s);
    for (const BandOptimum& one : run.found.by_band) {
      add("from data up to " + format_number(one.band_Hz) + " Hz", one.time_constant_s);
    }
  }
  return table;
}

/// On the motion that is new to all.
std::string sentence_of(const ChirpRun& run) {
  std::string text;
  for (const InverseModelVariant& one : run.found.variants) {
    text += (text.empty() ? "What is felt where nothing is touched: " : "; ") + label(one) + " " +
            report::number(one.multisine.rms_N, 3) + " N RMS";
  }
  return text + ".";
}

nlohmann::ordered_json felt_json(const FeltForce& felt) {
  return {{"rms_N", felt.rms_N}, {"rms_below_2_Hz_N", felt.below_2_Hz_N}};
}

std::string json_of(const ChirpRun& run) {
  auto variants = nlohmann::ordered_json::array();
  for (const InverseModelVariant& one : run.found.variants) {
    variants.push_back({{"estimator", label(one)},
                        {"blocks", one.blocks},
                        {"time_constant_s", one.time_constant_s},
                        {"fitted_trajectory", felt_json(one.chirp)},
                        {"other_trajectory", felt_json(one.multisine)}});
  }
  auto bands = nlohmann::ordered_json::array();
  for (const BandOptimum& one : run.found.by_band) {
    bands.push_back({{"band_Hz", one.band_Hz}, {"from_data_s", one.time_constant_s}});
  }
  return report::json_line(nlohmann::ordered_json{
      {"metrics",
       {{"phase_margin_deg", run.found.phase_margin_deg},
        {"command_rms_N", run.found.command_rms_N},
        {"time_constant",
         {{"closed_form_s", run.found.closed_form_s}, {"limit_s", run.found.limit_s}, {"by_band", bands}}},
        {"variants", variants}}}});
}

report::Figure figure_of(const ChirpRun& run) {
  const simulation::SlaveRecord& record = run.found.chirp;
  report::Figure figure{
      .title = "Free motion along a chirp",
      .caption =
          "Above: the command that the controller gave, and with the force that each inverse model feels added. "
          "Below: that force, which is fed back though nothing is touched. Compare "
          "Fig. 5 of Saków et al.",
      .columns = 1,
      .panels = {},
      .share_x = report::Sharing::in_line};
  const report::Axis time{.label = "time", .unit = "s"};
  report::Panel needed{.title = {}, .x = time, .y = {.label = "command", .unit = "N"}, .lines = {}, .rules = {}};
  needed.lines.push_back({.name = "command", .x = record.time_s, .y = record.command, .colour = 7});
  report::Panel felt{.title = {}, .x = time, .y = {.label = "force fed back", .unit = "N"}, .lines = {}, .rules = {}};
  int colour = 0;
  for (const InverseModelVariant& one : run.found.variants) {
    if (one.blocks == 1 || one.blocks == 3) continue;  // the paper shows two blocks
    std::vector<double> said = one.felt_N;
    for (std::size_t i = 0; i < said.size(); ++i) said[i] += record.command[i];
    needed.lines.push_back({.name = label(one), .x = record.time_s, .y = std::move(said), .colour = colour});
    felt.lines.push_back({.name = label(one), .x = record.time_s, .y = one.felt_N, .colour = colour++});
  }
  figure.panels = {std::move(needed), std::move(felt)};
  return figure;
}

Presentation InverseModelChirpExperiment::present(const Request& request, const Runs& runs) const {
  const report::Table table = table_of(runs), bands = band_table(runs);
  const std::string verdict = verdict_of_each(runs, [](const auto& run) { return sentence_of(run); });
  std::vector<report::Figure> figures;
  for (const ChirpRun& run : runs) figures.push_back(figure_of(run));

  report::Page page(request.name + ": " + std::string(inverse_model_chirp_title));
  page.paragraph(verdict);
  page.paragraph(
      "A slave with transport delays and lags follows a path and touches nothing. An inverse model computes from the "
      "measured position which command that took; the difference is fed back as force and should be zero. The fitted "
      "model has nine free coefficients and saw the chirp; the multisine is new to all.");
  page.table(table);
  page.table(bands);
  page.definitions(
      {{"below 2 Hz", "Behind two second-order Butterworth low-passes at 2 Hz."},
       {"fitted fourth order", "Numerator and denominator of degree four, output error, fitted to this chirp."},
       {"Tp", "Time constant of each block, in closed form for their number."}});
  for (const report::Figure& figure : figures) page.figure(figure);
  return {.text = verdict + "\n\n" + table.to_text() + "\n" + bands.to_text(),
          .json = runs_json(request, runs, [](const auto& run) { return json_of(run); }),
          .page = std::move(page),
          .figures = std::move(figures)};
}

}  // namespace

std::unique_ptr<const Experiment> inverse_model_chirp_experiment() {
  return std::make_unique<InverseModelChirpExperiment>();
}

}  // namespace tactus::experiments
