// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/recording/recording.hpp>

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tactus::recording {

/// The name and the unit in the head of a column: `force [N]`, `force (Newton)` and `force_N` all give `force` and `N`.
/// The unit is empty where none is stated, and has the spelling of this project where it is known (`N m` for `Nm`).
///
/// A number in brackets is an index and belongs to the name (`q[0]`); so does a word that describes, as in
/// `force (filtered)`. A suffix of one letter is a unit only where it fits the quantity: `x_m` is in metres, but `x_s`,
/// `F_m` and `tau_J` have names of their own.
struct NameAndUnit {
  std::string name;
  std::string unit;
};
NameAndUnit split_unit(std::string_view head);

/// The same of all columns of a table. Where its names distinguish master and slave by `_m` and `_s`, as in `x_m` and
/// `x_s`, neither is a unit.
std::vector<NameAndUnit> split_units(std::span<const std::string> heads);

/// `text` in single quotes.
std::string in_quotes(std::string_view text);

/// A number rounded to so many significant digits, for a message: `0.005`, `1700000`, `3.5e+09`.
std::string significant(double value, int digits = 3);

/// `text` without blanks at either end.
std::string_view trim(std::string_view text);

/// The readable candidate that `name` was probably meant to be, or empty when none is near.
std::string nearest(std::string_view name, std::span<const Entry> candidates);

/// The error for a name that a file does not hold: the nearest name, and what the file has.
Error no_such_variable(std::string_view name, const std::filesystem::path& file, std::span<const Entry> entries);

/// The first readable entries as a list: `'force' in N, 'time' in s`, `'scope.time' (9416 x 1 double) and 12 more`.
std::string enumerate_signals(std::span<const Entry> entries);

}  // namespace tactus::recording
