// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/telemetry/description.hpp>
#include <tactus/kernel/core/result.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tactus::telemetry {

/// A channel as a file declares it.
struct LogChannel {
  std::string topic;
  std::string encoding;         ///< of its messages: `cdr`
  std::string type_name;        ///< of its schema
  std::string schema_encoding;  ///< `ros2msg`
  std::string definition;
  std::map<std::string, std::string> metadata;
};

/// A message while it is being read; the bytes are gone after the call.
struct LogMessage {
  std::uint16_t channel = 0;
  std::uint32_t sequence = 0;
  std::uint64_t time_ns = 0;
  std::span<const unsigned char> bytes;
};

/// What a file turned out to be.
struct LogSummary {
  bool complete = false;             ///< has its end; else the process that wrote it was stopped, or bytes are missing
  std::uint64_t messages = 0;        ///< read
  std::uint64_t damaged_chunks = 0;  ///< complete, but their bytes or their CRC are wrong; skipped
  bool damaged_elsewhere = false;    ///< a CRC of the data section or of the summary is wrong, or a record is senseless
  std::map<std::string, std::map<std::string, std::string>> metadata;  ///< by name
};

/// Reads an MCAP file from front to back, the messages of every complete chunk in the order in which they were written,
/// those of a file that was cut at any byte included. No index is needed or used.
///
/// Memory and time are bounded whatever the file declares: a record beyond 64 MiB, before or after decompression, is
/// skipped as damaged, and so is what a file declares beyond 16 MiB. Compression: zstd, lz4, none. `visit` may end the
/// reading by returning an error.
///
/// Errors: `missing` for a file that is not there, `syntax` for one that does not begin as an MCAP file or of
/// whose chunks none can be read, `out_of_bounds` for one beyond 4 GiB unpacked; any of `visit`.
Result<LogSummary> scan_log(const std::filesystem::path& file,
                            const std::function<Check(const LogChannel&, const LogMessage&)>& visit);

/// One channel as columns of numbers.
struct LogTable {
  std::string topic;
  std::string type_name;
  std::vector<Column> columns;
  std::vector<std::vector<double>> values;        ///< one for each column, all of one length
  std::vector<std::uint64_t> times_ns;            ///< of the messages; from the start of a log that states it
  std::uint64_t missing = 0;                      ///< messages that the sequence numbers show to be missing
  std::map<std::string, std::string> about = {};  ///< what the channel states in addition to its columns, as `joint`

  /// The values of the column of this name; null if the table does not have it.
  [[nodiscard]] const std::vector<double>* find(std::string_view name) const;
};

struct LogContent {
  LogSummary summary;
  std::vector<LogTable> tables;                     ///< channels with at least one message
  std::optional<std::uint64_t> start_unix_ns = {};  ///< Unix time from which `times_ns` count; of virtual time none

  /// The table of this topic; null if the log does not have it.
  [[nodiscard]] const LogTable* find(std::string_view topic) const;
};

/// Reads all channels into memory. A channel whose messages are not CDR of a `ros2msg` definition with plain numbers is
/// an error (`wrong_type`) that names it; so is content beyond 2^26 numbers (`out_of_bounds`). With `topic`, only that
/// one. A folder stands for its one `.mcap` file, or for the parts of one log, `log_0.mcap`, `log_1.mcap` and so on,
/// which are read as one.
Result<LogContent> read_log(const std::filesystem::path& file_or_folder, const std::optional<std::string>& topic = {});

/// The same of those topics and columns that are wanted: what is left out takes no memory and does not count.
struct LogSelection {
  std::function<bool(const std::string& topic)> topic;
  std::function<bool(const std::string& topic, const std::string& column)> column;
};
Result<LogContent> read_log(const std::filesystem::path& file_or_folder, const LogSelection& wanted);

}  // namespace tactus::telemetry
