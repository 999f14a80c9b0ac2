// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/scenario.hpp"

#include <tactus/kernel/control/architecture.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <cmath>
#include <numbers>

namespace tactus::known {
namespace {

using control::ServoPd;

constexpr double two_pi = 2.0 * std::numbers::pi;

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
/// To the nearest of what a converter or a file with so many digits tells.
double counted(double value, double step) { return std::round(value / step) * step; }
template <class Slave>
Result<Run> run(const Scenario& scenario, Slave slave, const simulation::Clock& clock) {
  constexpr double force_step_N = 2e-3;
  const simulation::Teleoperator::Params& rig = scenario.rig;
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
}  // namespace

void register_integral() {
  static const Check refused = control::register_architecture(
      {.name = "integral",
       .summary = "position-force whose slave integrates the error",
       .make = make_integral,
       .keys = control::own_keys<IntegralParams>("integral", "The integral of the slave's servo.")});
  (void)refused;
}
Result<Run> simulate(const Scenario& scenario) {
  const simulation::Teleoperator::Params& rig = scenario.rig;
  const auto clock = simulation::Clock::make(rig.servo, rig.plant);
  if (!clock) return clock.error();
  const double start_m = rig.control.position_scale * scenario.path.start_m();
  if (scenario.carriage) return run(scenario, StickingCarriage(*scenario.carriage, *clock, start_m), *clock);
  auto slave = simulation::SlavePlant::make(rig.slave, rig.environment, *clock, start_m);
  if (!slave) return slave.error();
  return run(scenario, *slave, *clock);
}

}  // namespace tactus::known
