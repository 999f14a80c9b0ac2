// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/text.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/interfaces/cli/experiment_options.hpp>

#include <filesystem>

#include <CLI/CLI.hpp>

namespace tactus::cli {

CLI::Option* add_with_option(CLI::App& verb, std::vector<std::string>& with) {
  return verb
      .add_option("--with", with,
                  "File whose keys replace those of the experiment, such as an identified model; may be repeated")
      ->type_name("FILE")
      ->allow_extra_args(false);
}

void add_set_option(CLI::App& verb, std::vector<std::string>& set) {
  verb.add_option("--set", set, "Override one value; may be repeated")->type_name("KEY=VALUE")->allow_extra_args(false);
}

Result<configuration::Document> with_set(Result<configuration::Document> document,
                                         const std::vector<std::string>& set) {
  if (!document) return document;
  for (const std::string& assignment : set) {
    if (auto error = document->set(assignment)) return *std::move(error);
  }
  return document;
}

Check refuse_set_and_varied(const std::vector<std::string>& set, const std::string& varied) {
  for (const std::string& assignment : set) {
    const std::string_view key = configuration::trimmed(std::string_view(assignment).substr(0, assignment.find('=')));
    if (key != varied) continue;
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = varied,
                 .message = "it is varied and set to one value: leave out --set " + assignment +
                            ", or the values that --vary names",
                 .place = "--vary"};
  }
  return std::nullopt;
}

void add_experiment_options(CLI::App& verb, ExperimentOptions& options) {
  verb.add_option("EXPERIMENT", options.file, "Experiment file (TOML)")->required();
  add_with_option(verb, options.with);
  add_set_option(verb, options.set);
}

std::string experiment_name(const std::string& file) {
  return report::printable(std::filesystem::path(file).stem().string());
}

Result<configuration::Document> load_experiment(const ExperimentOptions& options) {
  return with_changes(configuration::Document::load(options.file), options);
}

Result<configuration::Document> with_changes(Result<configuration::Document> document,
                                             const ExperimentOptions& options) {
  if (!document) return document;
  for (const std::string& file : options.with) {
    const auto other = configuration::Document::load(file);
    if (!other) return other.error();
    if (auto error = document->merge(*other)) return *std::move(error);
  }
  return with_set(std::move(document), options.set);
}

}  // namespace tactus::cli
