// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tactus::recording {

/// One field of a line, without blanks and quotes around it, and the character of the line (from 1) where it begins.
struct CsvField {
  std::string_view text;
  std::size_t character;
};

/// The next line of `text` from `offset`, which moves behind it.
std::string_view next_line(std::string_view text, std::size_t& offset);

/// How many fields a line has; none if a quote stays open. No more than a table may have are kept. The separator ' '
/// stands for any number of blanks and tabs.
std::optional<std::size_t> split_fields(std::string_view line, char separator, std::vector<CsvField>& fields);

/// What a text states as a number, or the reason why it states none.
struct CsvNumber {
  double value = 0.0;
  const char* fault = nullptr;
  bool measurable = true;  ///< false for a number that cannot be measured, such as `nan` or 1e300; it has a fault too
};
CsvNumber parse_number(std::string_view text, bool decimal_comma);

/// Are these all numbers, `nan` among them, with points or all with commas?
bool only_numbers(const std::vector<CsvField>& fields);

/// Where the samples of a table begin, and what its header calls the columns.
struct CsvLayout {
  std::vector<std::string> heads = {};  ///< as written; empty where there is no header
  std::size_t columns = 0;
  std::string_view first_line = {};  ///< the header, or the first sample without a header
  std::size_t first_line_number = 0;
  std::size_t data_start = 0;  ///< offset of the first sample in the text
  std::size_t data_line = 0;   ///< its line, from 1
  char separator = ',';
  bool quote_open = false;
};

/// Finds header, separator and first sample. Lines that begin with `#` or `%` are comments; the last of them that has
/// as many words as the samples have columns is the header where no other line is, as NumPy's `savetxt` writes it. None
/// for a text without lines that are neither empty nor comments.
std::optional<CsvLayout> find_layout(std::string_view text);

/// Does a table of this separator write decimal commas? Some number has a comma and none has a point.
bool has_decimal_commas(std::string_view samples, char separator);

}  // namespace tactus::recording
