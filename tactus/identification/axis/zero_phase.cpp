// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/zero_phase.hpp>
#include <tactus/kernel/signal/second_order_filter.hpp>

#include <algorithm>
#include <cmath>

namespace tactus::identification {

Result<std::vector<double>> zero_phase_low_pass(std::span<const double> samples, double cutoff_Hz, Seconds dt) {
  if (samples.size() < 2) {
    return Error{ErrorCode::inconsistent, {}, "a filter over a recording needs at least two samples", {}};
  }
  auto filter = signal::SecondOrderFilter::make({.kind = signal::FilterKind::low_pass, .frequency_Hz = cutoff_Hz}, dt);
  if (!filter) return filter.error();
  const std::size_t count = samples.size();
  const double wanted = std::ceil(1.5 / (cutoff_Hz * dt.value));
  const std::size_t pad = wanted < static_cast<double>(count - 1) ? static_cast<std::size_t>(wanted) : count - 1;
  std::vector<double> all;
  all.reserve(count + 2 * pad);
  for (std::size_t i = pad; i > 0; --i) all.push_back(2.0 * samples.front() - samples[i]);
  all.insert(all.end(), samples.begin(), samples.end());
  for (std::size_t i = 1; i <= pad; ++i) all.push_back(2.0 * samples.back() - samples[count - 1 - i]);
  for (int pass = 0; pass < 2; ++pass) {
    filter->settle(all.front());
    for (double& value : all) value = filter->step(value);
    std::reverse(all.begin(), all.end());
  }
  const auto first = all.begin() + static_cast<std::ptrdiff_t>(pad);
  return std::vector<double>(first, first + static_cast<std::ptrdiff_t>(count));
}

std::vector<double> central_difference(std::span<const double> samples, Seconds dt) {
  const std::size_t last = samples.size() - 1;
  std::vector<double> slope(samples.size());
  for (std::size_t i = 0; i <= last; ++i) {
    const std::size_t before = i == 0 ? 0 : i - 1;
    const std::size_t after = i == last ? last : i + 1;
    slope[i] = (samples[after] - samples[before]) / (static_cast<double>(after - before) * dt.value);
  }
  return slope;
}

}  // namespace tactus::identification
