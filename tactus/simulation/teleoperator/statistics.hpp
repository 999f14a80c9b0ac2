// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <span>

namespace tactus::simulation {

/// The mean of values of which there is at least one.
inline double mean(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// The root of the mean square of values of which there is at least one, measured from `about`.
inline double rms(std::span<const double> values, double about = 0.0) {
  double squares = 0.0;
  for (const double value : values) squares += (value - about) * (value - about);
  return std::sqrt(squares / static_cast<double>(values.size()));
}

}  // namespace tactus::simulation
