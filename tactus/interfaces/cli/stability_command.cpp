// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/interfaces/cli/experiment_options.hpp>
#include <tactus/interfaces/cli/outcome_files.hpp>
#include <tactus/interfaces/cli/progress_line.hpp>
#include <tactus/interfaces/cli/real_between.hpp>
#include <tactus/interfaces/cli/stability_command.hpp>
#include <tactus/interfaces/cli/streams.hpp>

#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>

namespace tactus::cli {

namespace {

struct StabilityOptions {
  ExperimentOptions experiment;
  OutputOptions output;
  stability::ReportOptions report;
};

Check run(const StabilityOptions& options, const StabilityReport& report, const std::string& command) {
  auto document = load_experiment(options.experiment);
  if (!document) return document.error();
  auto output = OutputFolder::open(options.output);
  if (!output) return output.error();
  const experiments::Request request{.document = *std::move(document),
                                     .variations = {},
                                     .name = experiment_name(options.experiment.file),
                                     .command = command};
  const auto outcome = [&] {
    ProgressLine line(request.name);
    return report(request, options.report, [&line](double done) { line.update(done); });
  }();
  if (!outcome) return outcome.error();
  return write_outcome(*output, *outcome);
}

}  // namespace

void add_stability_command(CLI::App& stability, const std::string& verb, const std::string& summary,
                           const StabilityReport& report, const std::string& name, const std::string& command,
                           int& status) {
  auto options = std::make_shared<StabilityOptions>();
  CLI::App* added = stability.add_subcommand(verb, summary);
  add_experiment_options(*added, options->experiment);
  added
      ->add_option(
          "--friction-speed", options->report.linearisation.friction_speed_m_per_s,
          "Velocity amplitude for the describing function of friction, in m/s, for arms in rad/s; 0: no friction")
      ->check(real_between(0.0, 1e6));
  added
      ->add_option("--linkage-amplitude", options->report.linearisation.linkage_amplitude_m,
                   "Deflection amplitude whose secant is the stiffness of the linkage, in m; 0: the average stiffness")
      ->check(real_between(0.0, 1e6));
  added
      ->add_option("--preload", options->report.linearisation.preload_N,
                   "Contact force at which the wall is linearised, in N")
      ->check(real_between(1e-6, 1e6));
  added
      ->add_option("--uncertainty", options->report.uncertainty,
                   "Share by which the controller's model may be wrong, 0 to 0.9")
      ->check(real_between(0.0, 0.9));
  add_output_options(*added, options->output, command, "Folder for report.html, results.json and the figures");
  added->callback([options, report, name, &command, &status] {
    if (const auto error = run(*options, report, command)) {
      status = report_error(name, *error);
    }
  });
}

}  // namespace tactus::cli
