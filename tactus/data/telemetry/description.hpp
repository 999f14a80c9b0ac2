// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/core/signals.hpp>

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// From described records to bytes that other programs read, and back.
namespace tactus::telemetry {

enum class SignalType { float64, int64, boolean };

/// One signal as a log carries it.
struct Column {
  std::string name;  ///< as in the record, with the suffix of its unit: `displayed_force_N`
  std::string unit;  ///< `N`, or empty
  SignalType type = SignalType::float64;
  std::string site = {};
  std::string frame = {};
  std::string sign = {};
  std::string doc = {};
  bool operator==(const Column&) const = default;
};

/// The name of a signal in a message definition: ROS 2 allows lower case only.
std::string ros_name(std::string_view name);

/// The definition of a message as ROS 2 writes it in a `.msg` file (schema encoding `ros2msg`), a comment with unit,
/// site, frame and sign before each member.
std::string ros2msg(const std::vector<Column>& columns);

/// The content of a definition's comments, in a form for machines: name, unit, site, frame, sign and meaning of each
/// member, as metadata of a channel. The inverse, together with a definition, is `columns_of`.
std::map<std::string, std::string> column_metadata(const std::vector<Column>& columns);

/// Columns from a definition and a channel's metadata; a member that the metadata does not know keeps its own name and
/// the unit that the name's suffix states. Errors: `syntax` for a definition that holds anything but `float64`, `int64`
/// and `bool` members, or more than 4096 of them.
Result<std::vector<Column>> columns_of(std::string_view definition, const std::map<std::string, std::string>& metadata);

/// The same signal of a joint that turns: what is in m, m/s, N, N/m or N s/m is in rad, rad/s, N m, N m/rad or
/// N m s/rad, and its name ends so; a force is called a torque (`drive_force_N` is `drive_torque_N_m`). Other columns
/// stay.
Column of_turning_joint(Column column);

/// The name without the end that states its unit: `displayed_force` of `displayed_force_N`. All of it where it has
/// none.
std::string name_without_unit(const Column& column);

/// What the values of a column of codes mean (`0 configure, 1 align`), from its meaning: words of the codes, the first
/// of `first` and each of the next. Empty for a column of anything else.
struct CodeWords {
  std::int64_t first = 0;
  std::vector<std::string> words = {};
  /// The word of a value; empty if the value has no word.
  [[nodiscard]] std::string_view of(double value) const;
};
CodeWords code_words(const Column& column);

/// The columns of a record type.
template <Recordable Record>
std::vector<Column> columns_of() {
  std::vector<Column> columns;
  for_each_signal<Record>([&columns](const auto& signal) {
    using Value = typename std::remove_cvref_t<decltype(signal)>::value_type;
    const SignalType type = std::is_same_v<Value, double> ? SignalType::float64
                            : std::is_same_v<Value, bool> ? SignalType::boolean
                                                          : SignalType::int64;
    columns.push_back({signal.name, signal.unit.symbol, type, signal.site, signal.frame, signal.sign, signal.doc});
  });
  return columns;
}

}  // namespace tactus::telemetry
