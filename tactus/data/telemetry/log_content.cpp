// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/cdr.hpp>
#include <tactus/data/telemetry/log_reader.hpp>
#include <tactus/data/telemetry/log_writer.hpp>
#include <tactus/data/telemetry/ros_bag.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>
#include <system_error>
#include <utility>

namespace tactus::telemetry {

namespace {

constexpr std::size_t most_numbers = std::size_t{1} << 26;

/// Unix time of the start that a log states.
std::optional<std::uint64_t> start_of(const LogSummary& summary) {
  const auto clock = summary.metadata.find(log_clock);
  if (clock == summary.metadata.end()) return std::nullopt;
  const auto start = clock->second.find(log_start_key);
  if (start == clock->second.end()) return std::nullopt;
  std::uint64_t unix_ns = 0;
  const std::string& text = start->second;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), unix_ns);
  return failure == std::errc{} && end == text.data() + text.size() ? std::optional(unix_ns) : std::nullopt;
}

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
  std::vector<Column> all;        ///< columns of a message
  std::vector<std::size_t> kept;  ///< of them, those of the table
  std::uint16_t channel;          ///< in the file that began it
  std::optional<std::uint32_t> last_sequence;
};

/// Our own signals have the names of today, also in logs of versions that called them otherwise.
void rename_signals(const LogChannel& channel, std::vector<Column>& columns) {
  if (!channel.type_name.starts_with("tactus_msgs/")) return;
  constexpr std::array<std::pair<std::string_view, std::string_view>, 2> renamed{
      {{"told_", "sent_"}, {"heard_", "received_"}}};
  for (Column& column : columns) {
    for (const auto& [before, now] : renamed) {
      if (column.name.starts_with(before)) column.name.replace(0, before.size(), now);
    }
  }
}

Result<Filling> empty_table(const LogChannel& channel, const LogSelection& wanted) {
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
  rename_signals(channel, *columns);
  Filling filling{
      .table = {.topic = channel.topic, .type_name = channel.type_name, .columns = {}, .values = {}, .times_ns = {}},
      .all = *std::move(columns),
      .kept = {},
      .channel = 0,
      .last_sequence = {}};
  for (std::size_t i = 0; i < filling.all.size(); ++i) {
    if (wanted.column && !wanted.column(channel.topic, filling.all[i].name)) continue;
    filling.kept.push_back(i);
    filling.table.columns.push_back(filling.all[i]);
  }
  filling.table.values.resize(filling.kept.size());
  for (const auto& [key, text] : channel.metadata) {
    if (key.find('.') == std::string::npos) filling.table.about.emplace(key, text);
  }
  return filling;
}

/// Tables of one log, filled from its files one after the other.
class Tables {
 public:
  explicit Tables(const LogSelection& wanted) : wanted_(wanted) {}

  Result<LogSummary> read(const std::filesystem::path& file) {
    of_channel_.clear();
    unclaimed_.clear();
    for (std::size_t i = 0; i < filling_.size(); ++i) unclaimed_.emplace(filling_[i].table.topic, i);
    return scan_log(file, [this](const LogChannel& channel, const LogMessage& message) -> Check {
      if (wanted_.topic && !wanted_.topic(channel.topic)) return std::nullopt;
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
    auto filling = empty_table(channel, wanted_);
    if (!filling) return filling.error();
    const auto [first, last] = unclaimed_.equal_range(channel.topic);
    const auto begun =
        std::find_if(first, last, [&](const auto& one) { return filling_[one.second].all == filling->all; });
    std::size_t index = filling_.size();
    if (begun != last) {
      index = begun->second;
      unclaimed_.erase(begun);
    } else {
      filling->channel = number;
      filling_.push_back(*std::move(filling));
    }
    of_channel_.emplace(number, index);
    return index;
  }

  Check add(Filling& filling, const LogMessage& message) {
    LogTable& table = filling.table;
    const auto values = from_cdr(message.bytes, filling.all);
    if (!values) return values.error();
    numbers_ += filling.kept.size() + 1;
    if (numbers_ > most_numbers) {
      return Error{.code = ErrorCode::out_of_bounds,
                   .parameter = {},
                   .message = "the log holds more than " + std::to_string(most_numbers) +
                              " numbers, which do not go into memory at once: name one topic, or cut the log",
                   .place = {}};
    }
    for (std::size_t i = 0; i < filling.kept.size(); ++i) table.values[i].push_back((*values)[filling.kept[i]]);
    table.times_ns.push_back(message.time_ns);
    // A counter that runs backwards began anew and tells nothing about what is missing.
    auto& last = filling.last_sequence;
    if (last && message.sequence > *last) table.missing += message.sequence - *last - 1;
    last = message.sequence;
    return std::nullopt;
  }

  const LogSelection& wanted_;
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

const std::vector<double>* LogTable::find(std::string_view name) const {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].name == name) return &values[i];
  }
  return nullptr;
}

const LogTable* LogContent::find(std::string_view topic) const {
  const auto found =
      std::find_if(tables.begin(), tables.end(), [&](const auto& table) { return table.topic == topic; });
  return found == tables.end() ? nullptr : &*found;
}

Result<LogContent> read_log(const std::filesystem::path& file_or_folder, const std::optional<std::string>& topic) {
  LogSelection wanted;
  if (topic) wanted.topic = [&topic](const std::string& one) { return one == *topic; };
  return read_log(file_or_folder, wanted);
}

Result<LogContent> read_log(const std::filesystem::path& file_or_folder, const LogSelection& wanted) {
  const auto files = log_files(file_or_folder);
  if (!files) return files.error();
  Tables tables(wanted);
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
  content.start_unix_ns = start_of(content.summary);
  if (!content.start_unix_ns) return content;
  for (LogTable& table : content.tables) {
    // A time before the start, which no writer of ours leaves, stays as it is.
    for (std::uint64_t& time_ns : table.times_ns) {
      if (time_ns >= *content.start_unix_ns) time_ns -= *content.start_unix_ns;
    }
  }
  return content;
}

}  // namespace tactus::telemetry
