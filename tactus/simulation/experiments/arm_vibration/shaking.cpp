// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/root_mean_square.hpp>
#include <tactus/simulation/experiments/arm_vibration/shaking.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <vector>

namespace tactus::experiments {
namespace {

/// What is left of values about their mean over a quarter of a second around each, where there is so much around it.
std::vector<double> fast_part(std::span<const double> values, double rate_Hz) {
  constexpr double half_s = 0.125;
  const auto half = static_cast<std::size_t>(std::lround(half_s * rate_Hz));
  std::vector<double> sums{0.0};
  for (const double value : values) sums.push_back(sums.back() + value);
  std::vector<double> left;
  for (std::size_t i = half; i + half < values.size(); ++i) {
    left.push_back(values[i] - (sums[i + half + 1] - sums[i - half]) / static_cast<double>(2 * half + 1));
  }
  return left;
}

/// Under a Hann window.
std::vector<double> windowed(std::vector<double> values) {
  const double window = 2.0 * std::numbers::pi / static_cast<double>(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) values[i] *= 1.0 - std::cos(window * (static_cast<double>(i) + 0.5));
  return values;
}

double power_at(const std::vector<double>& values, double frequency_Hz, double rate_Hz) {
  const double turn = 2.0 * std::numbers::pi * frequency_Hz / rate_Hz;
  std::complex<double> sum = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) sum += values[i] * std::polar(1.0, -turn * static_cast<double>(i));
  return std::norm(sum);
}

}  // namespace

Shaking shaking_of(std::span<const double> position_rad, std::span<const double> velocity_rad_per_s, double rate_Hz) {
  constexpr double lowest_Hz = 2.0, highest_Hz = 200.0, step_Hz = 0.25;
  const std::vector<double> velocity = fast_part(velocity_rad_per_s, rate_Hz);
  const std::vector<double> position = fast_part(position_rad, rate_Hz);
  Shaking found{.rms_rad_per_s = signal::root_mean_square(velocity)};
  const auto [least, most] = std::minmax_element(position.begin(), position.end());
  found.amplitude_rad = 0.5 * (*most - *least);
  const std::vector<double> in_window = windowed(velocity);
  double strongest = 0.0;
  for (double frequency_Hz = lowest_Hz; frequency_Hz <= highest_Hz; frequency_Hz += step_Hz) {
    const double power = power_at(in_window, frequency_Hz, rate_Hz);
    if (!(power > strongest)) continue;
    strongest = power;
    found.frequency_Hz = frequency_Hz;
  }
  return found;
}

double shaking_rms_of(std::span<const double> velocity_rad_per_s, double rate_Hz) {
  return signal::root_mean_square(fast_part(velocity_rad_per_s, rate_Hz));
}

}  // namespace tactus::experiments
