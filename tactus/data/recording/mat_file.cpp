// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/limits.hpp>
#include <tactus/data/recording/mat_file.hpp>
#include <tactus/data/recording/mat_guard.hpp>
#include <tactus/data/recording/names.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <numeric>

#include <matio.h>

namespace tactus::recording {
namespace {

struct CloseFile {
  void operator()(mat_t* file) const { Mat_Close(file); }
};
struct FreeVariable {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};

std::size_t member_count(const matvar_t& variable) {
  if (variable.rank < 1 || variable.dims == nullptr) return 0;
  return std::accumulate(variable.dims, variable.dims + variable.rank, std::size_t{1}, std::multiplies<>{});
}

bool is_real_matrix(const matvar_t& variable) {
  return variable.class_type >= MAT_C_DOUBLE && variable.class_type <= MAT_C_UINT64 && variable.isComplex == 0 &&
         variable.rank == 2;
}

std::string kind_of(const matvar_t& variable) {
  constexpr const char* names[] = {"empty",  "cell",   "struct", "object", "char",     "sparse",
                                   "double", "single", "int8",   "uint8",  "int16",    "uint16",
                                   "int32",  "uint32", "int64",  "uint64", "function", "object"};
  const std::string name = names[variable.class_type];
  if (variable.isComplex != 0) return "complex " + name;
  return variable.rank > 2 ? name + " of " + std::to_string(variable.rank) + " dimensions" : name;
}

/// Whether a matrix has its signals in rows, as Simulink's To File block writes them: far fewer rows than columns.
bool has_signals_in_rows(const matvar_t& variable) {
  constexpr std::size_t most_signals = 64, least_samples_per_signal = 10;
  return is_real_matrix(variable) && variable.dims[0] > 1 && variable.dims[0] <= most_signals &&
         variable.dims[1] >= least_samples_per_signal * variable.dims[0];
}

/// A variable as samples by columns; a row vector stands up, and so do signals in rows.
Entry entry_of(std::string name, const matvar_t& variable) {
  Entry entry{.name = std::move(name), .unit = {}, .kind = kind_of(variable)};
  if (variable.rank >= 2) {
    entry.rows = static_cast<std::int64_t>(variable.dims[0]);
    entry.columns = static_cast<std::int64_t>(variable.dims[1]);
  }
  if (is_real_matrix(variable) && (entry.rows == 1 || has_signals_in_rows(variable))) {
    std::swap(entry.rows, entry.columns);
  }
  entry.readable = is_real_matrix(variable) && entry.rows >= 2 && entry.columns >= 1;
  return entry;
}

/// A variable and the path that names it.
struct Leaf {
  matvar_t* variable;
  Entry entry;
};

/// Appends `variable` and, where it is a struct, its fields in place of itself.
void unfold(matvar_t& variable, const std::string& path, std::vector<Leaf>& leaves) {
  if (variable.class_type != MAT_C_STRUCT) {
    leaves.push_back({&variable, entry_of(path, variable)});
    return;
  }
  const std::size_t members = member_count(variable);
  const std::size_t fields = Mat_VarGetNumberOfFields(&variable);
  const char* const* names = Mat_VarGetStructFieldnames(&variable);
  for (std::size_t i = 0; i < members; ++i) {
    const std::string member = members == 1 ? path : path + "(" + std::to_string(i + 1) + ")";
    for (std::size_t k = 0; k < fields; ++k) {
      matvar_t* field = Mat_VarGetStructFieldByIndex(&variable, k, i);
      if (field != nullptr && names[k] != nullptr) unfold(*field, member + "." + names[k], leaves);
    }
  }
}

/// A path without the index of structs that have but one member: `scope(1).time` is `scope.time`.
std::string without_needless_index(std::string_view path, const std::vector<Leaf>& leaves) {
  const auto exists = [&](std::string_view name) {
    return std::any_of(leaves.begin(), leaves.end(), [&](const Leaf& leaf) { return leaf.entry.name == name; });
  };
  std::string shortened(path);
  for (std::size_t start = shortened.find("(1)"); start != std::string::npos && !exists(shortened);
       start = shortened.find("(1)", start + 1)) {
    std::string candidate = shortened;
    candidate.erase(start, 3);
    const std::string stem = candidate.substr(0, start);
    const bool single = std::any_of(leaves.begin(), leaves.end(),
                                    [&](const Leaf& leaf) { return leaf.entry.name.starts_with(stem + "."); });
    if (single) shortened = std::move(candidate);
  }
  return shortened;
}

/// `count` numbers of a variable's data, from `first` on, each `stride` behind the one before.
struct Samples {
  std::size_t first, count, stride;
};

template <class Number>
std::vector<double> numbers_of(const matvar_t& variable, const Samples& samples) {
  const auto* at = static_cast<const Number*>(variable.data) + samples.first;
  std::vector<double> values(samples.count);
  for (std::size_t i = 0; i < samples.count; ++i) values[i] = static_cast<double>(at[i * samples.stride]);
  return values;
}

std::vector<double> column_of(const matvar_t& variable, const Samples& samples) {
  switch (variable.class_type) {
    case MAT_C_SINGLE:
      return numbers_of<float>(variable, samples);
    case MAT_C_INT8:
      return numbers_of<std::int8_t>(variable, samples);
    case MAT_C_UINT8:
      return numbers_of<std::uint8_t>(variable, samples);
    case MAT_C_INT16:
      return numbers_of<std::int16_t>(variable, samples);
    case MAT_C_UINT16:
      return numbers_of<std::uint16_t>(variable, samples);
    case MAT_C_INT32:
      return numbers_of<std::int32_t>(variable, samples);
    case MAT_C_UINT32:
      return numbers_of<std::uint32_t>(variable, samples);
    case MAT_C_INT64:
      return numbers_of<std::int64_t>(variable, samples);
    case MAT_C_UINT64:
      return numbers_of<std::uint64_t>(variable, samples);
    default:
      return numbers_of<double>(variable, samples);
  }
}

}  // namespace

struct MatFile::Content {
  std::unique_ptr<mat_t, CloseFile> file;
  std::vector<std::unique_ptr<matvar_t, FreeVariable>> variables;
  std::vector<Leaf> leaves;
};

MatFile::MatFile(std::filesystem::path file, std::unique_ptr<Content> content)
    : file_(std::move(file)), content_(std::move(content)) {
  for (const Leaf& leaf : content_->leaves) entries_.push_back(leaf.entry);
}
MatFile::MatFile(MatFile&&) noexcept = default;
MatFile::~MatFile() = default;

std::string MatFile::place_of(std::size_t) const { return file_.string(); }

Result<MatFile> MatFile::open(const std::filesystem::path& file) {
  const Result<std::size_t> variables = check_mat_file(file);
  if (!variables) return variables.error();
  auto content = std::make_unique<Content>();
  content->file.reset(Mat_Open(file.c_str(), MAT_ACC_RDONLY));
  while (content->file != nullptr && content->variables.size() < *variables) {
    matvar_t* variable = Mat_VarReadNextInfo(content->file.get());
    if (variable == nullptr) break;
    content->variables.emplace_back(variable);
    // Objects of classes have no name of their own that matio would tell.
    if (variable->name != nullptr && *variable->name != '\0') unfold(*variable, variable->name, content->leaves);
  }
  if (content->variables.size() != *variables) {
    return Error{.code = ErrorCode::syntax,
                 .parameter = {},
                 .message = "variable " + std::to_string(content->variables.size() + 1) +
                            " cannot be read; save the file again with '-v7' and without objects of classes",
                 .place = file.string()};
  }
  return MatFile(file, std::move(content));
}

Result<Column> MatFile::read(std::string_view variable, std::int64_t column) const {
  const std::string path = without_needless_index(variable, content_->leaves);
  const Leaf* found = nullptr;
  std::vector<Entry> below;
  for (const Leaf& leaf : content_->leaves) {
    if (leaf.entry.name == path) found = &leaf;
    if (leaf.entry.name.starts_with(path + ".") || leaf.entry.name.starts_with(path + "(")) below.push_back(leaf.entry);
  }
  // Without its unit: `force` of `force_N`.
  std::vector<const Leaf*> without_unit;
  for (const Leaf& leaf : content_->leaves) {
    const NameAndUnit told = split_unit(leaf.entry.name);
    if (!told.unit.empty() && told.name == path) without_unit.push_back(&leaf);
  }
  if (found == nullptr && below.empty() && without_unit.size() == 1) found = without_unit.front();
  if (found == nullptr && !below.empty()) {
    return Error{.code = ErrorCode::wrong_type,
                 .parameter = {},
                 .message = in_quotes(variable) + " of '" + file_.string() +
                            "' is a struct; name one of its fields: " + enumerate_signals(below),
                 .place = {}};
  }
  if (found == nullptr) return no_such_variable(variable, file_, entries_);
  const Entry& entry = found->entry;
  if (!is_real_matrix(*found->variable)) {
    return Error{.code = ErrorCode::wrong_type,
                 .parameter = {},
                 .message = in_quotes(entry.name) + " of '" + file_.string() + "' is of class " + entry.kind +
                            "; a signal is a full vector or matrix of real numbers",
                 .place = {}};
  }
  if (column < 1 || column > entry.columns) {
    return Error{.code = ErrorCode::out_of_bounds,
                 .parameter = "column",
                 .message = std::to_string(column) + " is out of bounds: '" + entry.name + "' of '" + file_.string() +
                            "' has " + std::to_string(entry.columns) + " columns of " + std::to_string(entry.rows) +
                            " samples, counted from 1",
                 .place = {}};
  }
  if (entry.rows < 2) {
    return Error{.code = ErrorCode::missing,
                 .parameter = {},
                 .message = in_quotes(entry.name) + " of '" + file_.string() + "' holds " + std::to_string(entry.rows) +
                            " samples; a signal needs two or more",
                 .place = {}};
  }
  if (entry.rows > static_cast<std::int64_t>(most_samples)) {
    return Error{.code = ErrorCode::out_of_bounds,
                 .parameter = {},
                 .message = in_quotes(entry.name) + " of '" + file_.string() + "' holds " + std::to_string(entry.rows) +
                            " samples, more than the " + std::to_string(most_samples) +
                            " that are read; cut it, or keep fewer samples a second",
                 .place = {}};
  }
  matvar_t& data = *found->variable;
  const bool loaded = data.data != nullptr || Mat_VarReadDataAll(content_->file.get(), &data) == MATIO_E_NO_ERROR;
  if (!loaded || data.data == nullptr ||
      data.nbytes != member_count(data) * Mat_SizeOfClass(static_cast<int>(data.class_type))) {
    return Error{.code = ErrorCode::syntax,
                 .parameter = {},
                 .message = in_quotes(entry.name) + " cannot be read; save the file again with '-v7'",
                 .place = file_.string()};
  }
  const auto rows = static_cast<std::size_t>(entry.rows);
  const auto index = static_cast<std::size_t>(column) - 1;
  const bool in_rows = has_signals_in_rows(data);
  const Samples samples = in_rows ? Samples{.first = index, .count = rows, .stride = data.dims[0]}
                                  : Samples{.first = index * rows, .count = rows, .stride = 1};
  Column result{.values = column_of(data, samples), .name = entry.name, .unit = {}};
  if (in_rows) {
    result.name += "(" + std::to_string(column) + ",:)";
  } else if (entry.columns > 1) {
    result.name += "(:," + std::to_string(column) + ")";
  }
  for (std::size_t i = 0; i < rows; ++i) {
    if (std::fabs(result.values[i]) <= largest_value) continue;
    const bool finite = std::isfinite(result.values[i]);
    return Error{.code = ErrorCode::out_of_bounds,
                 .parameter = {},
                 .message = "sample " + std::to_string(i + 1) + " of '" + result.name + "' is " +
                            (finite ? "beyond 1e30, which is no measurement; correct it or rescale the variable"
                                    : "not finite; fill in the lost sample or cut the recording there"),
                 .place = file_.string()};
  }
  return result;
}

Result<std::vector<Column>> MatFile::read_choice(std::string_view choice) const {
  const auto named = [&](std::string_view name) {
    return std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.name == name; });
  };
  std::string_view name = choice;
  std::int64_t first = 1;
  std::int64_t last = 0;
  auto entry = named(name);
  if (const auto colon = choice.find(':'); entry == entries_.end() && colon != std::string_view::npos) {
    name = choice.substr(0, colon);
    entry = named(name);
    const std::string_view range = choice.substr(colon + 1);
    const char* const end = range.data() + range.size();
    auto read = std::from_chars(range.data(), end, first);
    last = first;
    if (read.ec == std::errc{} && read.ptr != end && *read.ptr == ':') read = std::from_chars(read.ptr + 1, end, last);
    if (read.ec != std::errc{} || read.ptr != end || first < 1 || last < first || last - first > 100) {
      return Error{.code = ErrorCode::syntax,
                   .parameter = {},
                   .message = in_quotes(choice) + " is no range of columns; write NAME:2 or NAME:2:7, counted from 1",
                   .place = {}};
    }
  } else if (entry != entries_.end()) {
    last = std::clamp<std::int64_t>(entry->columns, 1, 100);
  }
  if (entry == entries_.end()) return no_such_variable(name, file_, entries_);
  std::vector<Column> columns;
  for (std::int64_t i = first; i <= last; ++i) {
    Result<Column> column = read(name, i);
    if (!column) return column.error();
    columns.push_back(*std::move(column));
  }
  return columns;
}

Result<Column> MatFile::read_times(std::string_view choice) const {
  Result<Column> times = read(choice, 1);
  if (times || choice.find(':') == std::string_view::npos) return times;
  Result<std::vector<Column>> columns = read_choice(choice);
  if (!columns || columns->size() != 1) return times.error();
  return std::move(columns->front());
}

std::optional<std::string> MatFile::time_beside(std::string_view variable, std::size_t samples) const {
  std::string scope = without_needless_index(variable, content_->leaves);
  while (!scope.empty()) {
    const std::size_t dot = scope.rfind('.');
    scope.resize(dot == std::string::npos ? 0 : dot);
    for (const char* name : {"time", "time_s", "t", "timestamp", "tout"}) {
      const std::string candidate = (scope.empty() ? "" : scope + ".") + name;
      for (const Entry& entry : entries_) {
        if (entry.name == candidate && entry.readable && static_cast<std::size_t>(entry.rows) == samples)
          return candidate;
      }
    }
  }
  return std::nullopt;
}

}  // namespace tactus::recording
