// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/advice/arm_presentation.hpp>
#include <tactus/analysis/advice/presentation.hpp>
#include <tactus/interfaces/cli/commands.hpp>
#include <tactus/interfaces/cli/experiment_options.hpp>
#include <tactus/interfaces/cli/outcome_files.hpp>
#include <tactus/interfaces/cli/progress_line.hpp>
#include <tactus/interfaces/cli/streams.hpp>

#include <memory>
#include <utility>

#include <CLI/CLI.hpp>

namespace tactus::cli {

namespace {

struct AdviseOptions {
  ExperimentOptions experiment;
  OutputOptions output;
};

/// Searches, presents and writes, for one axis and for arms alike.
template <class Bench>
Check advise_on(const Bench& bench, const AdviseOptions& options, const std::string& command) {
  auto output = OutputFolder::open(options.output);
  if (!output) return output.error();
  const experiments::Request request{.document = bench.document,
                                     .variations = {},
                                     .name = experiment_name(options.experiment.file),
                                     .command = command};
  const auto advice = [&] {
    ProgressLine line(request.name);
    return advice::advise(bench, [&line](double done) { line.update(done); });
  }();
  if (!advice) return advice.error();
  const auto outcome = advice::present(bench, *advice, request);
  if (!outcome) return outcome.error();
  if (output->wanted() && advice->start) {
    if (auto error = output->write("advice.toml", advice::advice_toml(bench, *advice, command))) return error;
  }
  return write_outcome(*output, *outcome);
}

Check advise(const AdviseOptions& options, const std::string& command) {
  auto document = load_experiment(options.experiment);
  if (!document) return document.error();
  if (experiments::is_of_arms(*document)) {
    const auto bench = advice::make_arm_bench(*std::move(document), options.experiment.set);
    return bench ? advise_on(*bench, options, command) : bench.error();
  }
  const auto bench = advice::make_bench(*std::move(document), options.experiment.with, options.experiment.set);
  return bench ? advise_on(*bench, options, command) : bench.error();
}

}  // namespace

void add_advise(CLI::App& app, const std::string& command, int& status) {
  auto options = std::make_shared<AdviseOptions>();
  CLI::App* verb = app.add_subcommand(
      "advise", "Recommend a method and a force gain to start with, and report what limits the gain");
  add_experiment_options(*verb, options->experiment);
  options->output.own_files = {"advice.toml"};
  add_output_options(*verb, options->output, command,
                     "Folder for report.html, results.json and advice.toml (a file for run --with)");
  verb->callback([options, &app, &command, &status] {
    if (const auto error = advise(*options, command)) {
      status = report_error(app.get_name(), *error);
    }
  });
}

}  // namespace tactus::cli
