#include <tactus/core/parameters.hpp>
#include <tactus/recording/csv_file.hpp>
#include <tactus/recording/mat_file.hpp>
#include <tactus/recording/names.hpp>
#include <tactus/recording/recording.hpp>
#include <tactus/recording/time_base.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <exception>
#include <iterator>
#include <string_view>

namespace tactus::recording {
namespace {

template <class File>
Result<std::optional<double>> find_sample_time(const File& file, const Source& source, std::size_t samples) {
  const std::optional<std::string> name =
      source.time.empty() ? file.time_beside(source.variable, samples) : source.time;
  if (!name) return source.sample_time_s;
  Result<Column> time = file.read(*name, 1);
  if (!time) return under("time", time.error());
  if (time->values.size() != samples) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "time",
                 .message = in_quotes(*name) + " of '" + source.file.string() + "' has " +
                            std::to_string(time->values.size()) + " samples where '" + source.variable + "' has " +
                            std::to_string(samples) + "; name the times that belong to it",
                 .place = {}};
  }
  const Result<double> scale = seconds_in(*time, source.file);
  if (!scale) return scale.error();
  for (double& value : time->values) value *= *scale;
  const Result<double> found = uniform_sample_time(time->values, [&](std::size_t row) { return file.place_of(row); });
  if (!found) return found.error();
  return agree(source.sample_time_s, *found);
}

template <class File>
Result<Signal> read_from(const Result<File>& file, const Source& source) {
  if (!file) return file.error();
  Result<Column> column = file->read(source.variable, source.column);
  if (!column) {
    const Error& error = column.error();
    return error.parameter.empty() ? under("variable", error) : error;
  }
  const Result<std::optional<double>> sample_time = find_sample_time(*file, source, column->values.size());
  if (!sample_time) return sample_time.error();
  return Signal{.values = std::move(column->values),
                .name = std::move(column->name),
                .unit = std::move(column->unit),
                .sample_time_s = *sample_time};
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

Result<double> seconds_in(const Column& time, const std::filesystem::path& file) {
  struct Scale {
    std::string_view unit;
    double seconds;
  };
  constexpr std::array<Scale, 6> scales{
      {{"", 1.0}, {"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"µs", 1e-6}, {"ns", 1e-9}}};
  for (const Scale& scale : scales) {
    if (scale.unit == time.unit) return scale.seconds;
  }
  return Error{.code = ErrorCode::wrong_type,
               .parameter = "time",
               .message = in_quotes(time.name) + " of '" + file.string() + "' is in '" + time.unit +
                          "'; times are in s, ms, us or ns",
               .place = {}};
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
