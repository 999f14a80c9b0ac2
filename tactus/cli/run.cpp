#include <tactus/cli/progress_line.hpp>
#include <tactus/cli/run_log.hpp>
#include <tactus/cli/standard_output.hpp>
#include <tactus/cli/verbs.hpp>
#include <tactus/report/figure.hpp>
#include <tactus/report/files.hpp>
#include <tactus/simulation/experiment.hpp>

#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>

namespace tactus::cli {

namespace {

struct RunOptions {
  std::string file;
  std::vector<std::string> with;
  std::vector<std::string> set;
  std::vector<std::string> vary;
  std::optional<std::string> out;
  bool json = false;
};

Result<simulation::Request> make_request(const RunOptions& options, const std::string& command) {
  auto document = configuration::Document::load(options.file);
  if (!document) return document.error();
  for (const std::string& file : options.with) {
    const auto other = configuration::Document::load(file);
    if (!other) return other.error();
    if (auto error = document->merge(*other)) return *std::move(error);
  }
  for (const std::string& assignment : options.set) {
    if (auto error = document->set(assignment)) return *std::move(error);
  }
  std::vector<simulation::Variation> variations;
  for (const std::string& text : options.vary) {
    auto variation = simulation::parse_variation(text);
    if (!variation) return variation.error();
    variations.push_back(*std::move(variation));
  }
  return simulation::Request{.document = *std::move(document),
                             .variations = std::move(variations),
                             .name = std::filesystem::path(options.file).stem().string(),
                             .command = command};
}

/// Proves that results could be written to `folder`, before long work, without making it: a request that turns out to
/// be wrong leaves nothing behind.
Check check_writable(const std::string& folder) {
  if (folder.empty()) {
    return Error{.code = ErrorCode::syntax,
                 .parameter = {},
                 .message = "no folder is named: write one, as in --out results",
                 .place = "--out"};
  }
  std::filesystem::path there = folder;
  std::error_code ignored;
  while (there.has_relative_path() && !std::filesystem::exists(there, ignored)) there = there.parent_path();
  return report::prepare_directory(there.empty() ? "." : there);
}

Check write_results(const std::filesystem::path& folder, const simulation::Outcome& outcome) {
  if (auto error = report::prepare_directory(folder)) return error;
  for (std::size_t i = 0; i < outcome.figures.size(); ++i) {
    const auto path = folder / ("figure-" + std::to_string(i + 1) + ".svg");
    if (auto error = report::write_file(path, report::to_svg(outcome.figures[i]))) return error;
  }
  if (auto error = report::write_file(folder / "results.json", outcome.json)) return error;
  return report::write_file(folder / "report.html", outcome.html);
}

Check run(const RunOptions& options, const std::string& command) {
  const auto request = make_request(options, command);
  if (!request) return request.error();
  const auto experiment = simulation::choose_experiment(request->document);
  if (!experiment) return experiment.error();
  if (options.out) {
    if (auto error = check_writable(*options.out)) return error;
  }

  Result<simulation::Outcome> outcome = [&] {
    ProgressLine line(request->name);
    return (*experiment)->run(*request, [&line](double done) { line.update(done); });
  }();
  if (!outcome) return outcome.error();

  std::cout << (options.json ? outcome->json : outcome->text);
  if (auto error = flush_standard_output()) return error;
  if (!options.out) return std::nullopt;
  if (auto error = write_results(*options.out, *outcome)) return error;
  const std::filesystem::path folder = *options.out;
  std::ostream& notes = options.json ? std::cerr : std::cout;
  notes << "Report: " << (folder / "report.html").string() << "\n";
  if (outcome->traces.empty()) return std::nullopt;
  if (auto error = write_run_log(folder / "log", *request, *outcome)) return error;
  notes << "Log: " << (folder / "log").string() << "\n";
  return std::nullopt;
}

}  // namespace

void add_run(CLI::App& app, const std::string& command, int& status) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* verb = app.add_subcommand("run", "Run an experiment in virtual time");
  verb->add_option("EXPERIMENT", options->file, "Experiment file (TOML)")->required();
  verb->add_option("--with", options->with,
                   "File whose keys take the place of the experiment's, as an identified model")
      ->type_name("FILE")
      ->allow_extra_args(false);
  verb->add_option("--set", options->set, "Override one value: key=value")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  verb->add_option("--vary", options->vary, "Run every value of a key, in all combinations: key=a,b,c")
      ->type_name("KEY=A,B,C")
      ->allow_extra_args(false);
  verb->add_option("--out", options->out, "Folder for report.html, results.json, the figures and the log")
      ->type_name("DIR");
  verb->add_flag("--json", options->json, "Print one JSON document and nothing else");
  verb->callback([options, &app, &command, &status] {
    if (const auto error = run(*options, command)) {
      std::cerr << app.get_name() << ": " << describe(*error) << "\n";
      status = exit_status(*error);
    }
  });
}

}  // namespace tactus::cli
