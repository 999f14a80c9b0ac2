// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/diagnosis/evidence.hpp>
#include <tactus/identification/diagnosis/line.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactus::diagnosis {

namespace {

using Blocks = std::array<std::vector<Complex>, role_count>;

/// The median of the peak-to-peak motion within a period and a quarter, its straight line taken off, in steps.
double steps_within_a_period(std::span<const double> values, double frequency_Hz, double step, Seconds dt) {
  const auto window = std::max<std::size_t>(4, static_cast<std::size_t>(1.25 / (frequency_Hz * dt.value)));
  const std::vector<double> fast = without_slow(values, frequency_Hz, dt);
  std::vector<double> heights;
  for (std::size_t first = 0; first + window <= fast.size(); first += window) {
    const auto from = fast.begin() + static_cast<std::ptrdiff_t>(first);
    const auto [least, most] = std::minmax_element(from, from + static_cast<std::ptrdiff_t>(window));
    heights.push_back(*most - *least);
  }
  if (heights.empty()) return 0.0;
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  return *middle / step;
}

/// Steps up and steps down, whichever are fewer, in a period: about one for each count that is crossed to and fro, and
/// none for a slow motion through counts.
double turns_within_a_period(std::span<const double> values, double frequency_Hz, double step, Seconds dt) {
  double up = 0.0, down = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double moved = values[i] - values[i - 1];
    if (moved > 0.5 * step) up += 1.0;
    if (moved < -0.5 * step) down += 1.0;
  }
  return std::min(up, down) / std::max(1.0, static_cast<double>(values.size()) * dt.value * frequency_Hz);
}

/// Share of the time in which something hardly moves.
double share_of_standstill(std::span<const double> values, double frequency_Hz, double step, Seconds dt) {
  const auto over = std::max<std::size_t>(1, static_cast<std::size_t>(std::llround(0.04 / (frequency_Hz * dt.value))));
  if (values.size() < 4 * over) return 0.0;
  std::vector<double> moved;
  for (std::size_t i = over; i < values.size(); ++i) moved.push_back(std::abs(values[i] - values[i - over]));
  std::vector<double> sorted = moved;
  const auto fast = sorted.begin() + static_cast<std::ptrdiff_t>(0.97 * static_cast<double>(sorted.size()));
  std::nth_element(sorted.begin(), fast, sorted.end());
  const double slow = std::max(0.1 * *fast, 1.01 * step);
  if (*fast <= 2.0 * slow) return 0.0;
  const auto standing = std::count_if(moved.begin(), moved.end(), [slow](double m) { return m <= slow; });
  return static_cast<double>(standing) / static_cast<double>(moved.size());
}

/// The envelope's deviation from its own straight line, over its mean.
double wander_of(std::span<const double> values, double frequency_Hz, Seconds dt) {
  const std::vector<Complex> line = demodulate(values, frequency_Hz, dt);
  const std::size_t edge = line.size() / 10;
  double n = 0, st = 0, sy = 0, stt = 0, sty = 0, syy = 0;
  for (std::size_t i = edge; i + edge < line.size(); ++i) {
    const double t = static_cast<double>(i), y = std::abs(line[i]);
    n += 1.0, st += t, sy += y, stt += t * t, sty += t * y, syy += y * y;
  }
  if (n < 4.0) return 0.0;
  const double vt = stt / n - st * st / (n * n), vty = sty / n - st * sy / (n * n), vy = syy / n - sy * sy / (n * n);
  return std::sqrt(std::max(0.0, vy - vty * vty / vt)) / (sy / n);
}

