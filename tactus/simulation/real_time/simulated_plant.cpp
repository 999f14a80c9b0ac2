// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/simulation/real_time/simulated_plant.hpp>

#include <algorithm>

namespace tactus::real_time {

namespace {

/// What a simulated device keeps to whoever commands it: force as its gate, the rest wider than where the gate acts, so
/// that of a sound controller nothing is held back. Two of its commands can fall into one tick of the device.
station::DeviceLimits limits_of(double amplifier_N, const control::SafetyGate::Params& gate) {
  constexpr double beyond = 1.5;
  static_assert(beyond > control::SafetyGate::fault_factor);
  return {.force_N = std::min(amplifier_N, gate.force_limit_N),
          .rate_N_per_s = 2.0 * gate.rate_limit_N_per_s,
          .velocity_m_per_s = beyond * gate.velocity_limit_m_per_s,
          .position_m = beyond * gate.position_limit_m};
}

}  // namespace

Result<SimulatedPlant> SimulatedPlant::make(const experiments::Tap& tap) {
  const simulation::Teleoperator::Params& params = tap.params;
  const auto clock = simulation::Clock::make(params.servo, params.plant);
  if (!clock) return clock.error();
  const auto master = simulation::MasterPlant::make(params.master, params.person, *clock, tap.path.start_m);
  if (!master) return master.error();
  const auto slave = simulation::SlavePlant::make(params.slave, params.environment, *clock,
                                                  params.control.position_scale * tap.path.start_m);
  if (!slave) return slave.error();
  station::DeviceLimits of_master = limits_of(params.master.amplifier.limit_N, params.control.gate);
  of_master.handle_force_N = std::min(params.master.handle_actuator.limit_N, params.control.handle_gate.force_limit_N);
  of_master.rate_N_per_s = std::max(of_master.rate_N_per_s, 2.0 * params.control.handle_gate.rate_limit_N_per_s);
  return SimulatedPlant(
      SimulatedMaster(*master, *clock, FollowsPath(tap.path, clock->tick_s), of_master),
      SimulatedSlave(*slave, *clock, limits_of(params.slave.amplifier.limit_N, params.control.slave_gate)));
}

std::optional<SimulatedTruth> SimulatedPlant::next(const station::Tick& tick) noexcept {
  if (ticks() >= tick.number) return std::nullopt;
  master_.advance();
  slave_.advance();
  return truth();
}

SimulatedTruth SimulatedPlant::truth() const noexcept {
  const simulation::SlavePlant::Contact& contact = slave_.plant().contact();
  return {.tick = ticks(),
          .tip_position_m = tip_position_m(),
          .contact_sum_N = contact.sum_N,
          .contact_peak_N = contact.peak_N,
          .touched = contact.touched ? 1 : 0,
          .touched_substep = contact.touched_substep,
          .touched_after_s = contact.touched_after_s};
}

std::string plant_configuration(const experiments::TappingParams& params) {
  experiments::TappingParams plant = params;
  plant.control = {};
  plant.control.position_scale = params.control.position_scale;
  plant.control.gate = params.control.gate;
  plant.control.handle_gate = params.control.handle_gate;
  plant.control.slave_gate = params.control.slave_gate;
  plant.channel = {};
  const experiments::TapSeries usual;
  plant.task.taps = usual.taps;
  plant.task.observation_s = usual.observation_s;
  plant.task.model_error = usual.model_error;
  plant.task.mismatch = usual.mismatch;
  return configuration::to_toml(plant);
}

}  // namespace tactus::real_time
