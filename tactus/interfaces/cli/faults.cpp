// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/interfaces/cli/commands.hpp>
#include <tactus/interfaces/cli/experiment_options.hpp>
#include <tactus/interfaces/cli/interruption.hpp>
#include <tactus/interfaces/cli/outcome_files.hpp>
#include <tactus/interfaces/cli/progress_line.hpp>
#include <tactus/interfaces/cli/servo_options.hpp>
#include <tactus/interfaces/cli/streams.hpp>
#include <tactus/simulation/experiments/arm_faults/arm_faults.hpp>
#include <tactus/simulation/experiments/faults/experiment.hpp>
#include <tactus/simulation/real_time/real_time_faults.hpp>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace tactus::cli {

namespace {

struct FaultsOptions {
  std::optional<std::string> file;  ///< else the built-in one
  std::vector<std::string> with;
  std::vector<std::string> set;
  std::optional<std::int64_t> seeds;
  std::optional<std::string> only;
  OutputOptions output;
  bool real_time = false;
  runtime::ServoThreadParams servo;
};

/// `status` is what an interruption makes the exit status.
Check run(const FaultsOptions& options, const std::string& command, int& status) {
  auto document =
      options.file ? load_experiment({.file = *options.file, .with = options.with, .set = options.set})
                   : with_set(configuration::Document::parse("[task]\nkind = \"faults\"\n", "built in"), options.set);
  if (!document) return document.error();
  const bool of_arms = experiments::is_of_arms(*document);
  const std::string group = of_arms ? "faults" : "task";
  if (options.seeds) {
    if (auto error = document->set(group + ".seeds=" + std::to_string(*options.seeds))) return error;
  }
  if (options.only) {
    if (auto error = document->set(group + ".only=\"" + *options.only + "\"")) return error;
  }
  if (of_arms && options.real_time) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "--realtime",
                 .message = "faults of arms are tried in virtual time alone: leave it out",
                 .place = {}};
  }
  auto output = OutputFolder::open(options.output);
  if (!output) return output.error();
  const experiments::Request request{.document = *std::move(document),
                                     .variations = {},
                                     .name = options.file ? experiment_name(*options.file) : std::string("faults"),
                                     .command = command};
  runtime::EndRequest end;
  std::unique_ptr<Interruption> interruption;
  const auto listen = [&]() -> Result<const runtime::EndRequest*> {
    auto started = Interruption::start(end);
    if (!started) return started.error();
    interruption = *std::move(started);
    return &end;
  };
  const auto outcome = [&] {
    ProgressLine line(request.name);
    const auto progress = [&line](double done) { line.update(done); };
    if (of_arms) return experiments::arm_faults(request, progress);
    return options.real_time ? real_time::run_faults_in_real_time(request, options.servo, progress, listen)
                             : experiments::faults_experiment()->run(request, progress);
  }();
  if (!outcome) return outcome.error();
  if (interruption) status = interruption->exit_status();
  return write_outcome(*output, *outcome);
}

}  // namespace

void add_faults(CLI::App& app, const std::string& command, int& status) {
  auto options = std::make_shared<FaultsOptions>();
  CLI::App* faults = app.add_subcommand(
      "faults", "Inject faults into supervised pairs, and report how many runs stay within the safety limits");
  CLI::Option* file =
      faults->add_option("EXPERIMENT", options->file,
                         "Experiment file (TOML) of the kind faults or arm-tapping; a built-in one by default");
  add_with_option(*faults, options->with)->needs(file);
  add_set_option(*faults, options->set);
  faults->add_option("--seeds", options->seeds, "Runs of each fault");
  faults->add_option("--only", options->only, "Only the fault with this id, as in the rows of --json");
  add_output_options(*faults, options->output, command, "Folder for report.html, results.json and the figure");
  CLI::Option* real_time =
      faults->add_flag("--realtime", options->real_time, "Also repeat some of the runs in real time on a servo thread");
  add_servo_options(*faults, options->servo);
  for (const char* name : {"--priority", "--core", "--spin-s"}) faults->get_option(name)->needs(real_time);
  faults->callback([options, name = app.get_name(), &command, &status] {
    if (const auto error = run(*options, command, status)) {
      status = report_error(name, *error);
    }
  });
}

}  // namespace tactus::cli
