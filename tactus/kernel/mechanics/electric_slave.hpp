// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/mechanics/amplifier.hpp>
#include <tactus/kernel/mechanics/cable_chain.hpp>
#include <tactus/kernel/mechanics/encoder.hpp>
#include <tactus/kernel/mechanics/environment.hpp>
#include <tactus/kernel/mechanics/force_sensor.hpp>
#include <tactus/kernel/mechanics/tip_at_wall.hpp>

#include <cstdint>

namespace tactus::mechanics {

/// The slave as a plant: a device like the master, its tip facing a wall, with an encoder on the motor and a force
/// sensor at the tip (paper A, Fig. 9: two equal joysticks).
///
/// It runs on the plant's substeps. A substep in which the tip meets or leaves the wall's surface is cut there: the
/// instant is found by false position, trying parts of the substep, and the two parts are stepped one after the other,
/// so the contact time is known far below the substep and the impact does not depend on where the grid fell.
class ElectricSlave {
 public:
  struct Params {
    CableChain::Params mechanism;
    CurrentAmplifier::Params amplifier;
    Encoder::Params encoder{.resolution_m = 1e-5};
    ForceSensor::Params force_sensor;
    static constexpr auto fields() {
      return List{field("mechanism", &Params::mechanism, "Motor, cable, drum, linkage and tip."),
                  field("amplifier", &Params::amplifier, "Current amplifier of the motor."),
                  field("encoder", &Params::encoder, "Position encoder on the motor."),
                  field("force_sensor", &Params::force_sensor, "Force sensor at the tip: measures the contact force.")};
    }
  };

  using Input = double;
  /// What happened in one substep.
  struct Output {
    double contact_force_N = 0.0;  ///< mean over the substep, positive when the wall pushes the tip back
    bool touched = false;          ///< the tip went from a gap into the wall
    double touched_after_s = 0.0;  ///< when, from the start of the substep
  };
  /// What the slave's sensors read.
  struct Reading {
    double motor_position_m = 0.0;
    double tip_force_N = 0.0;
  };

  /// A slave before a wall. Fails where a value is out of bounds, and where the wall or the mechanism is too stiff, or
  /// the wall too viscous, for the step.
  static Result<ElectricSlave> make(const Params& params, const Environment::Params& environment, Seconds dt);
  /// A slave before the default wall.
  static Result<ElectricSlave> make(const Params& params, Seconds dt) { return make(params, {}, dt); }

  /// Advances by one substep under `commanded_force_N`, positive toward the environment. Real-time safe.
  Output step(double commanded_force_N) noexcept {
    const auto contact = TipAtWall<double, Environment>(mechanism_.motion(), environment_, dt_s_)
                             .step(amplifier_.step(commanded_force_N));
    force_sensor_.step(contact.contact_force_N);
    return {.contact_force_N = contact.contact_force_N,
            .touched = contact.touched > 0.0,
            .touched_after_s = contact.touched_after_s};
  }

  /// What the sensors read now: draws one sample of noise.
  Reading measure() noexcept {
    return {.motor_position_m = encoder_.step(mechanism_.motor_position_m()), .tip_force_N = force_sensor_.sample()};
  }

  /// Puts another wall in front of the tip, from the next substep on. It must have been accepted by `make` of a slave
  /// like this one. Real-time safe.
  void face(const Environment& environment) noexcept { environment_ = environment; }

  void reset() noexcept { reset(0.0); }
  /// At rest with every mass at `position_m`.
  void reset(double position_m) noexcept;

  [[nodiscard]] const CableChain& mechanism() const noexcept { return mechanism_; }
  [[nodiscard]] const CurrentAmplifier& amplifier() const noexcept { return amplifier_; }
  [[nodiscard]] const ForceSensor& force_sensor() const noexcept { return force_sensor_; }
  [[nodiscard]] const Environment& environment() const noexcept { return environment_; }

 private:
  ElectricSlave(const CableChain& mechanism, const CurrentAmplifier& amplifier, const Encoder& encoder,
                const ForceSensor& force_sensor, const Environment& environment, Seconds dt)
      : mechanism_(mechanism),
        amplifier_(amplifier),
        encoder_(encoder),
        force_sensor_(force_sensor),
        environment_(environment),
        dt_s_(dt.value) {}

  CableChain mechanism_;
  CurrentAmplifier amplifier_;
  Encoder encoder_;
  ForceSensor force_sensor_;
  Environment environment_;
  double dt_s_;
};

}  // namespace tactus::mechanics
