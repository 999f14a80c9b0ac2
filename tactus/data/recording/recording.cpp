// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/csv_file.hpp>
#include <tactus/data/recording/mat_file.hpp>
#include <tactus/data/recording/names.hpp>
#include <tactus/data/recording/recording.hpp>
#include <tactus/data/recording/resample.hpp>
#include <tactus/data/recording/time_base.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <exception>
#include <iterator>
#include <string_view>

namespace tactus::recording {
namespace {

/// What the times of a signal say.
struct TimeBase {
  std::optional<double> sample_time_s = {};
  std::vector<double> unequal_s = {};  ///< the times where they jitter; empty where the steps are equal
  std::optional<double> jitter_s = {};
  bool unit_stated = false;
};

template <class File>
Result<TimeBase> find_time_base(const File& file, const Source& source, std::size_t samples) {
  const std::optional<std::string> name =
      source.time.empty() ? file.time_beside(source.variable, samples) : source.time;
  if (!name) return TimeBase{.sample_time_s = source.sample_time_s, .unit_stated = true};
  Result<Column> time = file.read_times(*name);
  if (!time) return under("time", time.error());
  if (time->values.size() != samples) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "time",
                 .message = in_quotes(*name) + " of '" + source.file.string() + "' has " +
                            std::to_string(time->values.size()) + " samples where '" + source.variable + "' has " +
                            std::to_string(samples) + "; name the times that belong to it",
                 .place = {}};
  }
  Result<Times> times = to_seconds(*std::move(time), source.file, source.time_unit);
  if (!times) return times.error();
  TimeBase base{.unit_stated = times->unit_stated || source.sample_time_s};
  Result<double> found = uniform_sample_time(times->since_first_s, [&](std::size_t row) { return file.place_of(row); });
  if (!found) {
    base.jitter_s = jitter_of(times->since_first_s);
    if (!base.jitter_s) return found.error();
    base.unequal_s = std::move(times->since_first_s);
    found = base.unequal_s.back() / static_cast<double>(samples - 1);
  }
  const Result<std::optional<double>> agreed = agree(source.sample_time_s, *found);
  if (!agreed) return agreed.error();
  base.sample_time_s = *agreed;
  return base;
}

template <class File>
Result<Signal> read_from(const Result<File>& file, const Source& source) {
  if (!file) return file.error();
  Result<Column> column = file->read(source.variable, source.column);
  if (!column) {
    const Error& error = column.error();
    return error.parameter.empty() ? under("variable", error) : error;
  }
  const Result<TimeBase> base = find_time_base(*file, source, column->values.size());
  if (!base) return base.error();
  if (!base->unequal_s.empty()) column->values = at_equal_steps(base->unequal_s, column->values);
  return Signal{.values = std::move(column->values),
                .name = std::move(column->name),
                .unit = std::move(column->unit),
                .sample_time_s = base->sample_time_s,
                .jitter_s = base->jitter_s,
                .time_unit_stated = base->unit_stated};
}

/// Calls `use` with the opened file, whatever its format; errors in opening it concern the parameter `file`.
template <class T, class Use>
Result<T> with_file(const std::filesystem::path& file, const Use& use,
                    CsvFile::Header header = CsvFile::Header::needed) {
  const auto refuse = [](ErrorCode code, std::string message) {
    return Error{.code = code, .parameter = "file", .message = std::move(message), .place = {}};
  };
  // The file is one that anybody may have made: whatever memory it asks for, nothing leaves this function but a result.
  try {
    std::error_code failure;
    if (!std::filesystem::exists(file, failure)) {
      return refuse(ErrorCode::missing, in_quotes(file.string()) + " does not exist; a relative path starts at '" +
                                            std::filesystem::current_path(failure).string() + "'");
    }
    if (!std::filesystem::is_regular_file(file, failure)) {
      return refuse(ErrorCode::wrong_type, in_quotes(file.string()) + " is not a file; name a .csv or .mat file");
    }
    std::string ending = file.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (ending == ".mat") return use(MatFile::open(file));
    if (ending == ".csv" || ending == ".tsv" || ending == ".txt") return use(CsvFile::open(file, header));
    return refuse(ErrorCode::wrong_type, in_quotes(file.string()) +
                                             " is of no format that is read; its name must end in "
                                             ".csv, .tsv, .txt (a table) or .mat (MATLAB)");
  } catch (const std::exception& exception) {
    return refuse(ErrorCode::failed,
                  in_quotes(file.string()) + " cannot be read (" + exception.what() + "); cut it into smaller files");
  }
}

