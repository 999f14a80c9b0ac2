#include <tactus/configuration/json_schema.hpp>
#include <tactus/configuration/reference.hpp>
#include <tactus/signal/prediction_block.hpp>
#include <tactus/simulation/prediction_block_experiment.hpp>
#include <tactus/simulation/presentation.hpp>

#include <cmath>
#include <numbers>

#include <nlohmann/json.hpp>

namespace tactus::simulation {

namespace {

constexpr std::string_view title = "Prediction blocks in frequency and in time";

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
    return std::tuple{
        field("kind", &P::kind, "The experiment."),
        field("sample_rate_Hz", &P::sample_rate_Hz, units::hertz, between(100.0, 1e5), "At which the blocks run."),
        field("lag_s", &P::lag_s, units::second, between(1e-3, 1.0),
              "Time constant of the first-order lag whose step response is predicted."),
        field("tolerance", &P::tolerance, units::none, between(1e-4, 0.5),
              "The usable band ends where the blocks differ from ideal prediction by this share of the signal.")};
  }
};

struct PredictionBlockParams {
  PredictionBlockTask task;
  signal::PredictionBlock::Params block;
  static constexpr auto fields() {
    return std::tuple{field("task", &PredictionBlockParams::task, "What is shown."),
                      field("block", &PredictionBlockParams::block, "Each of the blocks.")};
  }
};

struct BlockRow {
  signal::PredictionCascade::Params cascade;
  double lead_s, usable_band_Hz, noise_gain;
};

struct BlockRun {
  Settings settings;
  PredictionBlockParams params;
  std::vector<BlockRow> rows;
};

Result<BlockRun> run_of(const Settings& settings, const PredictionBlockParams& params) {
  BlockRun run{.settings = settings, .params = params, .rows = {}};
  for (std::int64_t blocks = 1; blocks <= 4; ++blocks) {
    const signal::PredictionCascade::Params cascade{.blocks = blocks, .block = params.block};
    const auto gain = signal::white_noise_gain(cascade, Seconds{1.0 / params.task.sample_rate_Hz});
    if (!gain) return gain.error();
    run.rows.push_back({.cascade = cascade,
                        .lead_s = static_cast<double>(blocks) * params.block.time_constant_s,
                        .usable_band_Hz = signal::usable_band_Hz(cascade, params.task.tolerance),
                        .noise_gain = *gain});
  }
  return run;
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
  for (const BlockRow& row : run.rows) {
    const std::string name = std::to_string(row.cascade.blocks) + (row.cascade.blocks == 1 ? " block" : " blocks");
    std::vector<double> f_Hz, amplitude, degrees;
    for (double f = 0.1; f <= 0.5 / dt_s; f *= 1.05) {
      const auto one = signal::response({.blocks = 1, .block = run.params.block},
                                        std::complex<double>(0.0, 2.0 * std::numbers::pi * f));
      f_Hz.push_back(f);
      amplitude.push_back(std::pow(std::abs(one), row.cascade.blocks));
      degrees.push_back(static_cast<double>(row.cascade.blocks) * std::arg(one) * 180.0 / std::numbers::pi);
    }
    std::vector<double> predicted;
    auto blocks = signal::PredictionCascade::make(row.cascade, Seconds{dt_s}).value();
    for (const double value : lagged) predicted.push_back(blocks.step(value));
    gain.lines.push_back({.name = name, .x = f_Hz, .y = std::move(amplitude), .colour = colour});
    phase.lines.push_back({.name = name, .x = std::move(f_Hz), .y = std::move(degrees), .colour = colour});
    step.lines.push_back({.name = name, .x = time_ms, .y = std::move(predicted), .colour = colour++});
  }
  return {.title = "Prediction blocks",
          .caption =
              "Amplitude and phase of the continuous blocks, and the sampled blocks on the step response of a "
              "first-order lag. Compare Fig. 3 of Saków et al.",
          .columns = 3,
          .panels = {std::move(gain), std::move(phase), std::move(step)}};
}

}  // namespace

std::string PredictionBlockExperiment::schema() const {
  return configuration::json_schema<PredictionBlockParams>("tactus experiment: prediction-block");
}

std::string PredictionBlockExperiment::reference() const {
  return configuration::reference_markdown<PredictionBlockParams>("Experiment `prediction-block`");
}

Result<Outcome> PredictionBlockExperiment::run(const Request& request, const Progress& progress) const {
  const auto cases = prepare_cases<PredictionBlockParams, BlockRun>(
      request, [](const PredictionBlockParams& params) { return run_of({}, params); });
  if (!cases) return cases.error();
  std::vector<report::Column> columns = settings_columns(cases->all.front().settings);
  columns.insert(
      columns.end(),
      {{"blocks"}, {"lead at rest", "ms"}, {"usable band", "Hz"}, {"gain at high frequency"}, {"gain of white noise"}});
  report::Table table(columns, std::string(title));
  nlohmann::ordered_json document{{"experiment", request.name}, {"runs", nlohmann::ordered_json::array()}};
  std::vector<report::Figure> figures;
  for (const auto& [settings, run] : cases->all) {
    auto rows = nlohmann::ordered_json::array();
    for (const BlockRow& row : run.rows) {
      const double high = std::exp2(static_cast<double>(row.cascade.blocks));
      std::vector<std::string> cells = settings_cells(settings);
      cells.insert(cells.end(),
                   {std::to_string(row.cascade.blocks), report::number(1e3 * row.lead_s, 3),
                    report::number(row.usable_band_Hz, 3), report::number(high, 3), report::number(row.noise_gain, 3)});
      table.add_row(cells);
      rows.push_back({{"blocks", row.cascade.blocks},
                      {"lead_s", row.lead_s},
                      {"usable_band_Hz", row.usable_band_Hz},
                      {"high_frequency_gain", high},
                      {"white_noise_gain", row.noise_gain}});
    }
    document["runs"].push_back(
        {{"set", nlohmann::ordered_json::parse(settings_json(settings))}, {"metrics", {{"cascades", rows}}}});
    figures.push_back(figure_of(run));
  }
  progress(1.0);
  report::Page page(request.name + ": " + std::string(title));
  page.paragraph("A prediction block leads by its time constant at low frequency and doubles what is fast.");
  page.table(table);
  page.definitions(
      {{"usable band", "Up to where the continuous blocks differ from ideal prediction by task.tolerance."},
       {"gain of white noise", "RMS out over RMS in, of the sampled blocks."}});
  for (const report::Figure& figure : figures) page.figure(figure);
  add_provenance(page, request, cases->first_configuration);
  return Outcome{
      .text = table.to_text(), .json = document.dump(2) + "\n", .html = page.to_html(), .figures = std::move(figures)};
}

}  // namespace tactus::simulation
