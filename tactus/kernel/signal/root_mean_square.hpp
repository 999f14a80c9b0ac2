// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <span>

namespace tactus::signal {

/// √(mean of squares), in the unit of the values; 0 of none.
inline double root_mean_square(std::span<const double> values) noexcept {
  double squares = 0.0;
  for (const double value : values) squares += value * value;
  return values.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(values.size()));
}

}  // namespace tactus::signal
