#include <tactus/configuration/toml_writer.hpp>
#include <tactus/runtime/simulated_plant.hpp>

namespace tactus::runtime {

Result<SimulatedPlant> SimulatedPlant::make(const simulation::Tap& tap) {
  const simulation::Teleoperator::Params& params = tap.params;
  const auto clock = simulation::Clock::make(params.servo, params.plant);
  if (!clock) return clock.error();
  const auto master = simulation::MasterPlant::make(params.master, params.person, *clock, tap.path.start_m);
  if (!master) return master.error();
  const auto slave = simulation::SlavePlant::make(params.slave, params.environment, *clock,
                                                  params.control.position_scale * tap.path.start_m);
  if (!slave) return slave.error();
  return SimulatedPlant(SimulatedMaster(*master, *clock, tap.path,
                                        {.force_N = params.master.amplifier.limit_N,
                                         .handle_force_N = params.master.handle_actuator.limit_N}),
                        SimulatedSlave(*slave, *clock, {.force_N = params.slave.amplifier.limit_N}));
}

std::optional<SimulatedTruth> SimulatedPlant::next(const Tick& tick) noexcept {
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

std::string plant_configuration(const simulation::TappingParams& params) {
  simulation::TappingParams plant = params;
  plant.control = {};
  plant.control.position_scale = params.control.position_scale;
  plant.channel = {};
  const simulation::TapSeries usual;
  plant.task.taps = usual.taps;
  plant.task.observation_s = usual.observation_s;
  plant.task.model_error = usual.model_error;
  plant.task.mismatch = usual.mismatch;
  return configuration::to_toml(plant);
}

}  // namespace tactus::runtime
