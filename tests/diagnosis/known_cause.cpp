#include "tests/diagnosis/known_cause.hpp"

#include <tactus/control/architecture.hpp>
#include <tactus/mechanics/minimum_jerk.hpp>
#include <tactus/signal/random.hpp>
#include <tactus/simulation/teleoperator.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <span>
#include <utility>

#include "tests/diagnosis/sticking_carriage.hpp"

namespace tactus::known {
namespace {

using control::ServoPd;
using Rig = simulation::Teleoperator::Params;

constexpr double two_pi = 2.0 * std::numbers::pi;
constexpr double duration_s = 10.0;
constexpr double held_from_s = 3.5;  ///< until then the person moves about

/// The slave's servo with an integral of the error: what hunts about a place where friction holds it.
struct IntegralParams {
  double integral_N_per_m_s = 0.0;
  static constexpr auto fields() {
    return std::tuple{field("integral_N_per_m_s", &IntegralParams::integral_N_per_m_s, units::none, between(0.0, 1e6),
                            "Force per integral of the position error, in N/(m s).")};
  }
};

class IntegralSlave {
 public:
  using Input = control::SlaveInput;
  using Output = control::SlaveOutput;
  IntegralSlave(const ServoPd& servo, double per_tick) : servo_(servo), per_tick_(per_tick) {}
  Output respond(const Input& input) noexcept {
    const double error_m = input.arrival.message.position_m - input.motor_position_m;
    sum_N_ += per_tick_ * error_m;
    return {.motor_force_N = servo_.step(error_m) + sum_N_, .message = {.force_N = input.tip_force_N}};
  }
  void reset() noexcept {
    servo_.reset();
    sum_N_ = 0.0;
  }

 private:
  ServoPd servo_;
  double per_tick_;
  double sum_N_ = 0.0;
};

Result<control::Controllers> make_integral(const control::ControlParams& params, Seconds dt) {
  const auto master = control::PositionForceMaster::make(params, dt);
  if (!master) return master.error();
  const auto servo = ServoPd::make(params.slave, dt);
  if (!servo) return servo.error();
  const IntegralSlave slave(*servo, params.own<IntegralParams>().integral_N_per_m_s * dt.value);
  return control::Controllers{control::master_controller(*master), control::slave_controller(slave)};
}

void register_integral() {
  static const Check refused = control::register_architecture(
      {.name = "integral",
       .summary = "position-force whose slave integrates the error",
       .make = make_integral,
       .keys = control::own_keys<IntegralParams>("integral", "The integral of the slave's servo.")});
  (void)refused;
}

/// Where the person wants the hand: reaches one after the other, rests between, and a tremor whose size wanders.
class Path {
 public:
  void reach(double to_m, double speed_m_per_s, double rest_s) {
    const double stroke_m = std::abs(to_m - at_m_);
    if (stroke_m > 0.0) {
      const double takes_s = mechanics::MinimumJerk::duration_for(stroke_m, speed_m_per_s);
      reaches_.push_back({.start_m = at_m_, .end_m = to_m, .start_time_s = until_s_, .duration_s = takes_s});
      until_s_ += takes_s;
    }
    at_m_ = to_m;
    until_s_ += rest_s;
  }
  void glide(double to_m, double speed_m_per_s) {
    glides_.push_back({until_s_, at_m_, to_m, std::abs(to_m - at_m_) / speed_m_per_s});
    until_s_ += glides_.back().takes_s;
    at_m_ = to_m;
  }
  void start_at(double start_m) { at_m_ = start_m_ = start_m; }
  void rest_until(double time_s) { until_s_ = std::max(until_s_, time_s); }
  [[nodiscard]] double until_s() const { return until_s_; }
  [[nodiscard]] double start_m() const { return start_m_; }
  [[nodiscard]] double at(double time_s) const {
    double position_m = start_m_;
    for (const auto& reach : reaches_) position_m += reach.position_m(time_s) - reach.start_m;
    for (const Glide& glide : glides_) {
      position_m += (glide.to_m - glide.from_m) * std::clamp((time_s - glide.begins_s) / glide.takes_s, 0.0, 1.0);
    }
    return position_m;
  }

