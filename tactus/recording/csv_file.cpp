#include <tactus/recording/csv_file.hpp>
#include <tactus/recording/file_bytes.hpp>
#include <tactus/recording/limits.hpp>
#include <tactus/recording/names.hpp>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

namespace tactus::recording {
namespace {

/// One field of a line, without blanks and quotes around it, and the character of the line (from 1) where it begins.
struct CsvField {
  std::string_view text;
  std::size_t character;
};

/// The next line of `text` from `offset`, which moves behind it.
std::string_view next_line(std::string_view text, std::size_t& offset) {
  const std::size_t end = std::min(text.find('\n', offset), text.size());
  const std::string_view line = text.substr(offset, end - offset);
  offset = std::min(end + 1, text.size());
  return line;
}

/// How many fields a line has; none if a quote stays open. No more than a table may have are kept.
std::optional<std::size_t> split(std::string_view line, char separator, std::vector<CsvField>& fields) {
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

/// The separator that stands most often outside quotes.
char separator_of(std::string_view header) {
  char best = ',';
  std::ptrdiff_t most = 0;
  for (const char candidate : {'\t', ';', ','}) {
    bool quoted = false;
    const auto count = std::count_if(header.begin(), header.end(), [&](char c) {
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

/// What `text` says as a number, or the reason why it says none.
struct Number {
  double value = 0.0;
  const char* fault = nullptr;
};
Number parse_number(std::string_view text) {
  if (text.empty()) return {.fault = "is empty; fill in the lost sample or remove the line"};
  const std::string_view digits = text.front() == '+' ? text.substr(1) : text;
  Number number;
  const auto [end, failure] = std::from_chars(digits.data(), digits.data() + digits.size(), number.value);
  if (failure == std::errc::result_out_of_range)
    return {.fault = "is beyond the range of a double; rescale the column"};
  const bool two_signs = digits.data() != text.data() && digits.starts_with('-');
  if (failure != std::errc{} || end != digits.data() + digits.size() || two_signs) {
    return {.fault = text.find(',') == std::string_view::npos ? "is not a number; correct it or remove the line"
                                                              : "is not a number; write a decimal point, not a comma"};
  }
  if (!std::isfinite(number.value)) return {.fault = "is not finite; fill in the lost sample or remove the line"};
  if (std::fabs(number.value) > largest_value) {
    return {.fault = "is beyond 1e30, which is no measurement; correct it, remove the line or rescale the column"};
  }
  return number;
}

bool only_numbers(const std::vector<CsvField>& fields) {
  return std::all_of(fields.begin(), fields.end(),
                     [](const CsvField& field) { return parse_number(field.text).fault == nullptr; });
}

Error broken(ErrorCode code, std::string message, std::string place) {
  return {.code = code, .parameter = {}, .message = std::move(message), .place = std::move(place)};
}

}  // namespace

std::string CsvFile::place_of(std::size_t row) const { return file_.string() + ":" + std::to_string(data_line_ + row); }

std::string CsvFile::place_of(std::size_t line, std::size_t character) const {
  return file_.string() + ":" + std::to_string(line) + ":" + std::to_string(character);
}

Result<CsvFile> CsvFile::open(const std::filesystem::path& file, Header header) {
  CsvFile table;
  table.file_ = file;
  Result<std::string> bytes = file_bytes(file, most_table_bytes);
  if (!bytes) return bytes.error();
  table.text_ = *std::move(bytes);
  if (table.text_.starts_with("\xEF\xBB\xBF")) table.text_.erase(0, 3);
  if (table.text_.starts_with("\xFF\xFE") || table.text_.starts_with("\xFE\xFF")) {
    return broken(ErrorCode::syntax, "is UTF-16 text; save it as UTF-8", file.string());
  }
  if (table.text_.find('\0') != std::string::npos) {
    return broken(ErrorCode::syntax, "holds a zero byte, so it is no text; name a table or a .mat file", file.string());
  }
  if (Check wrong = table.parse_header(header)) return *std::move(wrong);
  if (Check wrong = table.count_rows()) return *std::move(wrong);
  return table;
}

Check CsvFile::parse_header(Header wanted) {
  std::size_t offset = 0;
  std::size_t line_start = 0;
  std::size_t line_number = 0;
  std::string_view header;
  while (trim(header).empty() && offset < text_.size()) {
    line_start = offset;
    header = next_line(text_, offset);
    if (trim(header).starts_with('#')) header = {};
    ++line_number;
  }
  if (trim(header).empty()) {
    return broken(ErrorCode::missing, "is empty; write a header with names and units, then a line for each sample",
                  file_.string());
  }
  separator_ = separator_of(header);
  std::vector<CsvField> fields;
  if (wanted == Header::optional && header.find_first_of(",;\t") == std::string_view::npos) {
    split(header, ' ', fields);
    if (only_numbers(fields)) separator_ = ' ';
  }
  const auto count = split(header, separator_, fields);
  const std::string place = file_.string() + ":" + std::to_string(line_number);
  if (!count) return broken(ErrorCode::syntax, "a quote is not closed; close it on the same line", place);
  if (*count > most_table_columns) {
    return broken(ErrorCode::out_of_bounds,
                  "the header has " + std::to_string(*count) + " columns, more than the " +
                      std::to_string(most_table_columns) + " that are read; keep those that are needed",
                  place);
  }
  if (only_numbers(fields)) {
    if (wanted == Header::optional) {
      for (std::size_t i = 1; i <= fields.size(); ++i) {
        heads_.push_back(std::to_string(i));
        entries_.push_back({.name = heads_.back(), .kind = "column", .columns = 1, .readable = true});
      }
      data_start_ = line_start;
      data_line_ = line_number;
      return {};
    }
    return broken(ErrorCode::syntax,
                  "a header is needed before the numbers '" + std::string(trim(header).substr(0, 40)) +
                      "'; put a line such as 'time [s],force [N]' there, without a # before it",
                  place);
  }
  for (const CsvField& field : fields) {
    heads_.push_back(without_doubled_quotes(field.text));
    NameAndUnit head = split_unit(heads_.back());
    entries_.push_back(
        {.name = std::move(head.name), .unit = std::move(head.unit), .kind = "column", .columns = 1, .readable = true});
  }
  data_start_ = offset;
  data_line_ = line_number + 1;
  return {};
}

Check CsvFile::count_rows() {
  std::vector<CsvField> fields;
  // Empty lines at the end are no samples. A tab there may be a separator.
  text_.resize(std::max(text_.find_last_not_of(" \r\n") + 1, data_start_));
  for (std::size_t offset = data_start_; offset < text_.size(); ++rows_) {
    const std::string_view line = next_line(text_, offset);
    if (rows_ == most_samples) {
      return broken(ErrorCode::out_of_bounds,
                    "holds more than the " + std::to_string(most_samples) +
                        " samples that are read; cut it into smaller files, or keep fewer samples a second",
                    file_.string());
    }
    const auto count = split(line, separator_, fields);
    if (!count) return broken(ErrorCode::syntax, "a quote is not closed; close it on the same line", place_of(rows_));
    if (*count == heads_.size()) continue;
    return broken(ErrorCode::syntax,
                  in_quotes(trim(line).substr(0, 40)) + " has " + std::to_string(*count) +
                      " fields where the header has " + std::to_string(heads_.size()) +
                      "; complete or remove the line, and write numbers with a decimal point",
                  place_of(rows_));
  }
  if (rows_ < 2) {
    return broken(ErrorCode::missing, "holds " + std::to_string(rows_) + " samples; a signal needs two or more",
                  file_.string());
  }
  for (Entry& entry : entries_) entry.rows = static_cast<std::int64_t>(rows_);
  return {};
}

Result<Column> CsvFile::read(std::string_view variable, std::int64_t column) const {
  if (column != 1) {
    return Error{.code = ErrorCode::out_of_bounds,
                 .parameter = "column",
                 .message = std::to_string(column) + " chooses among the columns of a MATLAB variable; a column of '" +
                            file_.string() + "' is chosen by its name alone, so leave it out or write 1",
                 .place = {}};
  }
  const Result<std::size_t> index = find(variable);
  if (!index) return index.error();
  Result<std::vector<Column>> columns = read(std::span(&*index, 1));
  if (!columns) return columns.error();
  return std::move(columns->front());
}

Result<std::size_t> CsvFile::find(std::string_view variable) const {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < heads_.size(); ++i) {
    if (heads_[i] == variable) found.push_back(i);
  }
  const bool named_in_full = !found.empty();
  for (std::size_t i = 0; !named_in_full && i < entries_.size(); ++i) {
    if (entries_[i].name == variable) found.push_back(i);
  }
  // With its unit, as a signal of ours is called: `force_N` of `force [N]`.
  if (const NameAndUnit asked = split_unit(variable); found.empty() && !asked.unit.empty()) {
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      if (entries_[i].name == asked.name && entries_[i].unit == asked.unit) found.push_back(i);
    }
  }
  if (found.empty() || variable.empty()) return no_such_variable(variable, file_, entries_);
  if (found.size() > 1) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = {},
                 .message = in_quotes(variable) + " stands for the columns '" + heads_[found[0]] + "' and '" +
                            heads_[found[1]] + "' of '" + file_.string() +
                            "'; give them different names or write one "
                            "with its unit",
                 .place = {}};
  }
  return found.front();
}

Result<std::vector<std::size_t>> CsvFile::choose(std::string_view choice) const {
  using Places = std::vector<std::size_t>;
  Result<std::size_t> one = find(choice);
  if (one) return Places{*one};
  if (const auto colon = choice.find(':'); colon != std::string_view::npos) {
    Result<Places> first = choose(choice.substr(0, colon));
    if (!first) return first;
    Result<Places> last = choose(choice.substr(colon + 1));
    if (!last) return last;
    if (first->size() == 1 && last->size() == 1 && first->front() <= last->front()) {
      Places places;
      for (std::size_t i = first->front(); i <= last->front(); ++i) places.push_back(i);
      return places;
    }
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = {},
                 .message = in_quotes(choice) + " is no range of columns of '" + file_.string() +
                            "'; write the first, a colon and the last, as 2:7",
                 .place = {}};
  }
  // A number, where no column is called so.
  std::size_t number = 0;
  const auto [end, failure] = std::from_chars(choice.data(), choice.data() + choice.size(), number);
  if (failure != std::errc{} || end != choice.data() + choice.size()) return one.error();
  if (number >= 1 && number <= heads_.size()) return Places{number - 1};
  return Error{.code = ErrorCode::out_of_bounds,
               .parameter = {},
               .message = "column " + std::string(choice) + " is asked for, but '" + file_.string() + "' has " +
                          std::to_string(heads_.size()) + " columns; number them from 1",
               .place = {}};
}

Result<std::vector<Column>> CsvFile::read(std::span<const std::size_t> columns) const {
  std::vector<Column> result;
  for (const std::size_t index : columns) {
    result.push_back({.values = {}, .name = entries_[index].name, .unit = entries_[index].unit});
    result.back().values.reserve(rows_);
  }
  std::vector<CsvField> fields;
  std::size_t offset = data_start_;
  for (std::size_t row = 0; row < rows_; ++row) {
    split(next_line(text_, offset), separator_, fields);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const CsvField& field = fields[columns[i]];
      const Number number = parse_number(trim(field.text));
      if (number.fault != nullptr) {
        return broken(ErrorCode::syntax,
                      in_quotes(field.text.substr(0, 40)) + " in column '" + heads_[columns[i]] + "' " + number.fault,
                      place_of(data_line_ + row, field.character));
      }
      result[i].values.push_back(number.value);
    }
  }
  return result;
}

std::optional<std::string> CsvFile::time_beside(std::string_view, std::size_t) const {
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    std::string name = entries_[i].name;
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (name == "time" || entries_[i].name == "t") return heads_[i];
  }
  return std::nullopt;
}

}  // namespace tactus::recording
