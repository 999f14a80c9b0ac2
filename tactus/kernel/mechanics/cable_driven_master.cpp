// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/mechanics/cable_driven_master.hpp>

namespace tactus::mechanics {

Result<CableDrivenMaster> CableDrivenMaster::make(const Params& params, const LinearSpring::Params& grip, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  if (auto error = validate(grip)) return under("grip", *std::move(error));
  const auto mechanism = CableChain::make(params.mechanism, grip, dt);
  if (!mechanism) {
    // The hand is no part of the mechanism.
    if (mechanism.error().parameter.starts_with("grip.")) return mechanism.error();
    return under("mechanism", mechanism.error());
  }
  const auto amplifier = CurrentAmplifier::make(params.amplifier, dt);
  if (!amplifier) return under("amplifier", amplifier.error());
  const auto handle_actuator = CurrentAmplifier::make(params.handle_actuator, dt);
  if (!handle_actuator) return under("handle_actuator", handle_actuator.error());
  const auto encoder = Encoder::make(params.encoder, dt);
  if (!encoder) return under("encoder", encoder.error());
  const auto force_sensor = ForceSensor::make(params.force_sensor, dt);
  if (!force_sensor) return under("force_sensor", force_sensor.error());
  return CableDrivenMaster(*mechanism, *amplifier, *handle_actuator, *encoder, *force_sensor);
}

void CableDrivenMaster::reset(double position_m) noexcept {
  mechanism_.reset(position_m);
  amplifier_.reset();
  handle_actuator_.reset();
  encoder_.reset();
  force_sensor_.reset();
}

}  // namespace tactus::mechanics
