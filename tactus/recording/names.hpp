#pragma once

#include <tactus/recording/recording.hpp>

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tactus::recording {

/// The name and the unit in the head of a column: `force [N]`, `force (N)` and `force_N` all give `force` and `N`. The
/// unit is empty where none is stated. A suffix counts as a unit if it is one of the suffixes that this project writes.
struct NameAndUnit {
  std::string name;
  std::string unit;
};
NameAndUnit split_unit(std::string_view head);

/// `text` in single quotes.
std::string in_quotes(std::string_view text);

/// `text` without blanks at either end.
std::string_view trim(std::string_view text);

/// The readable candidate that `name` was probably meant to be, or empty when none is near.
std::string nearest(std::string_view name, std::span<const Entry> candidates);

/// The error for a name that a file does not hold: the nearest name, and what the file has.
Error no_such_variable(std::string_view name, const std::filesystem::path& file, std::span<const Entry> entries);

/// The first readable entries as a list: `'force' in N, 'time' in s`, `'scope.time' (9416 x 1 double) and 12 more`.
std::string enumerate_signals(std::span<const Entry> entries);

}  // namespace tactus::recording
