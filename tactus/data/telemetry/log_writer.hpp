// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/telemetry/cdr.hpp>
#include <tactus/kernel/core/result.hpp>

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace tactus::telemetry {

/// The metadata that states in words how each run differs from the others, by the name of the run: `run_1` to
/// `force gain 3`. The metadata `run_1` has the values of the varied keys.
inline constexpr const char* run_labels = "labels";

/// A stream of messages of one kind in a log.
struct ChannelDescription {
  std::string topic;      ///< as ROS 2 names topics: `/teleoperator`
  std::string type_name;  ///< as ROS 2 names types: `tactus_msgs/msg/TeleoperatorRecord`
  std::vector<Column> columns;
  std::map<std::string, std::string> about = {};  ///< what else is known of it, as `joint`; keys without a dot
};

/// The metadata that states when a log started, in words and in ns of Unix time, from which the times of its messages
/// count. A log of virtual time does not have it.
inline constexpr const char* log_clock = "clock";
inline constexpr const char* log_start_key = "start_unix_ns";

/// What became of one channel.
struct ChannelCount {
  std::string topic;
  std::string type_name;
  std::uint64_t written = 0;  ///< acknowledged: in a chunk that the system has taken
  std::uint64_t lost = 0;     ///< in chunks that could not be written
};

/// One file of a log.
struct LogPartSummary {
  std::filesystem::path file;
  std::uint64_t first_time_ns = 0;  ///< of its messages, as the file has it; both 0 without messages
  std::uint64_t last_time_ns = 0;
  std::vector<std::uint64_t> messages;  ///< by channel, acknowledged
};

/// Writes an MCAP file (profile `ros2`, messages as CDR, schemas as `ros2msg`) that a killed process cannot spoil.
///
/// Messages gather in a chunk. A full one is compressed (zstd), gets its CRC-32 and goes to the system in one write;
/// then its messages are **acknowledged** and the end of the process no longer touches them. Schemas, channels and
/// metadata are before the first chunk, so every complete chunk can be read without the end of the file. `close` adds
/// the indexes, statistics and the footer.
///
/// Where a write fails (a full disk), the file is cut back to its last complete record, the messages of the chunk are
/// counted as lost, and the next chunk is tried again: the file stays readable, the gap has a number.
///
/// A log with a limit is a ring of up to four files, `log_0.mcap`, `log_1.mcap` and so on, of a quarter of the limit
/// each. When one is full it is ended and the next begun, and the oldest removed, so that the newest messages are
/// there, no more than the limit is taken at any time, and each file is a whole log.
///
/// Memory does not grow with the log. Equal calls write equal bytes: no clock is read. One thread at a time. Blocks on
/// the disk: never on the servo path.
class LogWriter {
 public:
  /// Content of a chunk before compression at which it is written.
  static constexpr std::size_t chunk_bytes = std::size_t{256} * 1024;

  /// The least that a log may be limited to.
  static constexpr std::uint64_t least_limit_bytes = std::uint64_t{8} << 20U;

  /// Makes or replaces the file; a link is not followed. With `most_bytes` other than 0 the log is limited to so much,
  /// its `metadata.yaml` included. Errors: `unwritable`; `out_of_bounds` for a limit below `least_limit_bytes`. A full
  /// disk shows only when the first chunk is written.
  static Result<LogWriter> create(const std::filesystem::path& file, std::uint64_t most_bytes = 0);

  LogWriter(LogWriter&&) noexcept;
  LogWriter& operator=(LogWriter&&) noexcept;
  ~LogWriter();  ///< closes; who wants to know whether that worked calls `close`

  /// The times of `write` count from this instant, in ns of Unix time: the file has them in Unix time, as other
  /// programs expect, and states the start as metadata. Before the first message.
  void start_at(std::int64_t unix_ns);

  /// The number of the new channel. Equal types share a schema.
  std::uint16_t add_channel(const ChannelDescription& channel);
  /// A named set of texts: configuration, seeds, version.
  void add_metadata(const std::string& name, const std::map<std::string, std::string>& content);

  /// Appends a message to the open chunk and writes the chunk when it is full. `time_ns` counts from the start, or
  /// without one from any fixed instant.
  void write(std::uint16_t channel, std::uint32_t sequence, std::uint64_t time_ns, std::span<const unsigned char> cdr);

  /// Writes the open chunk. Errors: `unwritable`, with what was lost.
  Check flush();
  /// Flushes and ends the file. Errors: that of the flush, of the end, or else of any write before.
  Check close();

  [[nodiscard]] const std::vector<ChannelCount>& counts() const;
  /// Messages that the system has taken.
  [[nodiscard]] std::uint64_t acknowledged() const;
  [[nodiscard]] std::uint64_t lost() const;
  /// Messages that were acknowledged, and went with the oldest files of a log with a limit.
  [[nodiscard]] std::uint64_t removed() const;
  /// The files that are there, the oldest first.
  [[nodiscard]] std::vector<LogPartSummary> parts() const;
  /// Latest time of any message that was given, acknowledged or not.
  [[nodiscard]] std::uint64_t newest_time_ns() const;

 private:
  struct State;
  explicit LogWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Writes `metadata.yaml` next to a closed log, so that a ROS 2 bag tool takes the folder (rosbag2 format 5).
Check write_bag_metadata(const std::filesystem::path& log, const LogWriter& writer);

}  // namespace tactus::telemetry
