// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <variant>

namespace tactus::configuration {

/// Line and column of a document, counted from 1.
struct Position {
  std::uint32_t line = 0;
  std::uint32_t column = 0;
  auto operator<=>(const Position&) const = default;
};

/// A section of a document.
struct Table {};

/// A TOML value of a kind that no parameter has: an array, a date, a time.
struct Foreign {
  const char* kind;
};

using Value = std::variant<Table, bool, std::int64_t, double, std::string, Foreign>;

/// One key of a document with what was written for it. Parts of the path that are no bare TOML keys are in quotes, so
/// that a quoted key with a dot in it is not mistaken for a key within a section.
struct Entry {
  std::string path;
  Value value;
  Position key_position;
  Position value_position;
  std::string assignment;  ///< `control.force_gain=3` when this is an override, else empty
  std::string typed;       ///< the right side of the assignment as it was typed
  std::string file;        ///< the name of the document that it was merged from, else empty
};

}  // namespace tactus::configuration