/// Share of the power above half of the frequency that is in the line: the median over stretches of six periods, so
/// that a few in which something else moved change little.
double share_of_line(std::span<const double> values, double frequency_Hz, Seconds dt) {
  const auto stretch = std::max<std::size_t>(8, static_cast<std::size_t>(6.0 / (frequency_Hz * dt.value)));
  const std::vector<Complex> line = demodulate(values, frequency_Hz, dt);
  const std::vector<double> fast = without_slow(values, frequency_Hz, dt);
  std::vector<double> shares;
  for (std::size_t first = 0; first + stretch <= line.size(); first += stretch) {
    double in_line = 0.0, all = 0.0;
    for (std::size_t i = first; i < first + stretch; ++i) {
      in_line += 0.5 * std::norm(line[i]);
      all += fast[i] * fast[i];
    }
    shares.push_back(all > 0.0 ? std::min(1.0, in_line / all) : 0.0);
  }
  if (shares.empty()) return 0.0;
  const auto middle = shares.begin() + static_cast<std::ptrdiff_t>(shares.size() / 2);
  std::nth_element(shares.begin(), middle, shares.end());
  return *middle;
}

/// Speed of what is slower than half of the frequency: the median from `to` on over the root mean square from `from` to
/// `to`.
double slow_motion_after(std::span<const double> values, std::size_t from, std::size_t to, double frequency_Hz,
                         Seconds dt) {
  const std::vector<double> fast = without_slow(values, frequency_Hz, dt);
  const auto moved = [&](std::size_t i) { return std::abs((values[i] - fast[i]) - (values[i - 1] - fast[i - 1])); };
  double during = 0.0;
  for (std::size_t i = from + 1; i < to; ++i) during += moved(i) * moved(i) / static_cast<double>(to - from);
  if (!(during > 0.0)) return 1.0;
  std::vector<double> after;
  for (std::size_t i = to + 1; i < values.size(); ++i) after.push_back(moved(i));
  const auto middle = after.begin() + static_cast<std::ptrdiff_t>(after.size() / 2);
  std::nth_element(after.begin(), middle, after.end());
  return *middle / std::sqrt(during);
}

/// What the coherence of so many blocks is beyond that of two signals that have nothing in common.
double beyond_chance(double coherence, std::size_t blocks) {
  if (blocks < 2) return coherence;
  const auto n = static_cast<double>(blocks);
  return std::max(0.0, (n * coherence - 1.0) / (n - 1.0));
}

/// Cosine of the angle between a force and the velocity that belongs to a position; 0 for a force that is less than the
/// steps of its column tell.
double gives(const std::vector<Complex>& force, double sign, double step, const std::vector<Complex>& position) {
  if (usual_size(force) < step) return 0.0;
  std::vector<Complex> velocity(position.size());
  std::transform(position.begin(), position.end(), velocity.begin(),
                 [](const Complex& x) { return Complex(0.0, 1.0) * x; });
  return sign * relation(velocity, force).alignment;
}

}  // namespace

