// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/random.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <bench/impact_forces.hpp>

namespace tactus::bench {

std::vector<double> impact_forces() {
  constexpr std::size_t ticks = 5000, ticks_in_contact = 300, ticks_of_tap = 500;
  signal::Random draw(1);
  const auto between = [&draw](double lower, double upper) { return lower + (upper - lower) * draw.uniform(); };
  std::vector<double> forces_N(ticks, 0.0);
  for (std::size_t start = 50; start + ticks_of_tap <= ticks; start += ticks_of_tap) {
    const double ringing_N = between(0.2, 1.2), leaning_N = between(0.1, 0.5);
    const double frequency_Hz = between(100.0, 200.0), decay_s = between(0.01, 0.03);
    for (std::size_t i = 0; i < ticks_in_contact; ++i) {
      const double time_s = static_cast<double>(i) * tick_s;
      const double ring = std::exp(-time_s / decay_s) * std::sin(2.0 * std::numbers::pi * frequency_Hz * time_s);
      forces_N[start + i] = std::clamp(leaning_N * (1.0 - std::exp(-time_s / 0.01)) + ringing_N * ring, 0.0, 1.0);
    }
  }
  return forces_N;
}

}  // namespace tactus::bench
