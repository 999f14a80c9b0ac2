// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace tactus::telemetry {

/// The first and the last time of what was added.
struct TimeSpan {
  std::uint64_t first_ns = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t last_ns = 0;
  void add(std::uint64_t time_ns) {
    first_ns = std::min(first_ns, time_ns);
    last_ns = std::max(last_ns, time_ns);
  }
  [[nodiscard]] std::uint64_t first_or_zero() const { return std::min(first_ns, last_ns); }
};

/// Bytes that the end of a file needs: in memory while they are few, then in a file without a name alongside it, so
/// that a long log takes no more memory than a short one.
class EndIndex {
 public:
  explicit EndIndex(std::filesystem::path beside) : beside_(std::move(beside)) {}
  EndIndex(const EndIndex&) = delete;
  EndIndex& operator=(const EndIndex&) = delete;
  ~EndIndex();

  /// Where that file cannot be written, all is given up: a log without its index is read from front to back.
  void append(std::string_view bytes);
  /// Gives all that was appended to `take`, piece by piece, until it returns an error.
  Check for_each_piece(const std::function<Check(std::string_view)>& take);
  [[nodiscard]] std::uint64_t size() const { return given_up_ ? 0 : in_file_ + recent_.size(); }

 private:
  void spill();

  std::filesystem::path beside_;
  std::string recent_;
  std::uint64_t in_file_ = 0;
  int descriptor_ = -1;
  bool given_up_ = false;
};

/// One file of a log while it is written. One thread at a time.
class LogPart {
 public:
  /// Makes or replaces the file; a link is not followed. Errors: `unwritable`.
  static Result<std::unique_ptr<LogPart>> create(const std::filesystem::path& file);
  LogPart(const LogPart&) = delete;
  LogPart& operator=(const LogPart&) = delete;
  ~LogPart();

  /// All of `bytes` or nothing: what was written of a failed part is cut off again.
  Check put(std::string_view bytes);
  /// How many channels there are by now.
  void declare(std::size_t channels) { written_.resize(channels); }
  Check put_metadata(std::string_view name, std::string_view record);
  /// A chunk with its message indexes, and the record that describes it at the end of the file. `messages`: how many of
  /// each channel.
  Check put_chunk(std::string_view bytes, std::string_view index, const TimeSpan& span,
                  const std::vector<std::uint64_t>& messages);
  /// Ends and closes the file. `declarations` are all schemas and channels.
  Check end(std::string_view declarations, std::size_t schemas);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::uint64_t offset() const { return offset_; }
  /// What the file would take on the disk if it were ended after so many more bytes.
  [[nodiscard]] std::uint64_t size_with(std::size_t bytes, std::size_t index, std::size_t declarations) const;
  [[nodiscard]] const TimeSpan& span() const { return span_; }
  [[nodiscard]] std::uint32_t chunks() const { return chunks_; }
  /// Messages that the system has taken, by channel.
  [[nodiscard]] const std::vector<std::uint64_t>& written() const { return written_; }

 private:
  LogPart(std::filesystem::path file, int descriptor)
      : path_(std::move(file)), descriptor_(descriptor), chunk_indexes_(path_) {}
  [[nodiscard]] std::string statistics(std::size_t schemas) const;
  Check put_end(std::string_view declarations, std::size_t schemas);

  std::filesystem::path path_;
  int descriptor_;
  std::uint64_t offset_ = 0;      ///< end of what the system has taken
  std::uint32_t crc_ = 0;         ///< of the section that is being written
  std::string metadata_indexes_;  ///< for the end of the file
  EndIndex chunk_indexes_;
  std::vector<std::uint64_t> written_;
  TimeSpan span_;
  std::uint32_t chunks_ = 0;
  std::uint32_t metadata_records_ = 0;
};

}  // namespace tactus::telemetry
