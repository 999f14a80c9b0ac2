// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/csv_file.hpp>
#include <tactus/data/recording/csv_text.hpp>
#include <tactus/data/recording/file_bytes.hpp>
#include <tactus/data/recording/limits.hpp>
#include <tactus/data/recording/names.hpp>
#include <tactus/data/recording/times.hpp>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

namespace tactus::recording {
namespace {

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
  const std::optional<CsvLayout> layout = find_layout(text_);
  if (!layout) {
    return broken(ErrorCode::missing, "is empty; write a header with names and units, then a line for each sample",
                  file_.string());
  }
  const std::string place = file_.string() + ":" + std::to_string(layout->first_line_number);
  if (layout->quote_open) return broken(ErrorCode::syntax, "a quote is not closed; close it on the same line", place);
  if (layout->columns > most_table_columns) {
    return broken(ErrorCode::out_of_bounds,
                  "the header has " + std::to_string(layout->columns) + " columns, more than the " +
                      std::to_string(most_table_columns) + " that are read; keep those that are needed",
                  place);
  }
  separator_ = layout->separator;
  data_start_ = layout->data_start;
  data_line_ = layout->data_line;
  heads_ = layout->heads;
  if (heads_.empty() && wanted == Header::needed) {
    return broken(ErrorCode::syntax,
                  "a header is needed before the numbers '" + std::string(trim(layout->first_line).substr(0, 40)) +
                      "'; put a line such as 'time [s],force [N]' there, with a name for each column",
                  place);
  }
  const bool numbered = heads_.empty();
  for (std::size_t i = 1; numbered && i <= layout->columns; ++i) heads_.push_back(std::to_string(i));
  std::vector<NameAndUnit> names = split_units(heads_);
  for (std::size_t i = 0; i < heads_.size(); ++i) {
    entries_.push_back({.name = numbered ? heads_[i] : std::move(names[i].name),
                        .unit = numbered ? std::string() : std::move(names[i].unit),
                        .kind = "column",
                        .columns = 1,
                        .readable = true});
  }
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
    const auto count = split_fields(line, separator_, fields);
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
  decimal_comma_ = has_decimal_commas(std::string_view(text_).substr(data_start_), separator_);
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
    split_fields(next_line(text_, offset), separator_, fields);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const CsvField& field = fields[columns[i]];
      const CsvNumber number = parse_number(trim(field.text), decimal_comma_);
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

Result<Column> CsvFile::read_times(std::string_view choice) const {
  if (const auto comma = choice.find(','); comma != std::string_view::npos && !find(choice)) {
    std::vector<std::size_t> places;
    for (const std::string_view part : {choice.substr(0, comma), choice.substr(comma + 1)}) {
      const Result<std::vector<std::size_t>> some = choose(trim(part));
      if (!some) return some.error();
      places.insert(places.end(), some->begin(), some->end());
    }
    const auto worth =
        places.size() == 2 ? part_of_second(heads_[places[0]], heads_[places[1]]) : std::optional<double>();
    if (!worth) {
      return Error{.code = ErrorCode::inconsistent,
                   .parameter = {},
                   .message = in_quotes(choice) + " of '" + file_.string() +
                              "' is no pair of seconds and parts of them; name one column of times, or two such as "
                              "sec,nanosec",
                   .place = {}};
    }
    Result<std::vector<Column>> pair = read(places);
    if (!pair) return pair.error();
    Column& whole = (*pair)[0];
    const double first = whole.values.front();
    for (std::size_t i = 0; i < rows_; ++i) {
      whole.values[i] = (whole.values[i] - first) + *worth * (*pair)[1].values[i];
    }
    return Column{.values = std::move(whole.values), .name = std::string(choice), .unit = "s"};
  }
  const Result<std::vector<std::size_t>> places = choose(choice);
  if (!places) return places.error();
  if (places->size() != 1) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = {},
                 .message = in_quotes(choice) + " names " + std::to_string(places->size()) +
                            " columns of times; name one, or two such as sec,nanosec",
                 .place = {}};
  }
  const std::size_t index = places->front();
  std::vector<CsvField> fields;
  std::size_t offset = data_start_;
  split_fields(next_line(text_, offset), separator_, fields);
  if (!parse_instant(fields[index].text)) {
    Result<std::vector<Column>> column = read(*places);
    if (!column) return column.error();
    return std::move(column->front());
  }
  Column times{.values = {}, .name = entries_[index].name, .unit = "s"};
  std::optional<std::int64_t> first;
  offset = data_start_;
  for (std::size_t row = 0; row < rows_; ++row) {
    split_fields(next_line(text_, offset), separator_, fields);
    const std::optional<Instant> instant = parse_instant(fields[index].text);
    if (!instant) {
      return broken(ErrorCode::syntax,
                    in_quotes(fields[index].text.substr(0, 40)) + " in column '" + heads_[index] +
                        "' is not a time of day; write it as in the lines before, or remove the line",
                    place_of(data_line_ + row, fields[index].character));
    }
    if (!first) first = instant->seconds;
    times.values.push_back(static_cast<double>(instant->seconds - *first) + instant->fraction_s);
  }
  return times;
}

std::optional<std::string> CsvFile::time_beside(std::string_view, std::size_t) const {
  const auto is_time_unit = [](const Entry& entry) {
    return entry.unit.empty() || entry.unit == "s" || entry.unit == "ms" || entry.unit == "us" || entry.unit == "ns";
  };
  for (std::size_t i = 0; i + 1 < heads_.size(); ++i) {
    if (part_of_second(heads_[i], heads_[i + 1])) return heads_[i] + "," + heads_[i + 1];
  }
  for (const bool exactly : {true, false}) {
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      std::string name = entries_[i].name;
      std::transform(name.begin(), name.end(), name.begin(),
                     [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
      if (name == "time" || entries_[i].name == "t") return heads_[i];
      if (!exactly && is_time_unit(entries_[i]) && sounds_like_time(name)) return heads_[i];
    }
  }
  return std::nullopt;
}

}  // namespace tactus::recording
