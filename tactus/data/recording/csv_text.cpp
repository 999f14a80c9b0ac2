// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/csv_text.hpp>
#include <tactus/data/recording/limits.hpp>
#include <tactus/data/recording/names.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace tactus::recording {
namespace {

constexpr std::array separators{'\t', ';', ',', ' '};

/// The separator that stands most often outside quotes.
char most_frequent(std::string_view line) {
  char best = ',';
  std::ptrdiff_t most = 0;
  for (const char candidate : {'\t', ';', ','}) {
    bool quoted = false;
    const auto count = std::count_if(line.begin(), line.end(), [&](char c) {
      if (c == '"') quoted = !quoted;
      return !quoted && c == candidate;
    });
    if (count > most) {
      best = candidate;
      most = count;
    }
  }
  return best;
}

std::string without_doubled_quotes(std::string_view field) {
  std::string text;
  for (std::size_t i = 0; i < field.size(); ++i) {
    text += field[i];
    if (field.substr(i, 2) == "\"\"") ++i;
  }
  return text;
}

/// Words between blanks; one that is in quotes or begins with a bracket keeps its blanks, and a bracket belongs to the
/// word before it.
std::vector<std::string> header_words(std::string_view line) {
  std::vector<std::string> words;
  bool quoted = false, between = true;
  int depth = 0;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
      continue;
    }
    if ((c == ' ' || c == '\t' || c == '\r') && !quoted && depth == 0) {
      between = true;
      continue;
    }
    const bool opens = c == '[' || c == '(';
    if (between && opens && !words.empty()) {
      words.back() += ' ';
    } else if (between) {
      words.emplace_back();
    }
    between = false;
    words.back() += c;
    if (opens) ++depth;
    if ((c == ']' || c == ')') && depth > 0) --depth;
  }
  return words;
}

/// Words that two blanks or more part, so that a name may have one within.
std::vector<std::string> wide_words(std::string_view line) {
  std::vector<std::string> words;
  for (std::size_t start = 0; start < line.size();) {
    std::size_t end = std::min({line.find("  ", start), line.find('\t', start), line.size()});
    if (const std::string_view word = trim(line.substr(start, end - start)); !word.empty()) words.emplace_back(word);
    start = end + 1;
  }
  return words;
}

/// The names in a line if there are as many as columns.
std::vector<std::string> names_in(std::string_view line, char separator, std::size_t columns) {
  if (separator == ' ') {
    for (std::vector<std::string> words : {header_words(line), wide_words(line)}) {
      if (words.size() == columns) return words;
    }
    return {};
  }
  std::vector<CsvField> fields;
  const auto count = split_fields(line, separator, fields);
  if (count != columns) return {};
  std::vector<std::string> names;
  for (const CsvField& field : fields) names.push_back(without_doubled_quotes(field.text));
  return names;
}

/// The separator that makes nothing but numbers of a line, as many as possible; none where there is none.
std::optional<char> separator_of_numbers(std::string_view line) {
  std::optional<char> found;
  std::vector<CsvField> fields;
  std::size_t most = 0;
  for (const char candidate : separators) {
    const auto count = split_fields(line, candidate, fields);
    if (!count || !only_numbers(fields)) continue;
    // `0,5;1,5` is two numbers and not three texts; a lone `0,5` is two.
    if (*count <= most) continue;
    found = candidate;
    most = *count;
    if (candidate != ' ' && most > 1) return found;
  }
  return found;
}

/// The header's own separator, unless the first sample shows another.
char separator_between(std::string_view header, std::string_view sample) {
  const char usual = most_frequent(header);
  std::vector<CsvField> fields;
  const auto agrees = [&](char separator) {
    const auto count = split_fields(sample, separator, fields);
    return count && *count > 1 && !names_in(header, separator, *count).empty();
  };
  if (agrees(usual)) return usual;
  for (const char candidate : separators) {
    if (candidate == usual || !agrees(candidate)) continue;
    if (candidate == ' ' && !only_numbers(fields)) continue;
    return candidate;
  }
  // A lone column of numbers with decimal commas.
  if (usual == ',' && header.find(',') == std::string_view::npos && parse_number(trim(sample), true).fault == nullptr) {
    return '\t';
  }
  return usual;
}

bool is_excel_separator(std::string_view line) { return line.size() == 5 && line.starts_with("sep="); }

}  // namespace

std::string_view next_line(std::string_view text, std::size_t& offset) {
  const std::size_t end = std::min(text.find('\n', offset), text.size());
  const std::string_view line = text.substr(offset, end - offset);
  offset = std::min(end + 1, text.size());
  return line;
}

std::optional<std::size_t> split_fields(std::string_view line, char separator, std::vector<CsvField>& fields) {
  fields.clear();
  std::size_t count = 0;
  if (separator == ' ') {
    constexpr std::string_view blanks = " \t\r";
    for (std::size_t at = line.find_first_not_of(blanks); at < line.size(); at = line.find_first_not_of(blanks, at)) {
      const std::size_t end = std::min(line.find_first_of(blanks, at), line.size());
      if (++count <= most_table_columns) fields.push_back({line.substr(at, end - at), at + 1});
      at = end;
    }
    return count;
  }
  std::size_t start = 0;
  bool quoted = false;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    if (i < line.size() && line[i] == '"') quoted = !quoted;
    if (i < line.size() && (quoted || line[i] != separator)) continue;
    if (++count > most_table_columns) continue;
    std::string_view field = trim(line.substr(start, i - start));
    if (field.size() >= 2 && field.front() == '"' && field.back() == '"') field = field.substr(1, field.size() - 2);
    fields.push_back({field, field.empty() ? start + 1 : static_cast<std::size_t>(field.data() - line.data()) + 1});
    start = i + 1;
  }
  return quoted ? std::nullopt : std::optional(count);
}

