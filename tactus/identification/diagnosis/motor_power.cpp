// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/diagnosis/line.hpp>
#include <tactus/identification/diagnosis/motor_power.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace tactus::diagnosis {

std::optional<double> motor_phase_deg(const Signals& signals) {
  constexpr double slow_Hz = 6.0;  // `without_slow` leaves what is faster than about half of it
  constexpr double least_explained = 0.5;
  const Channel* follower = signals.find(Role::slave_position);
  const Channel* motor = signals.find(Role::slave_force);
  if (follower == nullptr || motor == nullptr || follower->constant() || motor->constant()) return std::nullopt;
  const auto slow = [&](const std::vector<double>& values) {
    std::vector<double> result = without_slow(values, slow_Hz, signals.sample_time);
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = values[i] - result[i];
    return result;
  };
  const std::vector<double> at = slow(follower->values), force = slow(motor->values);
  double mean = 0.0;
  for (const double f : force) mean += f / static_cast<double>(force.size());
  // Differences over a twentieth of a second, in units of their own size.
  const auto over = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(0.05 / signals.sample_time.value)));
  double vv = 0.0, aa = 0.0, va = 0.0, ff = 0.0, fv = 0.0, fa = 0.0;
  for (std::size_t i = over; i + over < at.size(); ++i) {
    const double f = force[i] - mean, v = at[i + over] - at[i - over];
    const double a = at[i + over] - 2.0 * at[i] + at[i - over];
    vv += v * v, aa += a * a, va += v * a, ff += f * f, fv += f * v, fa += f * a;
  }
  const double determinant = vv * aa - va * va;
  if (!(ff > 0.0) || !(determinant > 1e-9 * vv * aa)) return std::nullopt;
  const double damping = (fv * aa - fa * va) / determinant, inertia = (fa * vv - fv * va) / determinant;
  if (damping * fv + inertia * fa < least_explained * ff) return std::nullopt;
  const double degrees = std::atan2(inertia * std::sqrt(aa), damping * std::sqrt(vv)) * 180.0 / std::numbers::pi;
  return degrees < -90.0 ? degrees + 360.0 : degrees;
}

}  // namespace tactus::diagnosis
