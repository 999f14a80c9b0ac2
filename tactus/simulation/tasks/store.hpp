// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

namespace tactus::tasks {

/// Finished tasks of one job in a file, which only grows.
///
/// The file starts with the words `tactus tasks 1`. Records follow, of which the first has `version_and_build` as its
/// key and the description of the job as its value, and each further one the key and the value of a task. A record is
/// two lengths of 32 bits, key, value, and the CRC-32 of all these, in the byte order of the machine. It is written at
/// once, before the value is used. If the process is killed within a write, the last record does not match its
/// checksum; `open` truncates the file before the first such record.
class TaskStore {
 public:
  /// Opens or makes the file and locks it. Errors: `inconsistent` for a file of another job, version or build, for a
  /// file that does not start as above, and for one that another process has open; `missing` if it cannot be read;
  /// `unwritable`.
  static Result<TaskStore> open(const std::filesystem::path& file, std::string_view description);
  TaskStore(TaskStore&& other) noexcept;
  TaskStore& operator=(TaskStore&&) = delete;
  ~TaskStore();

  /// Number of tasks in the file.
  [[nodiscard]] std::size_t size() const { return size_; }
  /// The value of a key, if it is in the file. Errors: `missing` if the file cannot be read.
  [[nodiscard]] Result<std::optional<std::string>> find(std::string_view key) const;
  /// Appends a task with one write. Errors: `unwritable`.
  Check append(std::string_view key, std::string_view value);

 private:
  /// Where a record is. Keys and values stay on the disk, so that a large job takes little memory.
  struct Record {
    std::uint64_t at = 0;  ///< of the key, from the start of the file
    std::uint32_t key_length = 0, value_length = 0;
  };

  TaskStore(std::filesystem::path path, int file) : path_(std::move(path)), file_(file) {}
  [[nodiscard]] Check read_records(std::string_view description);
  void add(std::string_view key, const Record& record);

  std::filesystem::path path_;
  int file_;
  std::uint64_t end_ = 0;
  std::size_t size_ = 0;
  std::unordered_multimap<std::size_t, Record> records_;  ///< by the hash of the key
};

}  // namespace tactus::tasks
