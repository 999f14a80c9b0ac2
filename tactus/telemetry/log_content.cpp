#include <tactus/telemetry/cdr.hpp>
#include <tactus/telemetry/log_reader.hpp>
#include <tactus/telemetry/ros_bag.hpp>

#include <algorithm>
#include <charconv>
#include <system_error>

namespace tactus::telemetry {

namespace {

constexpr std::size_t most_numbers = std::size_t{1} << 26;

/// The number of a part, `12` of `log_12.mcap`, where the file is called so.
std::optional<std::uint64_t> part_number(const std::filesystem::path& file) {
  const std::string stem = file.stem().string();
  const std::size_t start = stem.rfind('_') + 1;
  std::uint64_t number = 0;
  const auto [end, failure] = std::from_chars(stem.data() + start, stem.data() + stem.size(), number);
  const bool whole = start > 0 && failure == std::errc{} && end == stem.data() + stem.size();
  return whole ? std::optional(number) : std::nullopt;
}

/// Whether the files are parts of one log, which they then stand in the order of.
bool sort_parts(std::vector<std::filesystem::path>& files) {
  const auto prefix = [](const std::filesystem::path& file) {
    const std::string stem = file.stem().string();
    return stem.substr(0, stem.rfind('_'));
  };
  const bool are_parts = std::all_of(files.begin(), files.end(), [&](const auto& file) {
    return part_number(file) && prefix(file) == prefix(files.front());
  });
  if (!are_parts) return false;
  std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) { return *part_number(a) < *part_number(b); });
  return true;
}

/// A table while it is filled.
struct Filling {
  LogTable table;
  std::uint16_t channel;  ///< in the file that began it
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

/// Tables of one log, filled from its files one after the other.
class Tables {
 public:
  explicit Tables(const std::optional<std::string>& topic) : topic_(topic) {}

  Result<LogSummary> read(const std::filesystem::path& file) {
    of_channel_.clear();
    unclaimed_.clear();
    for (std::size_t i = 0; i < filling_.size(); ++i) unclaimed_.emplace(filling_[i].table.topic, i);
    return scan_log(file, [this](const LogChannel& channel, const LogMessage& message) -> Check {
      if (topic_ && channel.topic != *topic_) return std::nullopt;
      const auto index = table_of(channel, message.channel);
      return index ? add(filling_[*index], message) : index.error();
    });
  }

  [[nodiscard]] std::vector<LogTable> take() && {
    std::stable_sort(filling_.begin(), filling_.end(),
                     [](const Filling& a, const Filling& b) { return a.channel < b.channel; });
    std::vector<LogTable> tables;
    for (Filling& one : filling_) tables.push_back(std::move(one.table));
    return tables;
  }

 private:
  /// The table of a channel of this file. An earlier file may have begun it, under the same number or another.
  Result<std::size_t> table_of(const LogChannel& channel, std::uint16_t number) {
    if (const auto found = of_channel_.find(number); found != of_channel_.end()) return found->second;
    auto table = empty_table(channel);
    if (!table) return table.error();
    const auto [first, last] = unclaimed_.equal_range(table->topic);
    const auto begun = std::find_if(
        first, last, [&](const auto& one) { return filling_[one.second].table.columns == table->columns; });
    std::size_t index = filling_.size();
    if (begun != last) {
      index = begun->second;
      unclaimed_.erase(begun);
    } else {
      filling_.push_back({*std::move(table), number, std::nullopt});
    }
    of_channel_.emplace(number, index);
    return index;
  }

  Check add(Filling& filling, const LogMessage& message) {
    LogTable& table = filling.table;
    const auto values = from_cdr(message.bytes, table.columns);
    if (!values) return values.error();
    numbers_ += values->size() + 1;
    if (numbers_ > most_numbers) {
      return Error{.code = ErrorCode::out_of_bounds,
                   .parameter = {},
                   .message = "the log holds more than " + std::to_string(most_numbers) +
                              " numbers, which do not go into memory at once: name one topic, or cut the log",
                   .place = {}};
    }
    for (std::size_t i = 0; i < values->size(); ++i) table.values[i].push_back((*values)[i]);
    table.times_ns.push_back(message.time_ns);
    // A counter that runs backwards began anew and tells nothing about what is missing.
    auto& last = filling.last_sequence;
    if (last && message.sequence > *last) table.missing += message.sequence - *last - 1;
    last = message.sequence;
    return std::nullopt;
  }

  const std::optional<std::string>& topic_;
  std::vector<Filling> filling_;
  std::map<std::uint16_t, std::size_t> of_channel_;  ///< of the file that is read
  std::multimap<std::string, std::size_t>
      unclaimed_;  ///< by topic: what earlier files began and this one did not go on
  std::size_t numbers_ = 0;
};

}  // namespace

Result<std::vector<std::filesystem::path>> log_files(const std::filesystem::path& file_or_folder) {
  std::error_code failed;
  if (!std::filesystem::is_directory(file_or_folder, failed)) return std::vector{file_or_folder};
  std::vector<std::filesystem::path> logs;
  for (const auto& entry : std::filesystem::directory_iterator(file_or_folder, failed)) {
    if (entry.path().extension() == ".mcap") logs.push_back(entry.path());
  }
  if (logs.size() == 1 || (!logs.empty() && sort_parts(logs))) return logs;
  return Error{.code = ErrorCode::missing,
               .parameter = {},
               .message = "the folder holds " + std::to_string(logs.size()) + " .mcap files, not one: name the file",
               .place = file_or_folder.string()};
}

Result<LogContent> read_log(const std::filesystem::path& file_or_folder, const std::optional<std::string>& topic) {
  const auto files = log_files(file_or_folder);
  if (!files) return files.error();
  Tables tables(topic);
  LogContent content;
  content.summary.complete = true;
  for (const auto& file : *files) {
    const auto part = tables.read(file);
    if (!part) return part.error();
    LogSummary& all = content.summary;
    all.complete = all.complete && part->complete;
    all.messages += part->messages;
    all.damaged_chunks += part->damaged_chunks;
    all.damaged_elsewhere = all.damaged_elsewhere || part->damaged_elsewhere;
    all.metadata.insert(part->metadata.begin(), part->metadata.end());
  }
  content.tables = std::move(tables).take();
  return content;
}

}  // namespace tactus::telemetry
