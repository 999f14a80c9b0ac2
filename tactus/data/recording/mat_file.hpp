// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/recording/column.hpp>
#include <tactus/data/recording/recording.hpp>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tactus::recording {

/// A MATLAB file of version 5, read through matio. `read` documents the format and the errors.
class MatFile {
 public:
  static Result<MatFile> open(const std::filesystem::path& file);
  MatFile(MatFile&&) noexcept;
  ~MatFile();

  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }
  /// The samples of one column (from 1) of a variable.
  [[nodiscard]] Result<Column> read(std::string_view variable, std::int64_t column) const;
  /// The columns that `read_columns` calls a choice.
  [[nodiscard]] Result<std::vector<Column>> read_choice(std::string_view choice) const;
  /// The samples of the variable that `Source::time` names.
  [[nodiscard]] Result<Column> read_times(std::string_view choice) const;
  /// The variable that holds times if nobody names one.
  [[nodiscard]] std::optional<std::string> time_beside(std::string_view variable, std::size_t samples) const;
  /// The file: a sample of it has no line.
  [[nodiscard]] std::string place_of(std::size_t row) const;

 private:
  struct Content;
  MatFile(std::filesystem::path file, std::unique_ptr<Content> content);

  std::filesystem::path file_;
  std::unique_ptr<Content> content_;
  std::vector<Entry> entries_;
};

}  // namespace tactus::recording