Coupling fit_coupling(std::span<const double> force, std::span<const double> lead, std::span<const double> own,
                      double longest_s, Seconds dt) {
  constexpr std::size_t most_samples = 20'000;
  constexpr double smoothing_s = 0.006, as_good = 0.02;
  const std::size_t samples = std::min(most_samples, force.size());
  const auto longest = std::min(static_cast<std::size_t>(longest_s / dt.value), samples / 4);
  // Alike for force and positions, so that nothing of the relation is lost but noise.
  const auto half = std::max<std::size_t>(1, static_cast<std::size_t>(0.5 * smoothing_s / dt.value));
  const auto smooth = [&](std::span<const double> values) {
    std::vector<double> sums(samples + 1), means(samples);
    for (std::size_t i = 0; i < samples; ++i) sums[i + 1] = sums[i] + values[i] - values[0];
    for (std::size_t i = 0; i < samples; ++i) {
      const std::size_t from = i - std::min(i, half), to = std::min(samples, i + half + 1);
      means[i] = (sums[to] - sums[from]) / static_cast<double>(to - from);
    }
    return means;
  };
  const std::vector<double> f = smooth(force), x = smooth(lead), y = smooth(own);
  const auto [least, most] = std::minmax_element(force.begin(), force.begin() + static_cast<std::ptrdiff_t>(samples));
  const double margin = 0.03 * (*most - *least);
  std::vector<std::size_t> free;
  for (std::size_t i = longest + half + 1; i + half + 1 < samples; ++i) {
    if (force[i] > *least + margin && force[i] < *most - margin) free.push_back(i);
  }
  Coupling best;
  if (free.size() < 100) return best;
  double variance = 0.0, mean = 0.0;
  for (const std::size_t i : free) mean += f[i];
  mean /= static_cast<double>(free.size());
  for (const std::size_t i : free) variance += (f[i] - mean) * (f[i] - mean);
  if (!(variance > 0.0)) return best;
  const auto explained = [&](std::size_t lag) {
    double e1 = 0, v1 = 0, ee = 0, ev = 0, vv = 0, ef = 0, vf = 0;
    for (const std::size_t i : free) {
      const double e = x[i - lag] - y[i];
      const double v = (x[i - lag + half] - x[i - lag - half] - y[i + half] + y[i - half]);
      const double g = f[i] - mean;
      e1 += e, v1 += v, ee += e * e, ev += e * v, vv += v * v, ef += e * g, vf += v * g;
    }
    const auto n = static_cast<double>(free.size());
    ee -= e1 * e1 / n, ev -= e1 * v1 / n, vv -= v1 * v1 / n;
    const double determinant = ee * vv - ev * ev;
    if (!(determinant > 1e-12 * ee * vv)) return 0.0;
    const double k = (ef * vv - vf * ev) / determinant, b = (vf * ee - ef * ev) / determinant;
    return k > 0.0 ? (k * ef + b * vf) / variance : 0.0;
  };
  std::vector<double> shares;
  for (std::size_t lag = 0; lag <= longest; ++lag) shares.push_back(explained(lag));
  const double most_explained = *std::max_element(shares.begin(), shares.end());
  const auto first =
      std::find_if(shares.begin(), shares.end(), [=](double share) { return share >= most_explained - as_good; });
  // Up to the top of that hill.
  auto top = first;
  while (std::next(top) != shares.end() && *std::next(top) >= *top) ++top;
  best = {.delay_s = static_cast<double>(top - shares.begin()) * dt.value, .explained = *top};
  return best;
}

double explained_by_force(std::span<const double> force, std::span<const double> cause, double frequency_Hz,
                          double longest_s, Seconds dt) {
  constexpr std::size_t most_samples = 20'000;
  const std::size_t samples = std::min(most_samples, force.size());
  const auto longest = std::min(static_cast<std::size_t>(longest_s / dt.value), samples / 4);
  const std::vector<double> f = without_slow(force.first(samples), frequency_Hz, dt);
  const std::vector<double> c = without_slow(cause.first(samples), frequency_Hz, dt);
  const auto [least, most] = std::minmax_element(force.begin(), force.begin() + static_cast<std::ptrdiff_t>(samples));
  const double margin = 0.03 * (*most - *least);
  double best = 0.0;
  for (std::size_t lag = 0; lag <= longest; ++lag) {
    double ff = 0.0, cc = 0.0, fc = 0.0;
    for (std::size_t i = longest; i < samples; ++i) {
      if (force[i] > *most - margin) continue;
      ff += f[i] * f[i], cc += c[i - lag] * c[i - lag], fc += f[i] * c[i - lag];
    }
    if (fc > 0.0 && ff > 0.0 && cc > 0.0) best = std::max(best, fc * fc / (ff * cc));
  }
  return best;
}

