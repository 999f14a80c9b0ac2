// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/gain_limit.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactus::experiments {

GainLimit find_gain_limit(double lowest, double highest, const std::function<bool(double gain)>& settles,
                          double resolution) {
  double settled = std::clamp(1.0, lowest, highest);
  double failed = settled;
  if (settles(settled)) {
    while (failed <= settled) {
      if (settled == highest) return {.gain = highest, .beyond_search = true};
      const double next = std::min(settled * std::numbers::sqrt2, highest);
      (settles(next) ? settled : failed) = next;
    }
  } else {
    while (failed <= settled) {
      if (failed == lowest) return {};
      const double next = std::max(failed / std::numbers::sqrt2, lowest);
      (settles(next) ? settled : failed) = next;
    }
  }
  while (failed > settled * resolution) {
    const double middle = std::sqrt(settled * failed);
    (settles(middle) ? settled : failed) = middle;
  }
  return {.gain = settled};
}

}  // namespace tactus::experiments
