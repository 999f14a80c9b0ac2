// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/data/recording/recording.hpp>
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/page.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/identification/axis/prediction_time.hpp>
#include <tactus/interfaces/cli/experiment_options.hpp>
#include <tactus/interfaces/cli/identify.hpp>
#include <tactus/interfaces/cli/outcome_files.hpp>
#include <tactus/interfaces/cli/real_between.hpp>
#include <tactus/interfaces/cli/streams.hpp>
#include <tactus/simulation/experiments/inverse_model_chirp/inverse_model_chirp.hpp>
#include <tactus/simulation/experiments/presentation.hpp>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace tactus::cli {

namespace {

struct PredictionOptions {
  std::string experiment;
  std::vector<std::string> set;
  std::int64_t blocks = 2;
  double band_Hz = 1.0;
  std::string recording, command, position;
  std::int64_t command_column = 1, position_column = 1;
  OutputOptions output;
};

struct Motion {
  std::vector<double> command, position;
  double sample_time_s;
};

Result<Motion> recorded(const PredictionOptions& options) {
  const auto command =
      recording::read({.file = options.recording, .variable = options.command, .column = options.command_column});
  if (!command) return command.error();
  auto position =
      recording::read({.file = options.recording, .variable = options.position, .column = options.position_column});
  if (!position) return position.error();
  if (!command->sample_time_s) {
    return Error{.code = ErrorCode::missing,
                 .parameter = {},
                 .message = "the recording does not state its sample time: add a column of times",
                 .place = options.recording};
  }
  // From where the slave is at the start, so that the filters start at rest.
  const double start = position->values.front();
  for (double& value : position->values) value -= start;
  return Motion{
      .command = command->values, .position = std::move(position->values), .sample_time_s = *command->sample_time_s};
}

Result<Motion> simulated(const PredictionOptions& options, const experiments::InverseModelChirpParams& params) {
  const double dt_s = 1.0 / params.task.sample_rate_Hz;
  auto record = simulation::follow(params.slave, experiments::chirp_path(params.task, options.band_Hz),
                                   params.task.duration_s, dt_s);
  if (!record) return record.error();
  return Motion{.command = std::move(record->command), .position = std::move(record->position), .sample_time_s = dt_s};
}

/// The time constants by the three ways, and what is felt with the last.
struct TimeConstants {
  double closed_form_s, limit_s, from_data_s, error_rms_N;
};

report::Table table_of(const PredictionOptions& options, const TimeConstants& found) {
  report::Table table({{"time constant", "", report::Column::Align::left}, {"Tp", "ms"}},
                      "Prediction with " + std::to_string(options.blocks) + " blocks");
  table.add_row({"closed form", report::number(1e3 * found.closed_form_s, 5)});
  table.add_row({"numeric limit", report::number(1e3 * found.limit_s, 5)});
  table.add_row({options.recording.empty() ? "from a simulated chirp up to " + format_number(options.band_Hz) + " Hz"
                                           : "from the recording",
                 report::number(1e3 * found.from_data_s, 5)});
  return table;
}

experiments::Outcome outcome_of(const PredictionOptions& options, const TimeConstants& found,
                                const experiments::Request& request, std::string_view configuration) {
  const report::Table table = table_of(options, found);
  const std::string felt = "Force felt in this free motion: " + report::number(found.error_rms_N, 3) + " N RMS";
  report::Page page(request.name + ": time constant of the prediction blocks");
  page.paragraph(
      "Prediction blocks advance what the inverse model reads, to make up for the slave's delays and lags. Their time "
      "constant follows from the slave's description (closed form), from the whole chain at low frequency (numeric "
      "limit), and from a free motion, in which the estimated force should be zero.");
  page.table(table);
  page.paragraph(felt + ", with the time constant that the motion gives.");
  experiments::add_provenance(page, request, configuration);
  const nlohmann::ordered_json json{{"blocks", options.blocks},
                                    {"closed_form_s", found.closed_form_s},
                                    {"limit_s", found.limit_s},
                                    {"from_data_s", found.from_data_s},
                                    {"error_rms_N", found.error_rms_N}};
  experiments::Outcome outcome;
  outcome.text = felt + ".\n\n" + table.to_text();
  outcome.json = report::json_text(json);
  outcome.html = page.to_html();
  outcome.configuration = configuration;
  return outcome;
}

Check identify(const PredictionOptions& options, const std::string& command) {
  auto output = OutputFolder::open(options.output);
  if (!output) return output.error();
  auto document = with_set(configuration::Document::load(options.experiment), options.set);
  if (!document) return document.error();
  const auto params = document->read<experiments::InverseModelChirpParams>();
  if (!params) return params.error();
  if (Check error = experiments::check(*params)) return document->locate(*std::move(error));

  const auto closed = identification::prediction_time_closed_form(
      params->slave.delays_and_lags_s(), params->estimator.derivative_filter_s, options.blocks);
  if (!closed) return closed.error();
  const auto limit = identification::prediction_time_limit(
      [&](double s) { return simulation::transfer(params->slave, s).real(); }, params->estimator, options.blocks);
  if (!limit) return limit.error();
  const auto motion = options.recording.empty() ? simulated(options, *params) : recorded(options);
  if (!motion) return motion.error();
  const auto data = identification::prediction_time_from_data(
      {.command = motion->command, .position = motion->position, .sample_time_s = motion->sample_time_s},
      params->estimator, options.blocks);
  if (!data) return document->locate(under("estimator", data.error()));

  // One member after the other: where memory runs out within an initialiser list, GCC 12 destroys what is not there.
  experiments::Request request;
  request.document = *std::move(document);
  request.name = experiment_name(options.experiment);
  request.command = command;
  const TimeConstants found{.closed_form_s = *closed,
                            .limit_s = *limit,
                            .from_data_s = data->time_constant_s,
                            .error_rms_N = data->error_rms_N};
  return write_outcome(*output, outcome_of(options, found, request, configuration::to_toml(*params)));
}

}  // namespace

void add_identify_prediction(CLI::App& identify_command, const std::string& name, const std::string& command,
                             int& status) {
  auto options = std::make_shared<PredictionOptions>();
  CLI::App* verb = identify_command.add_subcommand("prediction",
                                                   "Compute the time constant of a force estimator's prediction blocks "
                                                   "from its model, and fit the time constant to a "
                                                   "motion");
  verb->add_option("EXPERIMENT", options->experiment, "Experiment file (TOML) of the kind inverse-model-chirp")
      ->required();
  add_set_option(*verb, options->set);
  verb->add_option("--blocks", options->blocks, "Blocks in series, 1 to 4");
  verb->add_option("--band", options->band_Hz, "Last frequency of the simulated chirp, in Hz")
      ->check(real_between(0.1, 100.0));
  auto* recording =
      verb->add_option("--recording", options->recording, "Recording of free motion, in place of the simulated chirp");
  verb->add_option("--command", options->command, "Variable of the command")->needs(recording);
  verb->add_option("--position", options->position, "Variable of the follower's position, in m or rad")
      ->needs(recording);
  verb->add_option("--command-column", options->command_column, "Column of that variable (.mat), from 1");
  verb->add_option("--position-column", options->position_column, "Column of that variable (.mat), from 1");
  add_output_options(*verb, options->output, command, "Folder for report.html and results.json");
  verb->callback([options, name, &command, &status] {
    if (const auto error = identify(*options, command)) {
      status = report_error(name, *error);
    }
  });
}

}  // namespace tactus::cli