Evidence measure(const Signals& signals, const Oscillation& oscillation) {
  const Seconds dt = signals.sample_time;
  const double f_Hz = oscillation.frequency_Hz;
  const auto from = std::min(static_cast<std::size_t>(oscillation.from_s / dt.value), signals.samples);
  const auto to = std::min(static_cast<std::size_t>(oscillation.to_s / dt.value), signals.samples);
  const double length = static_cast<double>(to - from);
  // Blocks of a few periods, and at least six of them where there is room.
  const double period = 1.0 / (f_Hz * dt.value);
  const double block = std::clamp(length / 8.0, 2.0 * period, std::max(6.0 * period, 0.1 / dt.value));
  const auto block_samples = std::max<std::size_t>(8, static_cast<std::size_t>(block));

  const auto part = [&](Role role) {
    const std::span<const double> all = signals.values(role);
    return all.empty() ? all : all.subspan(from, to - from);
  };
  Evidence found;
  Blocks blocks;
  for (const Role role : all_roles) {
    const auto index = static_cast<std::size_t>(role);
    if (signals.find(role) == nullptr) continue;
    blocks[index] = line_in_blocks(part(role), block_samples, f_Hz, dt);
    found.amplitude[index] = usual_size(blocks[index]);
  }
  const auto of = [&](Role role) -> const std::vector<Complex>& { return blocks[static_cast<std::size_t>(role)]; };
  const auto has = [&](Role role) { return signals.find(role) != nullptr; };

  if (has(Role::master_position) && has(Role::slave_position) && *found.of(Role::slave_position) > 0.0) {
    found.master_part =
        std::abs(position_scale(signals)) * *found.of(Role::master_position) / *found.of(Role::slave_position);
  }
  if (const Channel* master = signals.find(Role::master_position); master != nullptr && has(Role::slave_position)) {
    const Relation slave = relation(of(Role::master_position), of(Role::slave_position));
    const double coherence = slave.coherence;
    const bool moves = !master->constant() && *found.of(Role::master_position) > 0.7 * master->step;
    found.follows = moves ? coherence : 0.0;
    constexpr double keeps_a_phase = 0.5;
    if (moves && coherence > keeps_a_phase) {
      const double turned = position_scale(signals) < 0.0 ? std::numbers::pi : 0.0;
      found.slave_behind_rad = std::remainder(turned - slave.angle_rad, 2.0 * std::numbers::pi);
    }
  }
  if (const Channel* master = signals.find(Role::master_position); master != nullptr && !master->constant()) {
    found.master_steps = steps_within_a_period(part(Role::master_position), f_Hz, master->step, dt);
    found.master_turns = turns_within_a_period(part(Role::master_position), f_Hz, master->step, dt);
  }
  if (const Channel* slave = signals.find(Role::slave_position); slave != nullptr && !slave->constant()) {
    found.slave_steps = steps_within_a_period(part(Role::slave_position), f_Hz, slave->step, dt);
    found.slave_turns = turns_within_a_period(part(Role::slave_position), f_Hz, slave->step, dt);
    found.standstill = share_of_standstill(part(Role::slave_position), f_Hz, slave->step, dt);
  }
  if (has(Role::master_position)) {
    found.master_line = share_of_line(part(Role::master_position), f_Hz, dt);
    constexpr double to_judge_s = 1.0;
    if (to + static_cast<std::size_t>(to_judge_s / dt.value) < signals.samples) {
      found.motion_after = slow_motion_after(signals.values(Role::master_position), from, to, f_Hz, dt);
    }
  }
  if (has(Role::master_position) && has(Role::displayed_force)) {
    found.actuator_gives =
        gives(of(Role::displayed_force), -1.0, signals.find(Role::displayed_force)->step, of(Role::master_position));
  }
  if (has(Role::master_position) && has(Role::hand_force)) {
    found.hand_gives =
        gives(of(Role::hand_force), 1.0, signals.find(Role::hand_force)->step, of(Role::master_position));
  }
  if (has(Role::slave_position) && has(Role::slave_force)) {
    found.drive_gives =
        gives(of(Role::slave_force), 1.0, signals.find(Role::slave_force)->step, of(Role::slave_position));
  }
  if (has(Role::tip_force)) {
    const Role motion = has(Role::slave_position) ? Role::slave_position : Role::master_position;
    const double together =
        std::sqrt(beyond_chance(relation(of(motion), of(Role::tip_force)).coherence, of(motion).size()));
    const double size = *found.of(Role::tip_force);
    // Against what moves the slave. Where that was not recorded, against the least that the sensor tells.
    // A digit of a file may be finer than any sensor: no master shows twenty times the force of the contact.
    constexpr double largest_force_gain = 20.0;
    const double least = std::max(10.0 * signals.find(Role::tip_force)->step,
                                  found.of(Role::displayed_force).value_or(0.0) / largest_force_gain);
    const double against = has(Role::slave_force) ? *found.of(Role::slave_force) : least;
    found.contact = against > 0.0 ? together * std::min(1.0, size / against) : 0.0;
    if (has(Role::slave_position)) {
      found.tip_gives = gives(of(Role::tip_force), -1.0, signals.find(Role::tip_force)->step, of(Role::slave_position));
    }
  }
  if (has(Role::master_position) && has(Role::slave_position)) {
    // The stretch about the oscillation, for a coupling may change.
    constexpr double least_explained = 0.6, longest_delay_s = 0.3;
    // Beyond a period one delay looks like another.
    const double longest_s = std::min(longest_delay_s, 0.9 / f_Hz);
    const std::size_t before = std::min(from, static_cast<std::size_t>(2.0 / dt.value));
    const auto about = [&](Role role) { return signals.values(role).subspan(from - before, to - from + before); };
    std::vector<double> scaled(to - from + before);
    const auto master = about(Role::master_position);
    const double scale = position_scale(signals);
    std::transform(master.begin(), master.end(), scaled.begin(), [scale](double x) { return scale * x; });
    if (has(Role::slave_force)) {
      const Coupling there = fit_coupling(about(Role::slave_force), scaled, about(Role::slave_position), longest_s, dt);
      if (there.explained > least_explained) found.delay_there_s = there.delay_s;
    }
    if (has(Role::displayed_force)) {
      // F = k·(master − slave(t − delay)): the slave leads with the other sign.
      std::vector<double> force(about(Role::displayed_force).begin(), about(Role::displayed_force).end());
      for (double& value : force) value = -value;
      const Coupling back = fit_coupling(force, about(Role::slave_position), scaled, longest_s, dt);
      if (back.explained > least_explained) found.delay_back_s = back.delay_s;
      found.coupling_explains = back.explained;
      if (has(Role::tip_force)) {
        found.tip_explains =
            explained_by_force(about(Role::displayed_force), about(Role::tip_force), f_Hz, longest_s, dt);
      }
    }
  }
  if (has(Role::master_position) && has(Role::displayed_force)) {
    found.own_wall = find_own_wall(part(Role::displayed_force), part(Role::master_position), f_Hz, dt);
  }
  const auto see = [&](std::span<const double> motion, double size, double step) {
    if (size >= 0.5 * step) found.line_of_motion = std::max(found.line_of_motion, share_of_line(motion, f_Hz, dt));
  };
  for (const Role role : {Role::master_position, Role::slave_position}) {
    if (has(role) && !signals.find(role)->constant()) see(part(role), *found.of(role), signals.find(role)->step);
  }
  if (const std::vector<double> error = following_error(signals); !error.empty()) {
    const std::span<const double> seen = std::span(error).subspan(from, to - from);
    see(seen, usual_size(line_in_blocks(seen, block_samples, f_Hz, dt)),
        std::max(signals.find(Role::master_position)->step, signals.find(Role::slave_position)->step));
  }
  const bool slave_moves = has(Role::slave_position) && found.master_part.value_or(0.0) < 0.3;
  const Role moving = slave_moves || !has(Role::master_position) ? Role::slave_position : Role::master_position;
  found.wander = wander_of(part(moving), f_Hz, dt);
  return found;
}

}  // namespace tactus::diagnosis
