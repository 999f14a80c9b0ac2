// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/files.hpp>
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/data/telemetry/export.hpp>
#include <tactus/data/telemetry/wide_table.hpp>
#include <tactus/interfaces/cli/commands.hpp>
#include <tactus/interfaces/cli/json_option.hpp>
#include <tactus/interfaces/cli/output_folder.hpp>
#include <tactus/interfaces/cli/streams.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace tactus::cli {

namespace {

constexpr double usual_rate_Hz = 50.0;
constexpr Bounds rates_Hz = between(0.1, 1e5);

struct ExportOptions {
  std::string log;
  std::string to;
  bool wide = false;
  double rate_Hz = usual_rate_Hz;
  std::optional<std::string> topic;
  std::optional<std::string> out;
  bool overwrite = false;
  JsonOption json;
};

Error request_error(ErrorCode code, std::string message, std::string place) {
  return Error{.code = code, .parameter = {}, .message = std::move(message), .place = std::move(place)};
}

Check check_topics(const ExportOptions& options, const telemetry::LogContent& content) {
  std::string topics;
  for (const auto& table : content.tables) topics += (topics.empty() ? "" : ", ") + table.topic;
  if (options.topic && content.tables.empty()) {
    return request_error(
        ErrorCode::missing,
        "the log has no message on the topic " + *options.topic + ": leave --topic out to see in the table what it has",
        "--topic");
  }
  if (options.to == "csv" && content.tables.size() > 1) {
    return request_error(ErrorCode::missing, "a table holds one topic: name one of " + topics, "--topic");
  }
  return std::nullopt;
}

/// `log.csv` beside `log.mcap`, `log/log.csv` for the folder `log`.
std::filesystem::path default_file(const ExportOptions& options) {
  const std::filesystem::path log = options.log;
  std::error_code ignored;
  const std::string ending = options.to == "hdf5" ? ".h5" : "." + options.to;
  return std::filesystem::is_directory(log, ignored) ? log / ("log" + ending)
                                                     : std::filesystem::path(log).replace_extension(ending);
}

Check write(const ExportOptions& options, const telemetry::LogContent& content, const std::filesystem::path& file) {
  if (options.to == "mat") return telemetry::export_mat(content, file);
  if (options.to == "hdf5") return telemetry::export_hdf5(content, file);
  return telemetry::export_csv(content, file);
}

/// What of the log could not be read, in words.
std::string gaps_of(const telemetry::LogSummary& summary) {
  std::string text;
  if (!summary.complete) {
    text += "The log has no end: its writer was stopped, or bytes are missing. All of its complete chunks were read.\n";
  }
  if (summary.damaged_chunks > 0) {
    text += std::to_string(summary.damaged_chunks) + " damaged chunks of the log were left out.\n";
  }
  if (summary.damaged_elsewhere) text += "A checksum or a record of the log, outside its chunks, is wrong.\n";
  return text;
}

std::string text_of(const telemetry::LogContent& content, const std::filesystem::path& file) {
  report::Table table({{"topic", "", report::Column::Align::left}, {"messages"}, {"missing"}, {"signals"}}, "Log");
  for (const auto& one : content.tables) {
    table.add_row({one.topic, std::to_string(one.times_ns.size()), std::to_string(one.missing),
                   std::to_string(one.columns.size())});
  }
  return table.to_text() + gaps_of(content.summary) + "Exported: " + file.string() + "\n";
}

nlohmann::ordered_json json_of(const telemetry::LogContent& content, const std::filesystem::path& file) {
  nlohmann::ordered_json document{{"file", file.string()},
                                  {"complete", content.summary.complete},
                                  {"damaged_chunks", content.summary.damaged_chunks},
                                  {"damaged_elsewhere", content.summary.damaged_elsewhere},
                                  {"topics", nlohmann::ordered_json::array()}};
  for (const auto& table : content.tables) {
    document["topics"].push_back({{"topic", table.topic},
                                  {"messages", table.times_ns.size()},
                                  {"missing", table.missing},
                                  {"signals", nlohmann::ordered_json::array()}});
    for (const auto& column : table.columns) {
      document["topics"].back()["signals"].push_back({{"name", column.name}, {"unit", column.unit}});
    }
  }
  return document;
}

/// One episode of a log and what became of it.
struct EpisodeFile {
  telemetry::Episode episode;
  std::size_t rows = 0;
  std::filesystem::path file;  ///< empty: left out
  std::string why_not = {};
};

/// `DIR/episode_2.csv`
std::filesystem::path file_of(const std::filesystem::path& folder, const telemetry::Episode& episode) {
  return folder / ("episode_" + std::to_string(episode.number) + ".csv");
}

std::vector<EpisodeFile> plan(const telemetry::WideLog& log, const std::filesystem::path& folder, double rate_Hz) {
  std::vector<EpisodeFile> files;
  for (const telemetry::Episode& episode : log.episodes()) {
    EpisodeFile one{.episode = episode, .rows = telemetry::WideLog::rows(episode, rate_Hz), .file = {}};
    if (episode.discarded) {
      one.why_not = "discarded";
    } else if (one.rows < 2) {
      one.why_not = "too short for two rows";
    } else {
      one.file = file_of(folder, episode);
    }
    files.push_back(std::move(one));
  }
  return files;
}

std::string text_of(const telemetry::WideLog& log, const std::vector<EpisodeFile>& files) {
  report::Table table(
      {{"episode"}, {"from", "s"}, {"length", "s"}, {"rows"}, {"file", "", report::Column::Align::left}}, "Episodes");
  for (const EpisodeFile& one : files) {
    table.add_row({std::to_string(one.episode.number),
                   report::fixed(1e-9 * static_cast<double>(one.episode.from_ns), 3),
                   report::fixed(one.episode.duration_s(), 3), one.file.empty() ? "0" : std::to_string(one.rows),
                   one.file.empty() ? "left out: " + one.why_not : one.file.string()});
  }
  std::string text = table.to_text() + gaps_of(log.content().summary);
  if (!log.states_units()) {
    text += "The log does not state which joints turn, as those of earlier versions: its columns have no units.\n";
  }
  if (!log.content().start_unix_ns) text += "The log does not state when it started: there is no wall_time_s.\n";
  return text;
}

std::string json_of(const telemetry::WideLog& log, const std::vector<EpisodeFile>& files,
                    const std::filesystem::path& folder) {
  nlohmann::ordered_json document = json_of(log.content(), folder);
  document["columns"] = log.heads();
  document["episodes"] = nlohmann::ordered_json::array();
  for (const EpisodeFile& one : files) {
    document["episodes"].push_back({{"number", one.episode.number},
                                    {"from_s", 1e-9 * static_cast<double>(one.episode.from_ns)},
                                    {"to_s", 1e-9 * static_cast<double>(one.episode.to_ns)},
                                    {"discarded", one.episode.discarded},
                                    {"rows", one.file.empty() ? std::size_t{0} : one.rows},
                                    {"file", one.file.string()}});
  }
  return report::json_text(document);
}

/// One table for each episode, in a folder.
Check run_wide(const ExportOptions& options) {
  if (!options.to.empty() || options.topic) {
    return request_error(ErrorCode::inconsistent,
                         "a wide table has the signals of all joints, as CSV: leave --to and --topic out", "--wide");
  }
  if (!options.out) {
    return request_error(ErrorCode::missing, "a wide export writes a file for each episode: name a folder with --out",
                         "--out");
  }
  if (!rates_Hz.contain(options.rate_Hz)) return out_of_bounds("--rate", options.rate_Hz, rates_Hz, units::hertz);
  const auto log = telemetry::WideLog::read(options.log);
  if (!log) return log.error();
  const std::filesystem::path folder = *options.out;
  const std::vector<EpisodeFile> files = plan(*log, folder, options.rate_Hz);
  for (const EpisodeFile& one : files) {
    if (one.file.empty()) continue;
    if (auto error = may_write(one.file, options.overwrite, "--out")) return error;
  }
  if (auto error = report::prepare_directory(folder)) return error;
  for (const EpisodeFile& one : files) {
    if (one.file.empty()) continue;
    if (auto error = log->export_csv(one.episode, options.rate_Hz, one.file)) return error;
  }
  result_stream() << (options.json.wanted ? options.json.document(json_of(*log, files, folder)) : text_of(*log, files));
  return std::nullopt;
}

Check run(const ExportOptions& options) {
  if (options.wide) return run_wide(options);
  if (options.to.empty()) {
    return request_error(ErrorCode::missing,
                         "name a format, csv, mat or hdf5, or write --wide for one table of each episode", "--to");
  }
  const auto content = telemetry::read_log(options.log, options.topic);
  if (!content) return content.error();
  if (auto error = check_topics(options, *content)) return error;
  const std::filesystem::path file = options.out ? std::filesystem::path(*options.out) : default_file(options);
  if (auto error = may_write(file, options.overwrite, options.out ? "--out" : options.log)) return error;
  if (auto error = write(options, *content, file)) return error;
  result_stream() << (options.json.wanted ? options.json.document(report::json_text(json_of(*content, file)))
                                          : text_of(*content, file));
  return std::nullopt;
}

}  // namespace

void add_export(CLI::App& app, const std::string& command, int& status) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* verb = app.add_subcommand("export", "Convert a log to CSV, MATLAB or HDF5");
  verb->add_option("LOG", options->log, "Log (.mcap), or the folder that holds it")->required();
  verb->add_option("--to", options->to, "Format: csv, mat or hdf5")->check(CLI::IsMember({"csv", "mat", "hdf5"}));
  verb->add_option("--topic", options->topic, "Only this topic; csv needs it if the log has several");
  CLI::Option* const wide = verb->add_flag(
      "--wide", options->wide,
      "Write a rig's log as one CSV for each episode, with a row for each instant and a column for each signal of a "
      "joint");
  verb->add_option("--rate", options->rate_Hz, "Rows per second of a wide table; 50 by default")
      ->type_name("HZ")
      ->needs(wide);
  verb->add_option("--out", options->out, "File to write; by default next to the log. With --wide, the folder")
      ->type_name("FILE|DIR");
  verb->add_flag("--overwrite", options->overwrite, "Replace an existing file");
  add_json_option(*verb, options->json, command);
  verb->callback([options, &app, &status] {
    if (const auto error = run(*options)) {
      status = report_error(app.get_name(), *error);
    }
  });
}

}  // namespace tactus::cli
