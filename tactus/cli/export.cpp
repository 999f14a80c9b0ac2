#include <tactus/cli/json_option.hpp>
#include <tactus/cli/output_folder.hpp>
#include <tactus/cli/streams.hpp>
#include <tactus/cli/verbs.hpp>
#include <tactus/report/json.hpp>
#include <tactus/report/table.hpp>
#include <tactus/telemetry/export.hpp>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace tactus::cli {

namespace {

struct ExportOptions {
  std::string log;
  std::string to;
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

std::string json_of(const telemetry::LogContent& content, const std::filesystem::path& file) {
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
  return report::json_text(document);
}

Check run(const ExportOptions& options) {
  const auto content = telemetry::read_log(options.log, options.topic);
  if (!content) return content.error();
  if (auto error = check_topics(options, *content)) return error;
  const std::filesystem::path file = options.out ? std::filesystem::path(*options.out) : default_file(options);
  if (auto error = may_write(file, options.overwrite, options.out ? "--out" : options.log)) return error;
  if (auto error = write(options, *content, file)) return error;
  result_stream() << (options.json.wanted ? options.json.document(json_of(*content, file)) : text_of(*content, file));
  return std::nullopt;
}

}  // namespace

void add_export(CLI::App& app, const std::string& command, int& status) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* verb = app.add_subcommand("export", "Write a log as columns for other programs");
  verb->add_option("LOG", options->log, "Log (.mcap), or the folder that holds it")->required();
  verb->add_option("--to", options->to, "Format: csv, mat or hdf5")
      ->required()
      ->check(CLI::IsMember({"csv", "mat", "hdf5"}));
  verb->add_option("--topic", options->topic, "Only this topic; csv needs it where the log has several");
  verb->add_option("--out", options->out, "File to write; without it, beside the log")->type_name("FILE");
  verb->add_flag("--overwrite", options->overwrite, "Replace the file if it is there");
  add_json_option(*verb, options->json, command);
  verb->callback([options, &app, &status] {
    if (const auto error = run(*options)) {
      status = report_error(app.get_name(), *error);
    }
  });
}

}  // namespace tactus::cli
