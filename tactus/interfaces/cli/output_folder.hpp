// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/interfaces/cli/json_option.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/simulation/experiments/experiment.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {  // NOLINT: the name is not ours
class App;
}

namespace tactus::cli {

/// What a command line states about where results go.
struct OutputOptions {
  std::optional<std::string> folder;  ///< none: nothing is left
  bool overwrite = false;
  JsonOption json;
  /// What the command writes alongside report.html, results.json, figures and a log.
  std::vector<std::string> own_files;
};

/// Adds `--out`, `--overwrite` and `--json` to a command whose command line is `command`. `help` is that of `--out`.
void add_output_options(CLI::App& verb, OutputOptions& options, const std::string& command, const std::string& help);
/// Adds `--log-limit` to a command; 0 stands for none.
void add_log_limit_option(CLI::App& verb, std::uint64_t& most_bytes);

/// The folder of `--out`. What a run has left there is replaced as a whole with `--overwrite` and never without; a
/// symbolic link is never followed, be it the folder itself or a file in it. The folder is one for results: neither the
/// root of the file system nor the home folder, and without files of others unless an earlier report is there.
class OutputFolder {
 public:
  /// Proves, before long work and without making the folder, that results may and could be written there: a request
  /// that turns out to be wrong leaves everything as it was.
  static Result<OutputFolder> open(const OutputOptions& options);

  [[nodiscard]] bool wanted() const { return options_.folder.has_value(); }
  [[nodiscard]] bool json() const { return options_.json.wanted; }
  /// The JSON of the outcome, with what made it in front: `JsonOption::document`.
  [[nodiscard]] std::string document(const experiments::Outcome& outcome) const {
    return options_.json.document(outcome.json, outcome.configuration);
  }
  [[nodiscard]] std::filesystem::path path() const { return options_.folder.value_or(""); }
  [[nodiscard]] std::filesystem::path log_folder() const { return path() / "log"; }

  /// Makes the folder and removes what an earlier run left in it, once: the first to write calls it.
  Check begin();
  /// Writes a file, all or nothing, after `begin`.
  Check write(const std::string& name, std::string_view content);
  /// Prints where the report is, in a line.
  [[nodiscard]] std::string report_line() const;
  /// The same of the log, of which `removed` records went for its limit.
  [[nodiscard]] std::string log_line(std::uint64_t removed = 0) const;
  /// Prints these lines, on standard error where standard output is a JSON document.
  void announce() const;
  void announce_log(std::uint64_t removed = 0) const;

 private:
  explicit OutputFolder(OutputOptions options) : options_(std::move(options)) {}
  [[nodiscard]] std::vector<std::filesystem::path> left() const;
  [[nodiscard]] Check check() const;
  [[nodiscard]] Check refuse_shared() const;

  OutputOptions options_;
  bool begun_ = false;
};

/// Refuses a file that is there unless it may be replaced, and a symbolic link in any case. `place` is the option that
/// names it.
Check may_write(const std::filesystem::path& file, bool overwrite, const std::string& place);

}  // namespace tactus::cli
