#include <tactus/telemetry/export.hpp>
#include <tactus/telemetry/export_parts.hpp>

#include <algorithm>

namespace tactus::telemetry {

std::string identifier_of(std::string_view topic) {
  std::string name;
  for (const char c : topic) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    name += plain ? c : '_';
  }
  name.erase(0, name.find_first_not_of('_'));
  const bool begins_well = !name.empty() && !(name.front() >= '0' && name.front() <= '9');
  return begins_well ? name : "topic_" + name;
}

LogTable with_time(LogTable table) {
  const bool has_time =
      std::any_of(table.columns.begin(), table.columns.end(), [](const Column& c) { return c.name == "time_s"; });
  if (has_time) return table;
  std::vector<double> seconds;
  seconds.reserve(table.times_ns.size());
  for (const std::uint64_t time_ns : table.times_ns) seconds.push_back(1e-9 * static_cast<double>(time_ns));
  table.columns.push_back({.name = "time_s", .unit = "s", .doc = "When it was logged."});
  table.values.push_back(std::move(seconds));
  std::rotate(table.columns.rbegin(), table.columns.rbegin() + 1, table.columns.rend());
  std::rotate(table.values.rbegin(), table.values.rbegin() + 1, table.values.rend());
  return table;
}

std::map<std::string, std::string> about(const LogSummary& summary) {
  const auto found = summary.metadata.find("tactus");
  return found == summary.metadata.end() ? std::map<std::string, std::string>{} : found->second;
}

Check refuse_empty(const LogContent& content, const std::filesystem::path& file) {
  if (!content.tables.empty()) return std::nullopt;
  return Error{.code = ErrorCode::missing,
               .parameter = {},
               .message = "the log holds no message to export: name another log or topic",
               .place = file.string()};
}

}  // namespace tactus::telemetry