/// The columns of one choice, which has no comma.
Result<std::vector<Column>> read_choice(const MatFile& file, std::string_view choice) {
  return file.read_choice(choice);
}
Result<std::vector<Column>> read_choice(const CsvFile& file, std::string_view choice) {
  const Result<std::vector<std::size_t>> places = file.choose(choice);
  if (!places) return places.error();
  return file.read(*places);
}

Result<Column> one_column_of_times(const CsvFile& file, const std::string& choice) { return file.read_times(choice); }
Result<Column> one_column_of_times(const MatFile& file, const std::string& choice) {
  Result<std::vector<Column>> columns = file.read_choice(choice);
  if (!columns) return columns.error();
  if (columns->size() == 1) return std::move(columns->front());
  return Error{.code = ErrorCode::inconsistent,
               .parameter = "time",
               .message = in_quotes(choice) + " has " + std::to_string(columns->size()) + " columns; name one of times",
               .place = {}};
}

template <class File>
Result<std::vector<Column>> read_list(const File& file, std::string_view list) {
  std::vector<Column> all;
  for (std::size_t start = 0; start <= list.size();) {
    const std::size_t end = std::min(list.find(',', start), list.size());
    Result<std::vector<Column>> some = read_choice(file, trim(list.substr(start, end - start)));
    if (!some) return some.error();
    std::move(some->begin(), some->end(), std::back_inserter(all));
    start = end + 1;
  }
  return all;
}

}  // namespace

Result<Times> read_times(const std::filesystem::path& file, const std::string& choice, std::string_view unit) {
  return with_file<Times>(
      file,
      [&](const auto& opened) -> Result<Times> {
        if (!opened) return opened.error();
        Result<Column> column = one_column_of_times(*opened, choice);
        if (!column) return column.error();
        return to_seconds(*std::move(column), file, unit);
      },
      CsvFile::Header::optional);
}

Result<std::vector<std::vector<Column>>> read_columns(const std::filesystem::path& file,
                                                      std::span<const std::string> choices) {
  using Lists = std::vector<std::vector<Column>>;
  return with_file<Lists>(
      file,
      [&](const auto& opened) -> Result<Lists> {
        if (!opened) return opened.error();
        Lists lists;
        for (const std::string& choice : choices) {
          Result<std::vector<Column>> columns = read_list(*opened, choice);
          if (!columns) return columns.error();
          lists.push_back(*std::move(columns));
        }
        return lists;
      },
      CsvFile::Header::optional);
}

std::string jitter_note(std::optional<double> jitter_s, double sample_time_s) {
  if (!jitter_s) return {};
  // A sine of f Hz gets an error of 2 pi f times the jitter, relative to its amplitude.
  constexpr double relative_error = 0.1, full_turn = 6.283185307179586;
  const double limit_Hz = std::min(relative_error / (full_turn * *jitter_s), 0.5 / sample_time_s);
  return "the times jitter by " + significant(1e3 * *jitter_s, 2) + " ms rms, " +
         significant(100.0 * *jitter_s / sample_time_s, 2) +
         " % of a step, so the samples were interpolated to equal steps of " + significant(1e3 * sample_time_s) +
         " ms: above " + significant(limit_Hz, 2) +
         " Hz amplitudes are uncertain by more than 10 %, and delays shorter than the jitter cannot be determined";
}

Result<Signal> read(const Source& source) {
  if (source.sample_time_s && !positive.contain(*source.sample_time_s)) {
    return out_of_bounds("sample_time_s", *source.sample_time_s, positive, units::second);
  }
  return with_file<Signal>(source.file, [&](const auto& file) { return read_from(file, source); });
}

Result<std::vector<Entry>> contents(const std::filesystem::path& file) {
  using Entries = std::vector<Entry>;
  return with_file<Entries>(file, [](const auto& opened) -> Result<Entries> {
    if (!opened) return opened.error();
    const auto& entries = opened.value().entries();
    return entries;
  });
}

}  // namespace tactus::recording
