// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/diagnosis/reported_velocity.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tactus::diagnosis {

std::optional<double> reported_scale(std::span<const double> position, std::span<const double> velocity, Seconds dt) {
  constexpr double stretch_s = 0.05, most_left = 0.1;
  const auto stretch = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(stretch_s / dt.value)));
  const std::size_t samples = std::min(position.size(), velocity.size());
  double squares = 0.0, product = 0.0, told_squares = 0.0;
  for (std::size_t from = 0; from + stretch < samples; from += stretch) {
    const double way = position[from + stretch] - position[from];
    double told = 0.5 * (velocity[from] + velocity[from + stretch]);
    for (std::size_t i = from + 1; i < from + stretch; ++i) told += velocity[i];
    told *= dt.value;
    squares += way * way;
    product += told * way;
    told_squares += told * told;
  }
  if (!(squares > 0.0 && told_squares > 0.0)) return std::nullopt;
  const double explained = product * product / (squares * told_squares);
  if (!(explained > 1.0 - most_left)) return std::nullopt;
  return std::fabs(product / squares);
}

}  // namespace tactus::diagnosis
