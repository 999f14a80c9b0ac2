// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/known_cause.hpp"

#include <tactus/kernel/signal/random.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>
#include <string>
#include <utility>

#include "tests/diagnosis/scenario.hpp"

namespace tactus::known {
namespace {

using control::ServoPd;
using Rig = simulation::Teleoperator::Params;

/// How much a column moves in a stretch of time that is faster than 1.5 Hz: the standard deviation about the mean over
/// 0.6 s.
double spread(std::span<const Row> rows, double Row::*column, double from_s, double to_s) {
  constexpr std::size_t half = 300;
  double sum = 0.0, square = 0.0, count = 0.0;
  for (std::size_t i = half; i + half < rows.size(); ++i) {
    if (rows[i].time_s < from_s || rows[i].time_s >= to_s) continue;
    double mean = 0.0;
    for (std::size_t k = i - half; k <= i + half; ++k) mean += rows[k].*column / (2.0 * half + 1.0);
    const double fast = rows[i].*column - mean;
    sum += fast, square += fast * fast, count += 1.0;
  }
  return std::sqrt(std::max(square / count - sum * sum / (count * count), 0.0));
}

/// How a column crosses its mean over 0.6 s upward in the last three seconds; less than half of its usual size is no
/// crossing.
struct Crossings {
  double per_s = 0.0;
  double irregular = 0.0;  ///< standard deviation of the time between two over its mean
};

Crossings crossings(std::span<const Row> rows, double Row::*column) {
  constexpr std::size_t half = 300;
  const double band = 0.5 * spread(rows, column, duration_s - 3.0, duration_s);
  bool below = false;
  double count = 0.0, last_s = 0.0, sum = 0.0, square = 0.0;
  for (std::size_t i = half; i + half < rows.size(); ++i) {
    if (rows[i].time_s < duration_s - 3.0) continue;
    double mean = 0.0;
    for (std::size_t k = i - half; k <= i + half; ++k) mean += rows[k].*column / (2.0 * half + 1.0);
    const double fast = rows[i].*column - mean;
    if (below && fast > band) {
      below = false;
      count += 1.0;
      if (count > 1.0) sum += rows[i].time_s - last_s, square += (rows[i].time_s - last_s) * (rows[i].time_s - last_s);
      last_s = rows[i].time_s;
    }
    if (fast < -band) below = true;
  }
  if (count < 3.0) return {.per_s = count / 2.7};
  const double mean = sum / (count - 1.0);
  return {.per_s = count / 2.7, .irregular = std::sqrt(std::max(0.0, square / (count - 1.0) - mean * mean)) / mean};
}

/// One reason to shake: what raises it, within which bounds, and how the same rig is rid of it.
struct Reason {
  std::string parameter;
  double lowest, highest;
  void (*set)(Scenario&, double);
  void (*take_away)(Scenario&);
  double Row::*column;
  double threshold;
  double most_irregular = 1e9;  ///< of its crossings
  double most_quiet = 1e9;      ///< a value that shakes nobody
};

/// Does it shake until the end? What moves more than `threshold` in the last second, does not fade and comes often
/// enough.
bool shakes(const Run& run, const Reason& reason) {
  const std::span<const Row> rows = run.rows;
  const double before = spread(rows, reason.column, duration_s - 3.0, duration_s - 1.5);
  const double last = spread(rows, reason.column, duration_s - 1.5, duration_s);
  const Crossings crossed = crossings(rows, reason.column);
  const bool in_reach =
      std::all_of(rows.begin(), rows.end(), [](const Row& row) { return std::abs(row.slave_m) < 0.1; });
  return last > reason.threshold && last > 0.7 * before && in_reach && crossed.per_s > 1.4 && crossed.per_s < 350.0 &&
         crossed.irregular < reason.most_irregular && run.turns_Hz < 400.0;
}

/// A rig like that of experiments/tapping.toml, each value drawn.
Scenario drawn_rig(signal::Random& random, std::uint64_t seed) {
  const auto about = [&random](double value, double factor) {
    return value * std::exp(random.uniform(-std::log(factor), std::log(factor)));
  };
  Scenario scenario;
  scenario.seed = seed;
  Rig& rig = scenario.rig;
  for (auto* mechanism : {&rig.master.mechanism, &rig.slave.mechanism}) {
    mechanism->motor.mass_kg = about(mechanism->motor.mass_kg, 1.3);
    mechanism->motor.friction_N = about(mechanism->motor.friction_N, 1.5);
    mechanism->drum.mass_kg = about(mechanism->drum.mass_kg, 1.3);
    mechanism->drum.friction_N = about(mechanism->drum.friction_N, 1.5);
    mechanism->tip.mass_kg = about(mechanism->tip.mass_kg, 1.3);
    mechanism->linkage.stiffness_N_per_m = about(mechanism->linkage.stiffness_N_per_m, 1.3);
  }
  const double grip = about(1.0, 1.6);
  rig.person.grip = {.stiffness_N_per_m = 40.0 * grip, .damping_N_s_per_m = about(23.0, 1.3) * grip};
  rig.person.tremor_amplitude_m = 0.0;
  scenario.tremor_Hz = random.uniform(6.0, 11.0);
  scenario.tremor_rms_m = about(1.2e-5, 1.8);
  rig.control.slave = {.proportional_N_per_m = about(100.0, 1.3), .derivative_N_s_per_m = about(0.65, 1.2)};
  rig.control.force_limit_N = about(1.5, 1.6);
  rig.control.cancellation = control::CancellationMode::off;
  rig.environment.stiffness_N_per_m = about(20000.0, 2.0);
  rig.environment.damping_N_s_per_m = about(4.0, 1.5);
  rig.master.force_sensor.noise_rms_N = rig.slave.force_sensor.noise_rms_N = about(3e-3, 1.5);
  rig.master.force_sensor.seed = static_cast<std::int64_t>(2 * seed + 1000);
  rig.slave.force_sensor.seed = static_cast<std::int64_t>(2 * seed + 1001);
  rig.plant.longest_step_s = 2e-5;
  return scenario;
}

/// Moves about in free space, never beyond `farthest_m`.
void move_about(Path& path, signal::Random& random, double farthest_m) {
  while (path.until_s() < held_from_s - 0.7) {
    path.reach(farthest_m - random.uniform(0.002, 0.03), random.uniform(0.03, 0.15), random.uniform(0.05, 0.4));
  }
}

Reason press_on_a_wall(Scenario& scenario, signal::Random& random) {
  scenario.path.start_at(-0.02);
  move_about(scenario.path, random, -0.004);
  scenario.path.reach(random.uniform(0.003, 0.008), random.uniform(0.1, 0.25), 0.0);
  scenario.rig.person.correction.gain_per_s = 0.5;
  return {.parameter = "force gain",
          .lowest = 0.2,
          .highest = 12.0,
          .set = [](Scenario& s, double gain) { s.rig.control.force_gain = gain; },
          .take_away = [](Scenario& s) { s.rig.control.force_gain = 0.1; },
          .column = &Row::master_m,
          .threshold = 6e-5};
}

Reason stiffen_the_servo(Scenario& scenario, signal::Random& random) {
  Rig& rig = scenario.rig;
  scenario.path.start_at(-0.03);
  move_about(scenario.path, random, 0.0);
  scenario.path.reach(-random.uniform(0.01, 0.02), 0.08, 0.0);
  rig.environment.position_m = 0.5;
  rig.servo.rate_Hz = random.uniform() < 0.5 ? 1000.0 : 2000.0;
  rig.servo.computation_delay_s = random.uniform(0.3, 0.9) / rig.servo.rate_Hz;
  rig.control.slave.derivative_N_s_per_m = random.uniform(0.3, 0.9);
  rig.control.slave.velocity.cutoff_Hz = random.uniform(60.0, 200.0);
  rig.control.slave_gate.force_limit_N = random.uniform(1.0, 4.0);
  return {.parameter = "slave stiffness",
          .lowest = 60.0,
          .highest = 2e4,
          .set = [](Scenario& s, double gain) { s.rig.control.slave.proportional_N_per_m = gain; },
          .take_away = [](Scenario& s) { s.rig.control.slave.proportional_N_per_m *= 0.3; },
          .column = &Row::drive_N,
          .threshold = 0.05};
}

Reason delay_the_way(Scenario& scenario, signal::Random& random) {
  Rig& rig = scenario.rig;
  scenario.path.start_at(-0.03);
  move_about(scenario.path, random, 0.0);
  scenario.path.reach(-random.uniform(0.01, 0.02), 0.08, 0.0);
  rig.environment.position_m = 0.5;
  rig.control.architecture = "position-position";
  rig.control.force_gain = 1.0;
  rig.control.force_limit_N = random.uniform(0.3, 1.0);
  rig.control.slave_gate.force_limit_N = random.uniform(1.0, 2.0);
  rig.control.slave.proportional_N_per_m = random.uniform(40.0, 150.0);
  rig.control.slave.derivative_N_s_per_m = random.uniform(0.4, 1.2);
  rig.person.grip = {.stiffness_N_per_m = random.uniform(5.0, 20.0), .damping_N_s_per_m = random.uniform(0.3, 2.0)};
  return {.parameter = "delay of each way",
          .lowest = 1e-3,
          .highest = 0.2,
          .set = [](Scenario& s,
                    double delay_s) { s.rig.channel.to_slave.delay_s = s.rig.channel.to_master.delay_s = delay_s; },
          .take_away = [](Scenario& s) { s.rig.channel.to_slave.delay_s = s.rig.channel.to_master.delay_s = 0.0; },
          .column = &Row::slave_m,
          .threshold = 2e-4};
}

/// A rigid carriage: a chain on a cable chatters at a tick or two for each count, without a period.
Reason coarsen_the_encoder(Scenario& scenario, signal::Random& random) {
  Rig& rig = scenario.rig;
  scenario.path.start_at(-0.03);
  move_about(scenario.path, random, 0.0);
  scenario.path.reach(-random.uniform(0.01, 0.02), 0.08, 0.0);
  const double friction_N = random.uniform(0.02, 0.1);
  scenario.carriage = StickingCarriage::Params{.mass_kg = random.uniform(0.05, 0.3),
                                               .static_N = friction_N,
                                               .coulomb_N = friction_N,
                                               .stribeck_m_per_s = 0.005,
                                               .viscous_N_s_per_m = random.uniform(0.0, 0.2)};
  ServoPd::Params& servo = rig.control.slave;
  servo.proportional_N_per_m = random.uniform(400.0, 1500.0);
  servo.derivative_N_s_per_m =
      random.uniform(0.3, 0.8) * std::sqrt(servo.proportional_N_per_m * scenario.carriage->mass_kg);
  servo.velocity.cutoff_Hz = random.uniform(30.0, 150.0);
  rig.servo.rate_Hz = random.uniform() < 0.5 ? 1000.0 : 2000.0;
  rig.servo.computation_delay_s = random.uniform(0.1, 0.9) / rig.servo.rate_Hz;
  return {.parameter = "step of the slave's encoder",
          .lowest = 1e-5,
          .highest = 4e-3,
          .set = [](Scenario& s, double step_m) { s.carriage->resolution_m = step_m; },
          .take_away = [](Scenario& s) { s.carriage->resolution_m = 1e-6; },
          .column = &Row::drive_N,
          .threshold = 0.01,
          .most_irregular = 0.15};
}

Reason stick_and_slip(Scenario& scenario, signal::Random& random) {
  Rig& rig = scenario.rig;
  const bool hunts = random.uniform() < 0.5;
  scenario.path.start_at(-0.03);
  if (hunts) {
    move_about(scenario.path, random, 0.0);
    scenario.path.reach(-random.uniform(0.01, 0.02), 0.08, 0.0);
  } else {
    scenario.path.reach(-0.02, 0.05, 0.5);
    const double speed = random.uniform(0.005, 0.015);
    for (double to_m = 0.0; scenario.path.until_s() < duration_s; to_m = to_m == 0.0 ? -0.06 : 0.0) {
      scenario.path.glide(to_m, speed);
    }
  }
  scenario.carriage = StickingCarriage::Params{.mass_kg = random.uniform(0.05, 0.3),
                                               .static_N = 0.5,
                                               .coulomb_N = random.uniform(0.2, 0.5),
                                               .stribeck_m_per_s = random.uniform(0.002, 0.006),
                                               .viscous_N_s_per_m = random.uniform(0.1, 0.6)};
  rig.control.architecture = "integral";
  ServoPd::Params& servo = rig.control.slave;
  servo.proportional_N_per_m = random.uniform(200.0, 500.0);
  servo.derivative_N_s_per_m =
      random.uniform(0.6, 1.2) * std::sqrt(servo.proportional_N_per_m * scenario.carriage->mass_kg);
  if (hunts) {
    rig.control.own<IntegralParams>().integral_N_per_m_s = servo.proportional_N_per_m * random.uniform(12.0, 30.0);
  }
  return {.parameter = "friction at rest over that in motion",
          .lowest = 1.0,
          .highest = 8.0,
          .set = [](Scenario& s, double ratio) { s.carriage->static_N = ratio * s.carriage->coulomb_N; },
          .take_away = [](Scenario& s) { s.carriage->static_N = s.carriage->coulomb_N; },
          .column = &Row::drive_N,
          .threshold = 0.02};
}

Reason tremble(Scenario& scenario, signal::Random& random) {
  Rig& rig = scenario.rig;
  const double way = random.uniform();
  scenario.path.start_at(-0.03);
  move_about(scenario.path, random, -0.004);
  scenario.path.reach(way < 0.4 ? random.uniform(0.002, 0.004) : -random.uniform(0.01, 0.02), 0.08, 0.0);
  if (way >= 0.7) {
    rig.control.architecture = "position-position";
    rig.environment.position_m = 0.5;
  }
  rig.control.force_gain = 0.4;
  rig.environment.stiffness_N_per_m = std::exp(random.uniform(std::log(500.0), std::log(2e4)));
  rig.person.tremor_frequency_Hz = scenario.tremor_Hz = random.uniform(4.5, 11.5);
  return {.parameter = "amplitude of the tremor",
          .lowest = 5e-5,
          .highest = 2e-3,
          .set =
              [](Scenario& s, double amplitude_m) {
                s.rig.person.tremor_amplitude_m = 0.6 * amplitude_m;
                s.tremor_rms_m = 0.45 * amplitude_m;
              },
          .take_away = [](Scenario& s) { s.rig.person.tremor_amplitude_m = s.tremor_rms_m = 0.0; },
          .column = &Row::master_m,
          .threshold = 1.4e-4,
          .most_quiet = 1e-4};
}

Reason reason_of(Cause cause, Scenario& scenario, signal::Random& random) {
  switch (cause) {
    case Cause::induced_motion:
      return press_on_a_wall(scenario, random);
    case Cause::slave_servo:
      return stiffen_the_servo(scenario, random);
    case Cause::delay:
      return delay_the_way(scenario, random);
    case Cause::quantisation:
      return coarsen_the_encoder(scenario, random);
    case Cause::stick_slip:
      return stick_and_slip(scenario, random);
    case Cause::tremor:
      break;
  }
  return tremble(scenario, random);
}

/// Empty where this rig shakes everywhere or nowhere, or for another reason too.
Result<std::optional<Recording>> attempt(Cause cause, Strength strength, std::uint64_t seed, std::uint64_t draw) {
  signal::Random random = signal::Random(seed).fork(100 * draw + static_cast<std::uint64_t>(cause));
  Scenario scenario = drawn_rig(random, 1000 * seed + draw);
  const Reason reason = reason_of(cause, scenario, random);
  const auto rows_at = [&](double value) {
    Scenario at = scenario;
    reason.set(at, value);
    return simulate(at);
  };
  const auto none = std::optional<Recording>();
  // The lowest value at which it shakes, within 2 %, walking up: beyond the onset it may be still again.
  const double step = std::pow(reason.highest / reason.lowest, 1.0 / 12.0);
  double low = reason.lowest, high = low;
  for (;;) {
    const auto rows = rows_at(high);
    if (!rows) return none;
    if (shakes(*rows, reason)) break;
    low = high;
    high *= step;
    if (high > 1.001 * reason.highest) return none;
  }
  if (high == low) return none;
  while (high > 1.02 * low) {
    const double middle = std::sqrt(low * high);
    const auto rows = rows_at(middle);
    if (!rows) return none;
    (shakes(*rows, reason) ? high : low) = middle;
  }
  const double over = strength == Strength::quiet  ? random.uniform(0.33, 0.6)
                      : strength == Strength::near ? random.uniform(1.0, 1.2)
                                                   : random.uniform(1.3, 2.5);
  Recording recording{
      .rows = {}, .with_hand_force = seed % 2 == 0, .strength = over, .parameter = reason.parameter, .onset = high};
  Scenario chosen = scenario;
  const double value = strength == Strength::quiet ? std::min(over * high, reason.most_quiet) : over * high;
  reason.set(chosen, value);
  auto rows = simulate(chosen);
  if (!rows || shakes(*rows, reason) != (strength != Strength::quiet)) return none;
  if (strength == Strength::quiet &&
      spread(rows->rows, reason.column, held_from_s + 1.0, duration_s) > reason.threshold) {
    return none;  // it shook for a while
  }
  recording.rows = std::move(rows->rows);
  reason.take_away(chosen);
  const auto without = simulate(chosen);
  if (!without || shakes(*without, reason)) return none;
  return std::optional(std::move(recording));
}

}  // namespace

Result<Recording> make(Cause cause, Strength strength, std::uint64_t seed) {
  register_integral();
  constexpr std::uint64_t most_draws = 40;
  for (std::uint64_t draw = 0; draw < most_draws; ++draw) {
    auto made = attempt(cause, strength, seed, draw);
    if (!made) return made.error();
    if (*made) return **std::move(made);
  }
  return Error{ErrorCode::failed, {}, "no rig drawn from this seed shakes for this reason alone", {}};
}

std::string to_csv(const Recording& recording) {
  std::string text = "time_s,master_position_m,slave_position_m,displayed_force_N,tip_force_N,slave_force_N";
  text += recording.with_hand_force ? ",hand_force_N\n" : "\n";
  char line[160];
  for (const Row& row : recording.rows) {
    std::snprintf(line, sizeof line, "%.3f,%.6f,%.6f,%.3f,%.3f,%.3f", row.time_s, row.master_m, row.slave_m,
                  row.displayed_N, row.tip_N, row.drive_N);
    text += line;
    if (recording.with_hand_force) {
      std::snprintf(line, sizeof line, ",%.3f", row.hand_N);
      text += line;
    }
    text += '\n';
  }
  return text;
}

}  // namespace tactus::known