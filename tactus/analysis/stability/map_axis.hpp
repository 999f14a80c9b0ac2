// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/map_point.hpp>
#include <tactus/kernel/core/binding.hpp>
#include <tactus/kernel/core/result.hpp>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tactus::stability {

/// One axis of a map: a described key and the values that it takes.
struct MapAxis {
  std::string key;
  std::string unit;                ///< symbol, or empty
  std::vector<double> values;      ///< of a number, ascending; 0, 1, 2, … for words
  std::vector<std::string> words;  ///< of a choice, else empty
  bool logarithmic = false;
};

/// Reads `key=from:to:count`, `key=from:to:count[log]`, `key=a,b,c` for a number, or `key=word,word` for a choice.
///
/// Errors, each with the option as its place: `syntax`; `unknown_key` for a key that a map has not; `wrong_type` for
/// one that is not a number and no choice; `inconsistent` for a key that all points must share (clocks, the task's
/// times) and for more than a million values; `out_of_bounds` for an end beyond the key's bounds.
Result<MapAxis> parse_axis(std::string_view text);

/// Parameters at the points of a grid, one after the other without reading keys again.
class PointParams {
 public:
  PointParams(const MapParams& base, const std::vector<MapAxis>& axes);
  // What it holds points into itself.
  PointParams(const PointParams&) = delete;
  PointParams& operator=(const PointParams&) = delete;

  /// The parameters at a point, row-major in the axes. Good until the next call.
  const MapParams& at(std::size_t point);

 private:
  MapParams params_;
  const std::vector<MapAxis>& axes_;
  std::vector<Binding> bindings_;  ///< one for each axis
};

}  // namespace tactus::stability
