// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/force_comparison.hpp>
#include <tactus/identification/axis/zero_phase.hpp>

#include <algorithm>
#include <cmath>

namespace tactus::identification {
namespace {

double correlation_of(std::span<const double> a, std::span<const double> b) {
  double mean_a = 0.0;
  double mean_b = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    mean_a += a[i];
    mean_b += b[i];
  }
  mean_a /= static_cast<double>(a.size());
  mean_b /= static_cast<double>(a.size());
  double ab = 0.0;
  double aa = 0.0;
  double bb = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += (a[i] - mean_a) * (b[i] - mean_b);
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
  }
  return ab / std::sqrt(aa * bb);
}

double lead_of(std::span<const double> estimate, std::span<const double> reference, Seconds dt) {
  const std::size_t reach =
      std::min({static_cast<std::size_t>(std::ceil(0.05 / dt.value)), estimate.size() / 4, std::size_t{1000}});
  const std::size_t length = estimate.size() - 2 * reach;
  std::vector<double> at(2 * reach + 1);
  for (std::size_t k = 0; k < at.size(); ++k) {
    at[k] = correlation_of(estimate.subspan(reach, length), reference.subspan(k, length));
  }
  const auto best = static_cast<std::size_t>(std::max_element(at.begin(), at.end()) - at.begin());
  double shift = static_cast<double>(best) - static_cast<double>(reach);
  if (best > 0 && best + 1 < at.size()) {
    const double curve = at[best - 1] - 2.0 * at[best] + at[best + 1];
    if (curve < 0.0) shift += 0.5 * (at[best - 1] - at[best + 1]) / curve;
  }
  return shift * dt.value;
}

}  // namespace

Result<ForceComparison> compare_force(std::span<const double> estimate, std::span<const double> measured,
                                      double cutoff_Hz, Seconds dt, std::size_t skip) {
  if (estimate.size() != measured.size() || estimate.size() < skip + 200) {
    return Error{ErrorCode::inconsistent,
                 {},
                 "an estimate is compared with a measurement of as many samples, at least 200 after the first ones",
                 {}};
  }
  auto reference = zero_phase_low_pass(measured, std::min(cutoff_Hz, 0.4 / dt.value), dt);
  if (!reference) return reference.error();
  ForceComparison result;
  result.reference = *std::move(reference);
  const auto left = estimate.subspan(skip);
  const auto right = std::span<const double>(result.reference).subspan(skip);
  for (std::size_t i = 0; i < left.size(); ++i) {
    result.rmse += (left[i] - right[i]) * (left[i] - right[i]);
    result.mean_error += left[i] - right[i];
  }
  result.rmse = std::sqrt(result.rmse / static_cast<double>(left.size()));
  result.mean_error /= static_cast<double>(left.size());
  result.correlation = correlation_of(left, right);
  result.lead_s = lead_of(left, right, dt);
  return result;
}

Result<FalseForce> false_force(std::span<const double> estimate, std::span<const double> reference,
                               std::span<const double> position, double friction, Seconds dt, std::size_t skip) {
  const auto smooth = zero_phase_low_pass(position, std::min(30.0, 0.1 / dt.value), dt);
  if (!smooth) return smooth.error();
  const auto velocity = central_difference(*smooth, dt);
  double greatest_force = 0.0;
  double fastest = 0.0;
  for (std::size_t i = skip; i < estimate.size(); ++i) {
    greatest_force = std::max(greatest_force, std::abs(reference[i]));
    fastest = std::max(fastest, std::abs(velocity[i]));
  }
  const double small = std::max(0.1 * greatest_force, 1.5 * friction);
  double squares = 0.0;
  std::size_t samples = 0;
  for (std::size_t i = skip; i < estimate.size(); ++i) {
    if (std::abs(reference[i]) > small || std::abs(velocity[i]) < 0.05 * fastest) continue;
    squares += estimate[i] * estimate[i];
    ++samples;
  }
  if (samples == 0) return FalseForce{};
  return FalseForce{.rms = std::sqrt(squares / static_cast<double>(samples)),
                    .duration_s = static_cast<double>(samples) * dt.value};
}

}  // namespace tactus::identification
