// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/arm_stability/arm_map.hpp>
#include <tactus/analysis/arm_stability/arm_margins_report.hpp>
#include <tactus/analysis/stability/map.hpp>
#include <tactus/analysis/stability/map_hdf5.hpp>
#include <tactus/analysis/stability/map_report.hpp>
#include <tactus/data/configuration/document.hpp>
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/interfaces/cli/experiment_options.hpp>
#include <tactus/interfaces/cli/outcome_files.hpp>
#include <tactus/interfaces/cli/processes.hpp>
#include <tactus/interfaces/cli/progress_line.hpp>
#include <tactus/interfaces/cli/real_between.hpp>
#include <tactus/interfaces/cli/stability.hpp>
#include <tactus/interfaces/cli/streams.hpp>
#include <tactus/simulation/tasks/work.hpp>

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

namespace tactus::cli {

namespace {

struct MapOptions {
  ExperimentOptions experiment;
  std::vector<std::string> vary;
  std::string precision = "double";
  std::vector<std::string> hands;
  std::optional<double> friction_speed_rad_per_s;
  OutputOptions output;
};

Error of_other_experiments(const char* option, const char* message) {
  return {.code = ErrorCode::inconsistent, .parameter = {}, .message = message, .place = option};
}

Result<stability::MapRequest> make_request(const MapOptions& options, const configuration::Document& document) {
  auto base = document.read<stability::MapParams>();
  if (!base) return base.error();
  stability::MapRequest request;
  request.base = *std::move(base);
  for (const std::string& text : options.vary) {
    auto axis = stability::parse_axis(text);
    if (!axis) return axis.error();
    if (auto error = refuse_set_and_varied(options.experiment.set, axis->key)) return *std::move(error);
    request.axes.push_back(*std::move(axis));
  }
  request.precision =
      options.precision == "float" ? stability::MapPrecision::lanes_of_float : stability::MapPrecision::lanes_of_double;
  request.place = {.engine = engine_of_commands(), .folder = options.output.folder.value_or("")};
  return request;
}

/// Writes what `--out` names, and prints.
Check present(OutputFolder& output, const stability::MapResult& map, stability::MapReport report,
              std::string configuration) {
  std::vector<NamedText> files;
  if (output.wanted()) {
    files.push_back({"map.csv", stability::to_csv(map)});
    if (report.svg) files.push_back({"map.svg", *std::move(report.svg)});
    if (auto error = output.begin()) return error;
    if (auto error = stability::write_hdf5(output.path() / "map.h5", map)) return error;
  }
  if (auto error = write_outcome(output,
                                 {.text = std::move(report.text),
                                  .json = std::move(report.json),
                                  .html = std::move(report.html),
                                  .figures = {},
                                  .traces = {},
                                  .configuration = std::move(configuration)},
                                 files)) {
    return error;
  }
  if (output.wanted()) tasks::remove_finished_tasks(output.path());
  return std::nullopt;
}

/// The map of two arms.
Check run_arms(const MapOptions& options, const configuration::Document& document, const std::string& command,
               OutputFolder& output) {
  if (options.precision != "double") {
    return of_other_experiments("--precision", "a map of two arms is computed in double: leave it out");
  }
  const experiments::Request about{
      .document = document, .variations = {}, .name = experiment_name(options.experiment.file), .command = command};
  arm_stability::ArmMapRequest request{.hands = {{.name = "own", .request = about}},
                                       .variations = {},
                                       .friction_speed_rad_per_s = options.friction_speed_rad_per_s.value_or(0.0)};
  for (const std::string& file : options.hands) {
    ExperimentOptions held = options.experiment;
    held.with.push_back(file);
    const auto in_hand = load_experiment(held);
    if (!in_hand) return in_hand.error();
    request.hands.push_back({.name = experiment_name(file), .request = about});
    request.hands.back().request.document = *in_hand;
  }
  for (const std::string& text : options.vary) {
    auto variation = experiments::parse_variation(text);
    if (!variation) return variation.error();
    if (auto error = refuse_set_and_varied(options.experiment.set, variation->key)) return error;
    request.variations.push_back(*std::move(variation));
  }
  const auto map = [&] {
    ProgressLine line("map");
    return arm_stability::map_arms(request, [&line](double done) { line.update(done); });
  }();
  if (!map) return map.error();
  arm_stability::ArmMapReport report = report_arm_map(*map, about, request.friction_speed_rad_per_s);
  std::vector<NamedText> files{{"map.csv", std::move(report.csv)}};
  if (report.svg) files.push_back({"map.svg", *std::move(report.svg)});
  if (!output.wanted()) files.clear();
  return write_outcome(output, report.outcome, files);
}

Check run(const MapOptions& options, const std::string& command) {
  auto document = load_experiment(options.experiment);
  if (!document) return document.error();
  auto output = OutputFolder::open(presents_results() ? options.output : OutputOptions{});
  if (!output) return output.error();
  if (experiments::is_of_arms(*document)) {
    if (auto error = refuse_to_share("a map of two arms")) return error;
    return run_arms(options, *document, command, *output);
  }
  if (!options.hands.empty()) {
    return of_other_experiments("--hand", "hands are mapped of two arms: vary the keys of operator instead");
  }
  if (options.friction_speed_rad_per_s) {
    return of_other_experiments("--friction-speed", "a map of taps has friction itself: leave it out");
  }
  const auto request = make_request(options, *document);
  if (!request) return request.error();
  const auto start = std::chrono::steady_clock::now();
  const auto map = [&] {
    ProgressLine line("map");
    return stability::run_map(*request, [&line](double done) { line.update(done); });
  }();
  if (!map) return document->locate(map.error());
  if (!presents_results()) return {};
  const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const experiments::Request about{.document = *std::move(document),
                                   .variations = {},
                                   .name = experiment_name(options.experiment.file),
                                   .command = command};
  return present(*output, *map, stability::report_map(*map, request->base, elapsed_s, about),
                 configuration::to_toml(request->base));
}

}  // namespace

void add_stability_map(CLI::App& stability, const std::string& name, const std::string& command, int& status) {
  auto options = std::make_shared<MapOptions>();
  CLI::App* verb = stability.add_subcommand(
      "map", "Map where taps settle, or the gain limit of two arms, over a grid of parameters");
  add_experiment_options(*verb, options->experiment);
  verb->add_option("--vary", options->vary,
                   "Axis of the map: key=from:to:count, key=from:to:count[log] or key=a,b,c. For two arms key=a,b,c; "
                   "by default poses, directions and methods")
      ->type_name("AXIS")
      ->allow_extra_args(false);
  verb->add_option("--hand", options->hands, "Two arms: a further grip in addition to the file's, a file as for --with")
      ->type_name("FILE")
      ->allow_extra_args(false);
  verb->add_option("--friction-speed", options->friction_speed_rad_per_s,
                   "Two arms: velocity amplitude for the describing function of friction, in rad/s; 0: no friction")
      ->check(real_between(0.0, 1e6));
  verb->add_option("--precision", options->precision, "double, or float with the boundary repeated in double")
      ->check(CLI::IsMember({"double", "float"}));
  options->output.own_files = {"map.csv", "map.h5", "map.svg"};
  add_output_options(
      *verb, options->output, command,
      "Folder for report.html, map.csv, map.h5, map.svg and results.json; a killed run continues from there");
  verb->callback([options, name, &command, &status] {
    if (const auto error = run(*options, command)) {
      status = report_error(name, *error);
    }
  });
}

}  // namespace tactus::cli
