// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/configuration/document.hpp>
#include <tactus/kernel/core/result.hpp>

#include <string>
#include <vector>

namespace CLI {  // NOLINT: the name is not ours
class App;
class Option;
}  // namespace CLI

namespace tactus::cli {

/// An experiment as a command line names it.
struct ExperimentOptions {
  std::string file;
  std::vector<std::string> with;
  std::vector<std::string> set;
};

/// Adds `--with` to a command.
CLI::Option* add_with_option(CLI::App& verb, std::vector<std::string>& with);
/// Adds `--set` to a command.
void add_set_option(CLI::App& verb, std::vector<std::string>& set);
/// The document with these values, each `key=value`, on top. Errors: those of `document` and of `Document::set`.
Result<configuration::Document> with_set(Result<configuration::Document> document, const std::vector<std::string>& set);

/// `inconsistent` for a key that is varied and has one value too: one of the two would be lost.
Check refuse_set_and_varied(const std::vector<std::string>& set, const std::string& varied);

/// Adds it to a command: `EXPERIMENT`, `--with`, `--set`.
void add_experiment_options(CLI::App& verb, ExperimentOptions& options);

/// What an experiment is called in reports and messages: its file's name without the ending, as it can be printed.
std::string experiment_name(const std::string& file);

/// The document with the keys of `--with` and the values of `--set` on top. Errors: those of `document` and of
/// `Document`.
Result<configuration::Document> with_changes(Result<configuration::Document> document,
                                             const ExperimentOptions& options);

/// The file, the keys of others in the place of its own, and the values on top. Errors: those of `Document`.
Result<configuration::Document> load_experiment(const ExperimentOptions& options);

}  // namespace tactus::cli
