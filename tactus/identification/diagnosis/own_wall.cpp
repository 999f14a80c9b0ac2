// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/diagnosis/own_wall.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace tactus::diagnosis {

namespace {

constexpr std::size_t fewest_updates = 30;

double variance_of(const std::vector<double>& values) {
  double sum = 0.0, squares = 0.0;
  for (const double value : values) sum += value, squares += value * value;
  const auto n = static_cast<double>(values.size());
  return std::max(0.0, squares / n - sum * sum / (n * n));
}

/// The samples at which the force changes.
std::vector<std::size_t> changes_of(std::span<const double> force) {
  std::vector<std::size_t> changes;
  for (std::size_t i = 1; i < force.size(); ++i) {
    if (force[i] != force[i - 1]) changes.push_back(i);
  }
  return changes;
}

/// Samples between two updates of a force that is held, 1 where most changes follow each other at once or no length
/// stands out. A controller of another clock than the recorder's makes lengths that differ by one.
std::size_t hold_of(const std::vector<std::size_t>& changes) {
  constexpr double most = 0.8;
  if (changes.size() < fewest_updates) return 1;
  std::vector<std::size_t> lengths;
  for (std::size_t i = 1; i < changes.size(); ++i) lengths.push_back(changes[i] - changes[i - 1]);
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  const std::size_t usual = *middle;
  if (usual < 2) return 1;
  const auto alike = std::count_if(lengths.begin(), lengths.end(), [usual](std::size_t length) {
    const std::size_t rest = length % usual;
    return rest == 0 || (usual > 3 && (rest == 1 || rest + 1 == usual));
  });
  return static_cast<double>(alike) >= most * static_cast<double>(lengths.size()) ? usual : 1;
}

/// Nearly always off or at its largest value, exactly, and often at both. No measured force rests so.
bool is_switched(std::span<const double> force) {
  constexpr double nearly_always = 0.85, often = 0.1;
  const double most = *std::max_element(force.begin(), force.end()), margin = 1e-9 * most;
  const double n = static_cast<double>(force.size());
  const auto off =
      static_cast<double>(std::count_if(force.begin(), force.end(), [=](double f) { return std::abs(f) <= margin; }));
  const auto on =
      static_cast<double>(std::count_if(force.begin(), force.end(), [=](double f) { return f >= most - margin; }));
  return most > 0.0 && off > often * n && on > often * n && off + on > nearly_always * n;
}

/// Share of the variance of `force` that a step at the best place in `position` explains, larger beyond it.
double explained_by_step(const std::vector<double>& force, const std::vector<double>& position) {
  std::vector<std::size_t> order(force.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return position[a] < position[b]; });
  double all = 0.0;
  for (const double f : force) all += f;
  const auto n = static_cast<double>(force.size());
  const double variance = variance_of(force);
  double below = 0.0, best = 0.0;
  for (std::size_t k = 1; k < order.size(); ++k) {
    below += force[order[k - 1]];
    if (position[order[k]] == position[order[k - 1]]) continue;
    const double low = static_cast<double>(k), high = n - low;
    const double rise = (all - below) / high - below / low;
    if (rise > 0.0) best = std::max(best, low * high * rise * rise / (n * n));
  }
  return best / variance;
}

/// The same of a spring with damping that pushes back from a position on, no further than the largest force, and gives
/// `rest` before it.
double explained_by_spring(const std::vector<double>& force, const std::vector<double>& position) {
  const auto [least, most] = std::minmax_element(force.begin(), force.end());
  const double rest = *least, limit = *most, margin = 0.02 * (limit - rest);
  double n = 0, sx = 0, sf = 0, sxx = 0, sxf = 0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    if (force[i] < rest + margin || force[i] > limit - margin) continue;
    n += 1.0, sx += position[i], sf += force[i], sxx += position[i] * position[i], sxf += position[i] * force[i];
  }
  if (n < static_cast<double>(fewest_updates) / 2.0) return 0.0;
  const double spread = sxx - sx * sx / n;
  if (!(spread > 0.0)) return 0.0;
  const double stiffness = (sxf - sx * sf / n) / spread;
  if (!(stiffness > 0.0)) return 0.0;
  const double offset = (sf - stiffness * sx) / n;
  double left = 0.0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    const double error = force[i] - std::clamp(offset + stiffness * position[i], rest, limit);
    left += error * error;
  }
  return std::max(0.0, 1.0 - left / static_cast<double>(force.size()) / variance_of(force));
}

}  // namespace

std::optional<OwnWall> find_own_wall(std::span<const double> force, std::span<const double> position,
                                     double frequency_Hz, Seconds dt) {
  constexpr double longest_delay_s = 0.02, part_of_period = 1.0 / 6.0;
  // A wall pushes back and never pulls.
  constexpr double hardly = 0.05;
  const auto [least, most] = std::minmax_element(force.begin(), force.end());
  if (!(*most > 0.0) || *least < -hardly * *most) return OwnWall{};
  const std::vector<std::size_t> changes = changes_of(force);
  if (changes.size() < fewest_updates / 2) return std::nullopt;
  OwnWall wall{.switched = is_switched(force)};
  const std::size_t hold = wall.switched ? 1 : hold_of(changes);
  if (hold > 1) wall.held_s = static_cast<double>(hold) * dt.value;
  const auto latest = std::max<std::size_t>(
      1, static_cast<std::size_t>(std::min(longest_delay_s, part_of_period / frequency_Hz) / dt.value));
  std::vector<std::size_t> updates;
  // Of a force that is held each new value, else every sample.
  for (std::size_t i = latest; i < force.size(); ++i) {
    if (hold == 1 || force[i] != force[i - 1] || i == latest || i - updates.back() >= hold) updates.push_back(i);
  }
  if (updates.size() < fewest_updates) return std::nullopt;
  std::vector<double> f, x(updates.size());
  for (const std::size_t i : updates) f.push_back(force[i]);
  if (!(variance_of(f) > 0.0)) return std::nullopt;
  for (std::size_t late = 0; late <= latest; ++late) {
    for (std::size_t k = 0; k < updates.size(); ++k) x[k] = position[updates[k] - late];
    const double explained = wall.switched ? explained_by_step(f, x) : explained_by_spring(f, x);
    if (explained > wall.explained + 1e-4)
      wall.explained = explained, wall.delay_s = static_cast<double>(late) * dt.value;
  }
  return wall;
}

}  // namespace tactus::diagnosis
