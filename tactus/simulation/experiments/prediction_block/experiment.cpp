// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/json.hpp>
#include <tactus/kernel/signal/predictor.hpp>
#include <tactus/simulation/experiments/experiment_of.hpp>

#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

namespace tactus::experiments {

namespace {

constexpr std::string_view prediction_block_title = "Prediction in frequency and in time";

enum class PredictionBlockKind { prediction_block };
constexpr auto enumerators(PredictionBlockKind) {
  return std::array{Enumerator{PredictionBlockKind::prediction_block, "prediction-block"}};
}

struct PredictionBlockTask {
  PredictionBlockKind kind = PredictionBlockKind::prediction_block;
  double sample_rate_Hz = 5000.0;
  double lag_s = 0.01;
  double tolerance = 0.1;
  static constexpr auto fields() {
    using P = PredictionBlockTask;
    return List{field("kind", &P::kind, "Kind of the experiment."),
                field("sample_rate_Hz", &P::sample_rate_Hz, units::hertz, between(100.0, 1e5),
                      "Rate at which the predictors run."),
                field("lag_s", &P::lag_s, units::second, between(1e-3, 1.0),
                      "Time constant of the first-order lag whose step response is predicted."),
                field("tolerance", &P::tolerance, units::none, between(1e-4, 0.5),
                      "Difference from the ideal predictor, as a share of the signal, at which the usable band of a "
                      "predictor ends.")};
  }
};

struct PredictionBlockParams {
  PredictionBlockTask task;
  signal::PredictionBlock::Params block;
  signal::PolynomialPredictor::Params polynomial;
  signal::KalmanPredictor::Params kalman;
  static constexpr auto fields() {
    return List{field("task", &PredictionBlockParams::task, "The comparison."),
                field("block", &PredictionBlockParams::block, "Parameters of each block."),
                field("polynomial", &PredictionBlockParams::polynomial,
                      "Extrapolation of a polynomial, a rival of the blocks."),
                field("kalman", &PredictionBlockParams::kalman, "Kalman filter, a rival of the blocks.")};
  }
};

/// What one predictor does.
struct PredictorRow {
  std::string name;
  signal::Predictor::Params params;
  std::function<std::complex<double>(double)> response;  ///< over Hz; of blocks the continuous one
  double lead_s, usable_band_Hz, high_frequency_gain, noise_gain;
};

using PredictorRows = std::vector<PredictorRow>;  ///< one to four blocks, then the rivals

/// What prediction blocks do in frequency and in time (paper B, Fig. 3).
class PredictionBlockExperiment final : public SweepOf<PredictionBlockParams, PredictorRows> {
  Check check(const PredictionBlockParams& params) const override {
    const auto rows = run_one(params);
    return rows ? Check{} : Check{rows.error()};
  }
  Result<PredictorRows> run_one(const PredictionBlockParams& params) const override;
  Presentation present(const Request& request, const Runs& runs) const override;
};
using BlockRun = PredictionBlockExperiment::Run;

constexpr std::size_t cascades = 4;

/// A rival, which exists only sampled.
template <class Element>
PredictorRow rival(const std::string& name, const signal::Predictor::Params& params, const Element& element,
                   const PredictionBlockTask& task) {
  const auto response = [element](double frequency_Hz) { return element.response(frequency_Hz); };
  const double highest_Hz = 0.5 * task.sample_rate_Hz;
  return {.name = name,
          .params = params,
          .response = response,
          .lead_s = params.lead_s(),
          .usable_band_Hz = signal::usable_band_Hz(response, params.lead_s(), task.tolerance, highest_Hz),
          .high_frequency_gain = std::abs(response(highest_Hz)),
          .noise_gain = element.white_noise_gain()};
}

Result<PredictorRows> PredictionBlockExperiment::run_one(const PredictionBlockParams& params) const {
  const Seconds dt{1.0 / params.task.sample_rate_Hz};
  PredictorRows rows;
  for (std::size_t blocks = 1; blocks <= cascades; ++blocks) {
    const auto count = static_cast<std::int64_t>(blocks);
    const signal::PredictionCascade::Params cascade{.blocks = count, .block = params.block};
    const auto gain = signal::white_noise_gain(cascade, dt);
    if (!gain) return gain.error();
    const auto response = [cascade](double frequency_Hz) {
      return signal::response(cascade, std::complex<double>(0.0, 2.0 * std::numbers::pi * frequency_Hz));
    };
    rows.push_back({.name = std::to_string(blocks) + (blocks == 1 ? " block" : " blocks"),
                    .params = {.blocks = count, .block = params.block},
                    .response = response,
                    .lead_s = static_cast<double>(blocks) * params.block.time_constant_s,
                    .usable_band_Hz = signal::usable_band_Hz(cascade, params.task.tolerance),
                    .high_frequency_gain = std::exp2(static_cast<double>(blocks)),
                    .noise_gain = *gain});
  }
  const auto polynomial = signal::PolynomialPredictor::make(params.polynomial, dt);
  if (!polynomial) return under("polynomial", polynomial.error());
  rows.push_back(rival("polynomial of degree " + std::to_string(params.polynomial.degree) + ", " +
                           std::to_string(params.polynomial.samples) + " samples",
                       {.kind = signal::PredictionKind::polynomial, .polynomial = params.polynomial}, *polynomial,
                       params.task));
  const auto kalman = signal::KalmanPredictor::make(params.kalman, dt);
  if (!kalman) return under("kalman", kalman.error());
  rows.push_back(rival("Kalman, " + std::string(name_of(params.kalman.kinematics)),
                       {.kind = signal::PredictionKind::kalman, .kalman = params.kalman}, *kalman, params.task));
  return rows;
}

report::Figure figure_of(const BlockRun& run) {
  const report::Axis frequency{.label = "frequency", .unit = "Hz", .scale = report::Axis::Scale::logarithmic};
  report::Panel gain{.title = "amplitude", .x = frequency, .y = {.label = "gain"}, .lines = {}, .rules = {}};
  report::Panel phase{
      .title = "phase", .x = frequency, .y = {.label = "phase", .unit = "deg"}, .lines = {}, .rules = {}};
  report::Panel step{.title = "step response of a first-order lag",
                     .x = {.label = "time", .unit = "ms"},
                     .y = {.label = "response"},
                     .lines = {},
                     .rules = {}};
  const double dt_s = 1.0 / run.params.task.sample_rate_Hz, lag_s = run.params.task.lag_s;
  std::vector<double> time_ms, lagged;
  for (double t = 0.0; t <= 6.0 * lag_s; t += dt_s) {
    time_ms.push_back(1e3 * t);
    lagged.push_back(-std::expm1(-t / lag_s));
  }
  step.lines.push_back({.name = "not predicted", .x = time_ms, .y = lagged, .colour = 7});
  int colour = 0;
  for (const PredictorRow& row : run.found) {
    std::vector<double> f_Hz, amplitude, degrees;
    std::complex<double> before = 1.0;
    double phase_rad = 0.0;
    for (double f = 0.1; f <= 0.5 / dt_s; f *= 1.05) {
      const std::complex<double> response = row.response(f);
      phase_rad += std::arg(response * std::conj(before));  // goes on beyond half a turn
      before = response;
      f_Hz.push_back(f);
      amplitude.push_back(std::abs(response));
      degrees.push_back(phase_rad * 180.0 / std::numbers::pi);
    }
    std::vector<double> predicted;
    auto predictor = signal::Predictor::make(row.params, Seconds{dt_s}).value();
    for (const double value : lagged) predicted.push_back(predictor.step(value));
    gain.lines.push_back({.name = row.name, .x = f_Hz, .y = std::move(amplitude), .colour = colour});
    phase.lines.push_back({.name = row.name, .x = std::move(f_Hz), .y = std::move(degrees), .colour = colour});
    step.lines.push_back({.name = row.name, .x = time_ms, .y = std::move(predicted), .colour = colour++});
  }
  return {
      .title = "Predictors",
      .caption =
          "Amplitude and phase of the continuous blocks and of their sampled rivals, and all of them sampled on the "
          "step response of a first-order lag. Compare Fig. 3 of Saków et al.",
      .columns = 3,
      .panels = {std::move(gain), std::move(phase), std::move(step)}};
}

/// What the lead of each costs.
std::string sentence_of(const BlockRun& run) {
  std::string text;
  for (const PredictorRow& row : run.found) {
    text += (text.empty() ? "What looks ahead passes noise: " : "; ") + row.name + " " +
            report::number(1e3 * row.lead_s, 3) + " ms, times " + report::number(row.noise_gain, 3);
  }
  return text + ".";
}

std::string json_of(const BlockRun& run) {
  auto blocks = nlohmann::ordered_json::array(), rivals = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < run.found.size(); ++i) {
    const PredictorRow& row = run.found[i];
    nlohmann::ordered_json entry;
    if (i < cascades) {
      entry["blocks"] = row.params.blocks;
    } else {
      entry["predictor"] = row.name;
    }
    entry.update({{"lead_s", row.lead_s},
                  {"usable_band_Hz", row.usable_band_Hz},
                  {"high_frequency_gain", row.high_frequency_gain},
                  {"white_noise_gain", row.noise_gain}});
    (i < cascades ? blocks : rivals).push_back(std::move(entry));
  }
  return report::json_line(nlohmann::ordered_json{{"metrics", {{"cascades", blocks}, {"rivals", rivals}}}});
}

Presentation PredictionBlockExperiment::present(const Request& request, const Runs& runs) const {
  const std::string verdict = verdict_of_each(runs, [](const auto& run) { return sentence_of(run); });
  report::Table table = table_of_runs(runs.front().settings,
                                      {{"predictor", "", report::Column::Align::left},
                                       {"lead at rest", "ms"},
                                       {"usable band", "Hz"},
                                       {"gain at high frequency"},
                                       {"gain of white noise"}},
                                      std::string(prediction_block_title));
  std::vector<report::Figure> figures;
  for (const Run& run : runs) {
    for (const PredictorRow& row : run.found) {
      add_row(table, run.settings,
              {row.name, report::number(1e3 * row.lead_s, 3), report::number(row.usable_band_Hz, 3),
               report::number(row.high_frequency_gain, 3), report::number(row.noise_gain, 3)});
    }
    figures.push_back(figure_of(run));
  }
  report::Page page(request.name + ": " + std::string(prediction_block_title));
  page.paragraph(verdict);
  page.paragraph(
      "A prediction block leads by its time constant at low frequency and doubles what is fast. A polynomial through "
      "the "
      "last samples and a Kalman filter of the signal's kinematics look ahead by their horizon.");
  page.table(table);
  page.definitions(
      {{"usable band",
        "Up to where a predictor differs from the ideal one by task.tolerance; of blocks, the continuous ones."},
       {"gain of white noise", "RMS out over RMS in, sampled."}});
  for (const report::Figure& figure : figures) page.figure(figure);
  return {.text = verdict + "\n\n" + table.to_text(),
          .json = runs_json(request, runs, [](const auto& run) { return json_of(run); }),
          .page = std::move(page),
          .figures = std::move(figures)};
}

}  // namespace

std::unique_ptr<const Experiment> prediction_block_experiment() {
  return std::make_unique<PredictionBlockExperiment>();
}

}  // namespace tactus::experiments
