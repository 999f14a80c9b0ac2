// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/recording/column.hpp>
#include <tactus/data/recording/recording.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tactus::recording {

/// A table of text whose fields commas, semicolons, tabs or blanks separate, held in memory. `read` documents the
/// format and the errors.
class CsvFile {
 public:
  /// Without a header the columns are called 1, 2 and so on.
  enum class Header { needed, optional };
  static Result<CsvFile> open(const std::filesystem::path& file, Header header = Header::needed);

  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }
  /// The samples of a column; `column` must be 1.
  [[nodiscard]] Result<Column> read(std::string_view variable, std::int64_t column) const;
  /// The places of the columns that `read_columns` calls a choice, counted from 0.
  [[nodiscard]] Result<std::vector<std::size_t>> choose(std::string_view choice) const;
  /// The samples of several columns, in one pass.
  [[nodiscard]] Result<std::vector<Column>> read(std::span<const std::size_t> columns) const;
  /// The samples of the column or columns of times that `Source::time` names.
  [[nodiscard]] Result<Column> read_times(std::string_view choice) const;
  /// The column or columns that hold times if nobody names one.
  [[nodiscard]] std::optional<std::string> time_beside(std::string_view variable, std::size_t samples) const;
  /// `file:line` of a sample.
  [[nodiscard]] std::string place_of(std::size_t row) const;

 private:
  CsvFile() = default;
  [[nodiscard]] std::string place_of(std::size_t line, std::size_t character) const;
  /// The column of this name.
  [[nodiscard]] Result<std::size_t> find(std::string_view variable) const;
  Check parse_header(Header wanted);
  Check count_rows();

  std::filesystem::path file_;
  std::string text_;
  std::vector<std::string> heads_;  ///< as written
  std::vector<Entry> entries_;
  std::size_t data_start_ = 0;  ///< offset of the first sample in the text
  std::size_t data_line_ = 0;   ///< its line, from 1
  std::size_t rows_ = 0;
  char separator_ = ',';
  bool decimal_comma_ = false;
};

}  // namespace tactus::recording
