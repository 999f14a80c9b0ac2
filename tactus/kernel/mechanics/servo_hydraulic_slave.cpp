// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/mechanics/servo_hydraulic_slave.hpp>
#include <tactus/kernel/signal/checks.hpp>

namespace tactus::mechanics {

Result<ServoHydraulicSlave> ServoHydraulicSlave::make(const Params& params, Seconds dt) {
  if (Check error = signal::check(params, dt)) return *std::move(error);
  const auto valve = ServoValve::make(params.valve, dt);
  if (!valve) return under("valve", valve.error());
  const auto cylinder = HydraulicCylinder::make(params.cylinder, *valve, dt);
  if (!cylinder) return under("cylinder", cylinder.error());
  const auto first = PressureSensor::make(params.first_pressure, dt);
  if (!first) return under("first_pressure", first.error());
  const auto second = PressureSensor::make(params.second_pressure, dt);
  if (!second) return under("second_pressure", second.error());
  const auto position = PositionTransducer::make(params.position, dt);
  if (!position) return under("position", position.error());
  return ServoHydraulicSlave(params, *valve, *cylinder, *first, *second, *position);
}

ServoHydraulicSlave::Output ServoHydraulicSlave::step(double current_mA) noexcept {
  // The mean over the step, which keeps its second order.
  const double before = valve_.opening();
  cylinder_.step(valve_, 0.5 * (before + valve_.step(current_mA)));
  const HydraulicCylinder::State& state = cylinder_.state();
  first_pressure_.step(state.pressure_Pa[0]);
  second_pressure_.step(state.pressure_Pa[1]);
  position_.step(state.position_m);
  return {.position_m = state.position_m,
          .pressure_force_N = cylinder_.pressure_force_N(),
          .end_stop_force_N = state.end_stop_force_N};
}

ServoHydraulicSlave::Reading ServoHydraulicSlave::measure() noexcept {
  return {.position_m = position_.sample(),
          .pressure_force_N = first_area_m2_ * first_pressure_.sample() - second_area_m2_ * second_pressure_.sample()};
}

void ServoHydraulicSlave::reset(double position_m) noexcept {
  valve_.reset();
  cylinder_.reset(position_m);
  first_pressure_.reset(cylinder_.state().pressure_Pa[0]);
  second_pressure_.reset(cylinder_.state().pressure_Pa[1]);
  position_.reset(position_m);
}

}  // namespace tactus::mechanics
