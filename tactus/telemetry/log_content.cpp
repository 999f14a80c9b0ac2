#include <tactus/telemetry/cdr.hpp>
#include <tactus/telemetry/log_reader.hpp>

#include <algorithm>
#include <system_error>

namespace tactus::telemetry {

namespace {

constexpr std::size_t most_numbers = std::size_t{1} << 27;

Result<std::filesystem::path> log_file(const std::filesystem::path& file_or_folder) {
  std::error_code failed;
  if (!std::filesystem::is_directory(file_or_folder, failed)) return file_or_folder;
  std::vector<std::filesystem::path> logs;
  for (const auto& entry : std::filesystem::directory_iterator(file_or_folder, failed)) {
    if (entry.path().extension() == ".mcap") logs.push_back(entry.path());
  }
  if (logs.size() == 1) return logs.front();
  return Error{.code = ErrorCode::missing,
               .parameter = {},
               .message = "the folder holds " + std::to_string(logs.size()) + " .mcap files, not one: name the file",
               .place = file_or_folder.string()};
}

/// A table while it is filled.
struct Filling {
  LogTable table;
  std::optional<std::uint32_t> last_sequence;
};

Result<LogTable> empty_table(const LogChannel& channel) {
  const auto refuse = [&channel](const std::string& why) {
    return Error{.code = ErrorCode::wrong_type,
                 .parameter = {},
                 .message = "topic " + channel.topic + ": " + why + ": name another topic",
                 .place = {}};
  };
  if (channel.encoding != "cdr" || channel.schema_encoding != "ros2msg") {
    return refuse("its messages are '" + channel.encoding + "' by '" + channel.schema_encoding +
                  "', and only 'cdr' by 'ros2msg' can be read");
  }
  auto columns = columns_of(channel.definition, channel.metadata);
  if (!columns) return refuse(columns.error().message);
  const std::size_t count = columns->size();
  return LogTable{.topic = channel.topic,
                  .type_name = channel.type_name,
                  .columns = *std::move(columns),
                  .values = std::vector<std::vector<double>>(count),
                  .times_ns = {},
                  .missing = 0};
}

}  // namespace

Result<LogContent> read_log(const std::filesystem::path& file_or_folder, const std::optional<std::string>& topic) {
  const auto file = log_file(file_or_folder);
  if (!file) return file.error();
  std::map<std::uint16_t, Filling> filling;
  std::size_t numbers = 0;
  auto summary = scan_log(*file, [&](const LogChannel& channel, const LogMessage& message) -> Check {
    if (topic && channel.topic != *topic) return std::nullopt;
    auto found = filling.find(message.channel);
    if (found == filling.end()) {
      auto table = empty_table(channel);
      if (!table) return table.error();
      found = filling.emplace(message.channel, Filling{*std::move(table), std::nullopt}).first;
    }
    auto& [table, last_sequence] = found->second;
    const auto values = from_cdr(message.bytes, table.columns);
    if (!values) return values.error();
    numbers += values->size() + 1;
    if (numbers > most_numbers) {
      return Error{.code = ErrorCode::out_of_bounds,
                   .parameter = {},
                   .message = "the log holds more than " + std::to_string(most_numbers) +
                              " numbers, which do not go into memory at once: name one topic, or cut the log",
                   .place = {}};
    }
    for (std::size_t i = 0; i < values->size(); ++i) table.values[i].push_back((*values)[i]);
    table.times_ns.push_back(message.time_ns);
    // A counter that runs backwards began anew and tells nothing about what is missing.
    if (last_sequence && message.sequence > *last_sequence) table.missing += message.sequence - *last_sequence - 1;
    last_sequence = message.sequence;
    return std::nullopt;
  });
  if (!summary) return summary.error();
  LogContent content{.summary = *std::move(summary), .tables = {}};
  for (auto& [id, one] : filling) content.tables.push_back(std::move(one.table));
  return content;
}

}  // namespace tactus::telemetry
