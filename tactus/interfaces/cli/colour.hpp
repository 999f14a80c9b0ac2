// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace tactus::cli {

/// Whether what a descriptor leads to shows colour: a terminal that is not dumb, where `NO_COLOR` is unset or empty.
bool shows_colour(int descriptor);

/// Gives lines for a user colour, one after the other: verdicts in the rows of tables, and the name of the program
/// that is before an error.
class Painter {
 public:
  /// `name` is that of the program in front of errors.
  explicit Painter(std::string name) : name_(std::move(name)) {}
  /// A line without its end.
  std::string paint(std::string_view line);

 private:
  std::string name_;
  int rules_ = 0;  ///< of the table that is being printed: rows are behind the second
};

}  // namespace tactus::cli
