// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/contest/spectral_error.hpp>

#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <vector>

namespace tactus::experiments {

namespace {

std::vector<double> windowed(std::span<const double> signal) {
  std::vector<double> result(signal.begin(), signal.end());
  const auto edge = static_cast<std::size_t>(edge_share * static_cast<double>(signal.size()));
  for (std::size_t i = 0; i < edge; ++i) {
    const double weight = 0.5 - 0.5 * std::cos(std::numbers::pi * static_cast<double>(i) / static_cast<double>(edge));
    result[i] *= weight;
    result[result.size() - 1 - i] *= weight;
  }
  return result;
}

/// |Σ x_k z⁻ᵏ| by Horner's rule, with z on the unit circle.
double magnitude_at(const std::vector<double>& signal, double radians_per_sample) {
  const std::complex<double> rotation = std::polar(1.0, radians_per_sample);
  std::complex<double> sum = 0.0;
  for (const double value : signal) sum = sum * rotation + value;
  return std::abs(sum);
}

}  // namespace

std::optional<double> spectral_error(std::span<const double> wanted, std::span<const double> arrived,
                                     double sample_time_s, double lower_Hz, double upper_Hz) {
  const std::vector<double> w = windowed(wanted);
  const std::vector<double> y = windowed(arrived);
  const double step_Hz = 1.0 / (sample_time_s * static_cast<double>(w.size()));
  double difference = 0.0;
  double reference = 0.0;
  for (auto bin = static_cast<std::int64_t>(std::ceil(lower_Hz / step_Hz));
       static_cast<double>(bin) * step_Hz <= upper_Hz; ++bin) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(bin) * step_Hz * sample_time_s;
    const double wanted_magnitude = magnitude_at(w, angle);
    difference += std::pow(magnitude_at(y, angle) - wanted_magnitude, 2);
    reference += wanted_magnitude * wanted_magnitude;
  }
  if (reference == 0.0) return std::nullopt;
  return std::sqrt(difference / reference);
}

}  // namespace tactus::experiments
