// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/mechanics/electric_slave.hpp>

#include <algorithm>

namespace tactus::mechanics {

namespace {

/// The wall's force is held over a substep, so its damping b limits the step like a further stiffness of 2 b / h.
Check check_wall(const CableChain::Params& mechanism, const Environment::Params& wall, Seconds dt) {
  const bool viscous = wall.law != ContactLaw::hunt_crossley;
  const double from_damping = viscous ? 2.0 * wall.damping_N_s_per_m / dt.value : 0.0;
  const char* const stiffer =
      from_damping > wall.stiffness_N_per_m ? "environment.damping_N_s_per_m" : "environment.stiffness_N_per_m";
  auto error = CableChain::check_step(mechanism, wall.stiffness_N_per_m + from_damping, stiffer, dt);
  if (error && error->parameter != stiffer) return under("mechanism", *std::move(error));
  return error;
}

}  // namespace

Result<ElectricSlave> ElectricSlave::make(const Params& params, const Environment::Params& environment, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  const auto mechanism = CableChain::make(params.mechanism, dt);
  if (!mechanism) return under("mechanism", mechanism.error());
  const auto amplifier = CurrentAmplifier::make(params.amplifier, dt);
  if (!amplifier) return under("amplifier", amplifier.error());
  const auto encoder = Encoder::make(params.encoder, dt);
  if (!encoder) return under("encoder", encoder.error());
  const auto force_sensor = ForceSensor::make(params.force_sensor, dt);
  if (!force_sensor) return under("force_sensor", force_sensor.error());
  const auto wall = Environment::make(environment, dt);
  if (!wall) return under("environment", wall.error());
  if (auto error = check_wall(params.mechanism, environment, dt)) return *std::move(error);
  return ElectricSlave(*mechanism, *amplifier, *encoder, *force_sensor, *wall, dt);
}

void ElectricSlave::reset(double position_m) noexcept {
  mechanism_.reset(position_m);
  amplifier_.reset();
  encoder_.reset();
  force_sensor_.reset();
}

}  // namespace tactus::mechanics
