#include <tactus/cli/experiment_options.hpp>

#include <CLI/CLI.hpp>

namespace tactus::cli {

void add_experiment_options(CLI::App& verb, ExperimentOptions& options) {
  verb.add_option("EXPERIMENT", options.file, "Experiment file (TOML)")->required();
  verb.add_option("--with", options.with, "File whose keys take the place of the experiment's, as an identified model")
      ->type_name("FILE")
      ->allow_extra_args(false);
  verb.add_option("--set", options.set, "Override one value: key=value")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
}

Result<configuration::Document> load_experiment(const ExperimentOptions& options) {
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
  return document;
}

}  // namespace tactus::cli
