// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>
#include <tactus/data/telemetry/export.hpp>
#include <tactus/data/telemetry/export_parts.hpp>
#include <tactus/data/telemetry/log_writer.hpp>

#include <algorithm>
#include <utility>

namespace tactus::telemetry {

namespace {

constexpr std::size_t longest_name = 63;
constexpr std::size_t longest_text = 255;

std::string identifier(std::string_view text, const std::string& stem) {
  std::string name;
  for (const char c : text) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    name += plain ? c : '_';
  }
  name.erase(0, name.find_first_not_of('_'));
  const bool begins_well = !name.empty() && !(name.front() >= '0' && name.front() <= '9');
  if (!begins_well) name.insert(0, stem);
  name.resize(std::min(name.size(), longest_name));
  return name;
}

std::string one_line(std::string_view text) {
  std::string line = report::printable(text);
  if (line.size() <= longest_text) return line;
  std::size_t end = longest_text;
  while (end > 0 && (static_cast<unsigned char>(line[end]) & 0xc0U) == 0x80U) --end;  // no part of a character
  line.resize(end);
  return line;
}

}  // namespace

std::string identifier_of(std::string_view topic) { return identifier(topic, "topic_"); }

Identifiers::Identifiers(std::string stem, std::initializer_list<std::string_view> reserved) : stem_(std::move(stem)) {
  for (const std::string_view name : reserved) given_.emplace(name, 2);
}

std::string Identifiers::unique(std::string_view name) {
  const std::string wanted = identifier(name, stem_);
  std::string given = wanted;
  for (auto [alike, is_new] = given_.try_emplace(wanted, 2); !is_new; is_new = given_.try_emplace(given, 2).second) {
    const std::string number = "_" + std::to_string(alike->second++);
    given = wanted.substr(0, longest_name - number.size()) + number;
  }
  return given;
}

double wall_seconds(std::uint64_t start_unix_ns, std::uint64_t time_ns) {
  constexpr std::uint64_t per_s = 1'000'000'000;
  const std::uint64_t all_ns = start_unix_ns + time_ns;
  const std::uint64_t whole_s = all_ns / per_s;
  return static_cast<double>(whole_s) + 1e-9 * static_cast<double>(all_ns % per_s);
}

ExportColumns::ExportColumns(const LogTable& table, std::optional<std::uint64_t> start_unix_ns) {
  const bool has_time = std::any_of(table.columns.begin(), table.columns.end(),
                                    [](const Column& column) { return column.name == "time_s"; });
  if (!has_time) seconds_.reserve(table.times_ns.size());
  if (start_unix_ns) wall_seconds_.reserve(table.times_ns.size());
  for (const std::uint64_t time_ns : table.times_ns) {
    if (!has_time) seconds_.push_back(1e-9 * static_cast<double>(time_ns));
    if (start_unix_ns) wall_seconds_.push_back(wall_seconds(*start_unix_ns, time_ns));
  }
  values.reserve(table.columns.size() + 2);
  const auto add = [this](const Column& column, const std::vector<double>& numbers) {
    columns.push_back(column);
    values.emplace_back(numbers);
  };
  const auto add_wall_time = [&] {
    if (start_unix_ns) add({.name = "wall_time_s", .unit = "s", .doc = "The same in Unix time."}, wall_seconds_);
  };
  if (!has_time) {
    add({.name = "time_s", .unit = "s", .doc = "When it was logged."}, seconds_);
    add_wall_time();
  }
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    add(table.columns[i], table.values[i]);
    if (table.columns[i].name == "time_s") add_wall_time();
  }
  for (const Column& column : columns) codes.push_back(code_words(column));
  Identifiers names("signal_", {"units", "codes", "condition", "channel"});  // members of their own in a MATLAB file
  for (Column& column : columns) {
    column.name = names.unique(column.name);
    for (std::string* text : {&column.unit, &column.site, &column.frame, &column.sign}) *text = one_line(*text);
  }
}

std::string text_of(const CodeWords& codes) {
  std::string text;
  for (std::size_t i = 0; i < codes.words.size(); ++i) {
    text += (i == 0 ? "" : ", ") + std::to_string(codes.first + static_cast<std::int64_t>(i)) + " " + codes.words[i];
  }
  return one_line(text);
}

std::vector<std::pair<std::string, std::string>> about_channel(const LogTable& table) {
  Identifiers keys("key_");
  std::vector<std::pair<std::string, std::string>> texts;
  for (const auto& [key, text] : table.about) texts.emplace_back(keys.unique(key), one_line(text));
  return texts;
}

std::vector<std::string> names_of(const std::vector<LogTable>& tables) {
  Identifiers names("topic_", {"about"});
  std::vector<std::string> all;
  for (const LogTable& table : tables) all.push_back(names.unique(table.topic));
  return all;
}

std::map<std::string, std::string> about(const LogSummary& summary) {
  std::map<std::string, std::string> texts;
  Identifiers names("key_");
  for (const char* name : {"tactus", log_clock}) {
    const auto found = summary.metadata.find(name);
    if (found == summary.metadata.end()) continue;
    for (const auto& [key, text] : found->second) texts.emplace(names.unique(key), text);
  }
  return texts;
}

std::optional<Condition> condition_of(const LogSummary& summary, std::string_view topic) {
  topic.remove_prefix(topic.starts_with('/') ? 1 : 0);
  const std::string run(topic.substr(0, topic.find('/')));
  const auto set = summary.metadata.find(run);
  const auto labels = summary.metadata.find(run_labels);
  if (set == summary.metadata.end() || labels == summary.metadata.end()) return std::nullopt;
  const auto label = labels->second.find(run);
  if (label == labels->second.end()) return std::nullopt;
  Condition condition{.label = one_line(label->second), .set = {}};
  for (const auto& [key, value] : set->second) condition.set.emplace_back(one_line(key), one_line(value));
  return condition;
}

Check refuse_empty(const LogContent& content, const std::filesystem::path& file) {
  if (!content.tables.empty()) return std::nullopt;
  return Error{.code = ErrorCode::missing,
               .parameter = {},
               .message = "the log holds no message to export: name another log or topic",
               .place = file.string()};
}

}  // namespace tactus::telemetry
