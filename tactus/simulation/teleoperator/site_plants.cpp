// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/teleoperator/site_plants.hpp>

namespace tactus::simulation {

Result<MasterPlant> MasterPlant::make(const mechanics::CableDrivenMaster::Params& device,
                                      const mechanics::Operator::Params& person, const Clock& clock, double start_m) {
  const Seconds substep{clock.substep_s};
  auto master = mechanics::CableDrivenMaster::make(device, person.grip, substep);
  if (!master) {
    const Error& error = master.error();
    return under(error.parameter.starts_with("grip.") ? "operator" : "master", error);
  }
  const double factor = person.grip_change.factor;
  if (const auto changed = mechanics::CableDrivenMaster::make(device, mechanics::scaled(person.grip, factor), substep);
      !changed) {
    return under("operator", changed.error());
  }
  const auto holder = mechanics::Operator::make(person, Seconds{clock.tick_s});
  if (!holder) return under("operator", holder.error());
  master->reset(start_m);
  return MasterPlant(*master, *holder, person, clock);
}

station::DeviceReading MasterPlant::read(const station::Tick&) noexcept {
  const double factor = grip_change_.at(static_cast<double>(ticks_) * clock_.tick_s);
  if (factor != grip_factor_) {
    grip_factor_ = factor;
    device_.hold(mechanics::scaled(grip_, factor));
  }
  const mechanics::CableDrivenMaster::Reading reading = device_.measure();
  return {.position_m = reading.motor_position_m, .force_N = reading.hand_force_N, .grip = grip_factor_};
}

Result<SlavePlant> SlavePlant::make(const mechanics::ElectricSlave::Params& device,
                                    const mechanics::Environment::Params& environment, const Clock& clock,
                                    double start_m) {
  auto slave = mechanics::ElectricSlave::make(device, environment, Seconds{clock.substep_s});
  if (!slave) {
    const Error& error = slave.error();
    return error.parameter.starts_with("environment.") ? error : under("slave", error);
  }
  slave->reset(start_m);
  return SlavePlant(*slave, clock);
}

}  // namespace tactus::simulation
