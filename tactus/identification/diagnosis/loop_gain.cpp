// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/diagnosis/loop_gain.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace tactus::diagnosis {

namespace {

constexpr std::size_t jackknife_blocks = 8;
constexpr double student_95 = 2.365;  ///< two-sided, seven degrees of freedom
constexpr double largest_gain = 1e3;

}  // namespace

double describing_gain(double below, double above) {
  constexpr double pi = std::numbers::pi;
  const double from = -0.5 * pi + pi * std::clamp(below, 0.0, 1.0);
  const double to = 0.5 * pi - pi * std::clamp(above, 0.0, 1.0);
  if (to <= from) return 0.0;
  const auto integral = [](double angle) { return 0.5 * angle + 0.25 * std::sin(2.0 * angle); };
  return 2.0 / pi * (integral(to) - integral(from));
}

std::optional<identification::Estimate> loop_gain(std::span<const double> force, bool one_sided) {
  constexpr double near_end = 0.02, rarely = 0.03;
  if (force.size() < 10 * jackknife_blocks) return std::nullopt;
  const auto [least, most] = std::minmax_element(force.begin(), force.end());
  const double range = *most - *least;
  if (!(range > 0.0)) return std::nullopt;
  const double lower = (one_sided ? 0.0 : *least) + near_end * range, upper = *most - near_end * range;
  std::array<double, jackknife_blocks> below{}, above{};
  const std::size_t size = force.size() / jackknife_blocks;
  for (std::size_t b = 0; b < jackknife_blocks; ++b) {
    const auto from = force.begin() + static_cast<std::ptrdiff_t>(b * size);
    const auto to = from + static_cast<std::ptrdiff_t>(size);
    below[b] =
        static_cast<double>(std::count_if(from, to, [=](double f) { return f <= lower; })) / static_cast<double>(size);
    above[b] =
        static_cast<double>(std::count_if(from, to, [=](double f) { return f >= upper; })) / static_cast<double>(size);
  }
  const auto without = [&](std::size_t left_out) {
    double low = 0.0, high = 0.0, count = 0.0;
    for (std::size_t b = 0; b < jackknife_blocks; ++b) {
      if (b == left_out) continue;
      low += below[b], high += above[b], count += 1.0;
    }
    low /= count, high /= count;
    return std::log(std::min(
        largest_gain,
        1.0 / std::max(describing_gain(low < rarely ? 0.0 : low, high < rarely ? 0.0 : high), 1.0 / largest_gain)));
  };
  const double whole = without(jackknife_blocks);
  if (whole < 1e-9) return std::nullopt;
  double mean = 0.0, square = 0.0;
  for (std::size_t b = 0; b < jackknife_blocks; ++b) mean += without(b) / static_cast<double>(jackknife_blocks);
  for (std::size_t b = 0; b < jackknife_blocks; ++b) square += (without(b) - mean) * (without(b) - mean);
  const double half = student_95 * std::sqrt(square * (jackknife_blocks - 1.0) / static_cast<double>(jackknife_blocks));
  return identification::Estimate{
      .value = std::exp(whole), .lower = std::max(1.0, std::exp(whole - half)), .upper = std::exp(whole + half)};
}

}  // namespace tactus::diagnosis
