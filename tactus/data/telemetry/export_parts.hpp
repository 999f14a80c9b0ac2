// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/telemetry/log_reader.hpp>
#include <tactus/kernel/core/result.hpp>

#include <filesystem>
#include <initializer_list>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tactus::telemetry {

/// Names as every library of others takes them, given once each: letters, digits and `_`, a letter first, at most 63
/// characters (MATLAB's limit; matio writes longer ones beyond its buffers). What is another character becomes `_`; of
/// names that are alike then, the second ends in `_2`, the third in `_3`.
class Identifiers {
 public:
  /// `stem` is put in front of a name that does not begin with a letter.
  explicit Identifiers(std::string stem, std::initializer_list<std::string_view> reserved = {});
  std::string unique(std::string_view name);

 private:
  std::string stem_;
  std::map<std::string, std::size_t> given_;  ///< and the number that the next one alike gets
};

/// Columns of a table as they are exported, a column `time_s` among them, and behind it `wall_time_s` of a log that
/// states when it started: their names are `Identifiers`, their texts one printable line each of at most 255 bytes.
struct ExportColumns {
  ExportColumns(const LogTable& table, std::optional<std::uint64_t> start_unix_ns);
  ExportColumns(const ExportColumns&) = delete;
  ExportColumns& operator=(const ExportColumns&) = delete;

  std::vector<Column> columns;
  std::vector<std::span<const double>> values;  ///< of the table, or the times below
  std::vector<CodeWords> codes;                 ///< of each column; empty where it holds no codes

 private:
  std::vector<double> seconds_, wall_seconds_;
};

/// Codes in words: `0 configure, 1 align`.
std::string text_of(const CodeWords& codes);

/// What a channel states besides its columns (`joint`, `elbow`), its keys as identifiers and its texts one line each.
std::vector<std::pair<std::string, std::string>> about_channel(const LogTable& table);

/// A time of a log in seconds of Unix time, to 0.3 us.
double wall_seconds(std::uint64_t start_unix_ns, std::uint64_t time_ns);

/// What the tables of a log are called, in their order.
std::vector<std::string> names_of(const std::vector<LogTable>& tables);

/// What the log states about the run that wrote it and when it started, its keys as identifiers; empty if it states
/// nothing.
std::map<std::string, std::string> about(const LogSummary& summary);

/// What sets a run apart from the others of its log.
struct Condition {
  std::string label;                                     ///< in a few words: `force gain 3`
  std::vector<std::pair<std::string, std::string>> set;  ///< each varied key and its value
};

/// The condition of the run that a topic belongs to (`/run_1/teleoperator` to `run_1`); empty if the log states none.
std::optional<Condition> condition_of(const LogSummary& summary, std::string_view topic);

/// The error for a log that has nothing to export.
Check refuse_empty(const LogContent& content, const std::filesystem::path& file);

}  // namespace tactus::telemetry
