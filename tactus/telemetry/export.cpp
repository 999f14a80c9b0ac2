#include <tactus/report/text.hpp>
#include <tactus/telemetry/export.hpp>
#include <tactus/telemetry/export_parts.hpp>
#include <tactus/telemetry/log_writer.hpp>

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

ExportColumns::ExportColumns(const LogTable& table) : columns(table.columns) {
  const bool has_time =
      std::any_of(columns.begin(), columns.end(), [](const Column& column) { return column.name == "time_s"; });
  values.reserve(columns.size() + 1);
  if (!has_time) {
    seconds_.reserve(table.times_ns.size());
    for (const std::uint64_t time_ns : table.times_ns) seconds_.push_back(1e-9 * static_cast<double>(time_ns));
    columns.insert(columns.begin(), {.name = "time_s", .unit = "s", .doc = "When it was logged."});
    values.emplace_back(seconds_);
  }
  for (const std::vector<double>& column : table.values) values.emplace_back(column);
  Identifiers names("signal_", {"units", "condition"});  // members of their own in a MATLAB file
  for (Column& column : columns) {
    column.name = names.unique(column.name);
    for (std::string* text : {&column.unit, &column.site, &column.frame, &column.sign}) *text = one_line(*text);
  }
}

std::vector<std::string> names_of(const std::vector<LogTable>& tables) {
  Identifiers names("topic_", {"about"});
  std::vector<std::string> all;
  for (const LogTable& table : tables) all.push_back(names.unique(table.topic));
  return all;
}

std::map<std::string, std::string> about(const LogSummary& summary) {
  std::map<std::string, std::string> texts;
  const auto found = summary.metadata.find("tactus");
  if (found == summary.metadata.end()) return texts;
  Identifiers names("key_");
  for (const auto& [key, text] : found->second) texts.emplace(names.unique(key), text);
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
