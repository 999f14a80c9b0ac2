// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/recording.hpp>
#include <tactus/data/telemetry/log_reader.hpp>
#include <tactus/interfaces/c_api/internal/errors.hpp>
#include <tactus/interfaces/c_api/internal/handles.hpp>
#include <tactus/interfaces/cli/in_process.hpp>
#include <tactus/interfaces/cli/streams.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tactus::c_api {

namespace {

using telemetry::LogContent;
using telemetry::LogTable;

bool is_recording(const std::filesystem::path& path) {
  constexpr std::array endings{".csv", ".tsv", ".txt", ".mat"};
  std::error_code ignored;
  return !std::filesystem::is_directory(path, ignored) &&
         std::find(endings.begin(), endings.end(), path.extension().string()) != endings.end();
}

LogTable table_of(std::string name, std::vector<recording::Column> columns) {
  LogTable table;
  table.topic = std::move(name);
  for (recording::Column& column : columns) {
    telemetry::Column described;
    described.name = std::move(column.name);
    described.unit = std::move(column.unit);
    table.columns.push_back(std::move(described));
    table.values.push_back(std::move(column.values));
  }
  return table;
}

/// A text table is one table; of a MATLAB file each variable of numbers is one.
Result<LogContent> read_recording(const std::filesystem::path& path) {
  const auto entries = recording::contents(path);
  if (!entries) return entries.error();
  std::vector<std::string> choices;
  for (const recording::Entry& entry : *entries) {
    if (entry.readable) choices.push_back(entry.name);
  }
  auto read = recording::read_columns(path, choices);
  if (!read) return read.error();
  LogContent content;
  content.summary.complete = true;
  if (path.extension() == ".mat") {
    for (std::size_t i = 0; i < read->size(); ++i) {
      content.tables.push_back(table_of(choices[i], std::move((*read)[i])));
    }
    return content;
  }
  std::vector<recording::Column> columns;
  for (auto& choice : *read) {
    for (recording::Column& column : choice) columns.push_back(std::move(column));
  }
  content.tables.push_back(table_of(path.filename().string(), std::move(columns)));
  return content;
}

Result<LogContent> open_log(const std::filesystem::path& path, const char* topic) {
  if (cli::is_in_process()) {
    return Error{.code = ErrorCode::failed,
                 .parameter = {},
                 .message = "a command runs in this thread: open the log when it has ended",
                 .place = path.string()};
  }
  const std::lock_guard lock(cli::one_command_at_a_time());
  if (!is_recording(path)) {
    auto content = telemetry::read_log(path, topic != nullptr ? std::optional<std::string>(topic) : std::nullopt);
    if (content && content->tables.empty() && topic != nullptr) {
      return Error{.code = ErrorCode::missing,
                   .parameter = {},
                   .message = "the log has no message on the topic " + std::string(topic) +
                              ": leave the topic out to see what it has",
                   .place = path.string()};
    }
    return content;
  }
  if (topic != nullptr) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = {},
                 .message = "a recording has no topics: leave the topic out",
                 .place = path.string()};
  }
  return read_recording(path);
}

Handles<LogContent, log_kind>& logs() {
  static auto* const all = new Handles<LogContent, log_kind>;
  return *all;
}

std::size_t rows_of(const LogTable& table) {
  return table.values.empty() ? table.times_ns.size() : table.values.front().size();
}

}  // namespace

}  // namespace tactus::c_api

using namespace tactus::c_api;

tactus_status tactus_log_open(const char* path, const char* topic, tactus_log* made, tactus_error* error) {
  return guarded(error, [&]() -> tactus_status {
    if (made == nullptr) return bad_argument("`made` is NULL: pass where the handle is to be left", error);
    *made = 0;
    if (path == nullptr) return bad_argument("`path` is NULL: pass the name of a file or folder", error);
    auto content = open_log(path, topic);
    if (!content) {
      tactus::Error found = content.error();
      if (found.place.empty()) found.place = path;
      return leave(found, error);
    }
    *made = logs().add(*std::move(content));
    if (*made != 0) return TACTUS_OK;
    return leave({.code = tactus::ErrorCode::failed,
                  .parameter = {},
                  .message = "there are 65536 logs already: release those that are not used any more",
                  .place = {}},
                 error);
  });
}

tactus_status tactus_log_read(tactus_log log, tactus_log_view* view) {
  if (!has_known_size(view)) return TACTUS_BAD_ARGUMENT;
  const LogContent* const found = logs().find(log);
  if (found == nullptr) return TACTUS_BAD_HANDLE;
  return fill(view, {.struct_size = 0,
                     .tables = found->tables.size(),
                     .complete = found->summary.complete ? 1 : 0,
                     .damaged_elsewhere = found->summary.damaged_elsewhere ? 1 : 0,
                     .damaged_chunks = found->summary.damaged_chunks});
}

tactus_status tactus_log_table(tactus_log log, size_t table, tactus_table_view* view) {
  if (!has_known_size(view)) return TACTUS_BAD_ARGUMENT;
  const LogContent* const found = logs().find(log);
  if (found == nullptr) return TACTUS_BAD_HANDLE;
  if (table >= found->tables.size()) return TACTUS_OUT_OF_BOUNDS;
  const LogTable& at = found->tables[table];
  return fill(view, {.struct_size = 0,
                     .name = at.topic.c_str(),
                     .rows = rows_of(at),
                     .columns = at.columns.size(),
                     .missing = at.missing,
                     .times_ns = at.times_ns.empty() ? nullptr : at.times_ns.data()});
}

tactus_status tactus_log_column(tactus_log log, size_t table, size_t column, tactus_column_view* view) {
  if (!has_known_size(view)) return TACTUS_BAD_ARGUMENT;
  const LogContent* const found = logs().find(log);
  if (found == nullptr) return TACTUS_BAD_HANDLE;
  if (table >= found->tables.size() || column >= found->tables[table].columns.size()) return TACTUS_OUT_OF_BOUNDS;
  const LogTable& at = found->tables[table];
  return fill(view, {.struct_size = 0,
                     .name = at.columns[column].name.c_str(),
                     .unit = at.columns[column].unit.c_str(),
                     .doc = at.columns[column].doc.c_str(),
                     .values = at.values[column].data(),
                     .rows = at.values[column].size()});
}

tactus_status tactus_log_release(tactus_log log) {
  return guarded(nullptr,
                 [&]() -> tactus_status { return log == 0 || logs().release(log) ? TACTUS_OK : TACTUS_BAD_HANDLE; });
}
