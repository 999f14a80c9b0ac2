// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/teleoperator/quantile.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tactus::simulation {

double quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  const double position = q * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(std::floor(position));
  const auto above = std::min(below + 1, values.size() - 1);
  return values[below] + (position - std::floor(position)) * (values[above] - values[below]);
}

}  // namespace tactus::simulation