CsvNumber parse_number(std::string_view text, bool decimal_comma) {
  if (text.empty()) return {.fault = "is empty; fill in the lost sample or remove the line"};
  std::array<char, 64> with_point{};
  std::string_view digits = text.front() == '+' ? text.substr(1) : text;
  const bool two_signs = digits.data() != text.data() && digits.starts_with('-');
  if (decimal_comma && digits.size() < with_point.size() && std::count(digits.begin(), digits.end(), ',') == 1 &&
      digits.find('.') == std::string_view::npos) {
    std::replace_copy(digits.begin(), digits.end(), with_point.begin(), ',', '.');
    digits = {with_point.data(), digits.size()};
  }
  CsvNumber number;
  const auto [end, failure] = std::from_chars(digits.data(), digits.data() + digits.size(), number.value);
  if (failure == std::errc::result_out_of_range) {
    return {.fault = "is beyond the range of a double; rescale the column"};
  }
  if (failure != std::errc{} || end != digits.data() + digits.size() || two_signs) {
    return {.fault = text.find(',') == std::string_view::npos ? "is not a number; correct it or remove the line"
                                                              : "is not a number; write a decimal point, not a comma"};
  }
  if (!std::isfinite(number.value)) {
    return {.fault = "is not finite; fill in the lost sample or remove the line", .measurable = false};
  }
  if (std::fabs(number.value) > largest_value) {
    return {.fault = "is beyond 1e30, which is no measurement; correct it, remove the line or rescale the column",
            .measurable = false};
  }
  return number;
}

bool only_numbers(const std::vector<CsvField>& fields) {
  return !fields.empty() && std::all_of(fields.begin(), fields.end(), [](const CsvField& field) {
    const CsvNumber number = parse_number(field.text, true);
    return number.fault == nullptr || !number.measurable;
  });
}

bool has_decimal_commas(std::string_view samples, char separator) {
  // Where commas separate, only a quoted one can be within a number.
  if (samples.find(separator == ',' ? '"' : ',') == std::string_view::npos) return false;
  std::vector<CsvField> fields;
  bool comma = false;
  for (std::size_t offset = 0; offset < samples.size();) {
    split_fields(next_line(samples, offset), separator, fields);
    for (const CsvField& field : fields) {
      const bool point = field.text.find('.') != std::string_view::npos;
      if (!point && field.text.find(',') == std::string_view::npos) continue;
      if (parse_number(field.text, true).fault != nullptr) continue;
      if (point) return false;
      comma = true;
    }
  }
  return comma;
}

std::optional<CsvLayout> find_layout(std::string_view text) {
  CsvLayout layout;
  std::vector<std::string_view> comments;
  std::size_t offset = 0, line_start = 0, line_number = 0;
  std::string_view first;
  while (first.empty() && offset < text.size()) {
    line_start = offset;
    first = next_line(text, offset);
    ++line_number;
    const std::string_view plain = trim(first);
    if (plain.starts_with('#') || plain.starts_with('%')) {
      comments.push_back(plain.substr(std::min(plain.find_first_not_of("#%"), plain.size())));
    }
    // Excel takes `sep=;` for a statement.
    if (plain.empty() || plain.starts_with('#') || plain.starts_with('%') || is_excel_separator(plain)) first = {};
  }
  if (first.empty()) return std::nullopt;
  layout.first_line = first;
  layout.first_line_number = line_number;
  if (const std::optional<char> separator = separator_of_numbers(first)) {
    layout.separator = *separator;
    layout.data_start = line_start;
    layout.data_line = line_number;
    std::vector<CsvField> fields;
    layout.columns = split_fields(first, layout.separator, fields).value_or(0);
    for (auto comment = comments.rbegin(); comment != comments.rend() && layout.heads.empty(); ++comment) {
      for (const char candidate : {layout.separator, most_frequent(*comment), ' '}) {
        const bool a_sentence = layout.columns == 1 && candidate != ' ';
        if (layout.heads.empty() && !a_sentence) layout.heads = names_in(trim(*comment), candidate, layout.columns);
      }
    }
    return layout;
  }
  std::string_view sample;
  for (std::size_t peek = offset; sample.empty() && peek < text.size();) {
    sample = next_line(text, peek);
    if (trim(sample).empty()) sample = {};
  }
  layout.separator = separator_between(first, sample);
  std::vector<CsvField> fields;
  const auto count = split_fields(first, layout.separator, fields);
  layout.quote_open = !count;
  layout.columns = count.value_or(0);
  if (layout.separator == ' ') {
    layout.columns = *split_fields(sample, ' ', fields);
    layout.heads = names_in(first, ' ', layout.columns);
  } else {
    for (const CsvField& field : fields) layout.heads.push_back(without_doubled_quotes(field.text));
  }
  layout.data_start = offset;
  layout.data_line = line_number + 1;
  return layout;
}

}  // namespace tactus::recording