 private:
  struct Glide {
    double begins_s, from_m, to_m, takes_s;
  };
  std::vector<mechanics::MinimumJerk> reaches_;
  std::vector<Glide> glides_;
  double start_m_ = 0.0, at_m_ = 0.0, until_s_ = 0.3;
};

/// Tremor that is nobody's sine: white noise through a resonance, of this standard deviation.
class Tremor {
 public:
  Tremor(double frequency_Hz, double bandwidth_Hz, double rms_m, double tick_s, std::uint64_t seed) : random_(seed) {
    const double radius = std::exp(-std::numbers::pi * bandwidth_Hz * tick_s);
    a1_ = 2.0 * radius * std::cos(two_pi * frequency_Hz * tick_s);
    a2_ = -radius * radius;
    const double variance = (1.0 - a2_) / ((1.0 + a2_) * ((1.0 - a2_) * (1.0 - a2_) - a1_ * a1_));
    gain_ = rms_m / std::sqrt(variance);
    for (int i = 0; i < static_cast<int>(2.0 / tick_s); ++i) next();
  }
  double next() {
    const double y = a1_ * y1_ + a2_ * y2_ + gain_ * random_.normal();
    y2_ = y1_;
    return y1_ = y;
  }

 private:
  signal::Random random_;
  double a1_, a2_, gain_, y1_ = 0.0, y2_ = 0.0;
};

struct Scenario {
  Rig rig;
  Path path;
  std::optional<StickingCarriage::Params> carriage;
  double tremor_Hz = 9.0;
  double tremor_rms_m = 1e-5;
  std::uint64_t seed = 0;
};

/// To the nearest of what a converter or a file with so many digits tells.
double counted(double value, double step) { return std::round(value / step) * step; }

/// What was recorded, and how often the slave turned back and forth in the last three seconds, seen at every tick: what
/// is too fast for 1 kHz is left out.
struct Run {
  std::vector<Row> rows;
  double turns_Hz = 0.0;
};

template <class Slave>
Result<Run> run(const Scenario& scenario, Slave slave, const simulation::Clock& clock) {
  constexpr double force_step_N = 2e-3;
  const Rig& rig = scenario.rig;
  auto master = simulation::MasterPlant::make(rig.master, rig.person, clock, scenario.path.start_m());
  if (!master) return master.error();
  auto sites = station::BarePair::make(rig.control, rig.channel, Seconds{clock.tick_s},
                                       rig.control.position_scale * scenario.path.start_m());
  if (!sites) return sites.error();
  Tremor tremor(scenario.tremor_Hz, 0.8, scenario.tremor_rms_m, clock.tick_s, scenario.seed + 77);
  const auto ticks = static_cast<std::int64_t>(duration_s / clock.tick_s);
  const auto each = static_cast<std::int64_t>(std::llround(1e-3 / clock.tick_s));
  Run run;
  std::vector<Row>& rows = run.rows;
  double before_m = 0.0, direction = 0.0;
  double path_m = scenario.path.start_m() + tremor.next();
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    const double time_s = static_cast<double>(tick) * clock.tick_s;
    const auto output = sites->step(*master, slave, {.number = tick}, 1.0);
    const double moved_m = output.slave.reading.position_m - before_m;
    before_m = output.slave.reading.position_m;
    if (moved_m * direction < 0.0 && time_s > duration_s - 3.0) run.turns_Hz += 1.0 / 6.0;
    if (moved_m != 0.0) direction = moved_m;
    if (tick % each == 0) {
      rows.push_back({.time_s = time_s,
                      .master_m = output.master.reading.position_m,
                      .slave_m = output.slave.reading.position_m,
                      .displayed_N = counted(-output.master.output.motor_force_N, force_step_N),
                      .tip_N = counted(output.slave.reading.force_N, force_step_N),
                      .hand_N = counted(output.master.reading.force_N, force_step_N),
                      .drive_N = counted(output.slave.output.motor_force_N, force_step_N)});
    }
    const double next_m = scenario.path.at(time_s + clock.tick_s) + tremor.next();
    master->begin_tick(path_m, next_m);
    slave.begin_tick();
    for (int i = 0; i < clock.substeps; ++i) {
      master->substep(i);
      slave.substep(i);
    }
    path_m = next_m;
  }
  if (!sites->healthy()) return Error{ErrorCode::failed, {}, "a safety gate let go", {}};
  return run;
}

Result<Run> simulate(const Scenario& scenario) {
  const Rig& rig = scenario.rig;
  const auto clock = simulation::Clock::make(rig.servo, rig.plant);
  if (!clock) return clock.error();
  const double start_m = rig.control.position_scale * scenario.path.start_m();
  if (scenario.carriage) return run(scenario, StickingCarriage(*scenario.carriage, *clock, start_m), *clock);
  auto slave = simulation::SlavePlant::make(rig.slave, rig.environment, *clock, start_m);
  if (!slave) return slave.error();
  return run(scenario, *slave, *clock);
}

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
