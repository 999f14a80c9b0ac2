// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/mechanics/amplifier.hpp>
#include <tactus/kernel/mechanics/cable_chain.hpp>
#include <tactus/kernel/mechanics/encoder.hpp>
#include <tactus/kernel/mechanics/force_sensor.hpp>
#include <tactus/kernel/mechanics/operator.hpp>

namespace tactus::mechanics {

/// The master device as a plant: amplifier → motor –cable– drum –linkage– handle ← hand, with an encoder on the motor
/// (paper A, Figs. 2 and 10), a vibrotactile actuator on the handle (Sec. IV) and a force sensor between handle and
/// hand. The defaults are paper A's Table I; the paper gives no such actuator and its master has no force sensor: their
/// lags, limits and noise are assumed.
///
/// It runs on the plant's substeps; the sensors are read at the servo tick.
class CableDrivenMaster {
 public:
  struct Params {
    CableChain::Params mechanism;
    CurrentAmplifier::Params amplifier;
    CurrentAmplifier::Params handle_actuator{.bandwidth_Hz = 1000.0, .limit_N = 2.0};
    Encoder::Params encoder{.resolution_m = 1e-5};
    ForceSensor::Params force_sensor{.seed = 2};
    static constexpr auto fields() {
      return List{field("mechanism", &Params::mechanism, "Motor, cable, drum, linkage and handle."),
                  field("amplifier", &Params::amplifier, "Current amplifier of the motor."),
                  field("handle_actuator", &Params::handle_actuator,
                        "Vibrotactile actuator: applies a force to the handle, idle unless commanded."),
                  field("encoder", &Params::encoder, "Position encoder on the motor."),
                  field("force_sensor", &Params::force_sensor, "Force sensor between handle and hand.")};
    }
  };

  struct Input {
    double commanded_force_N = 0.0;         ///< to the amplifier, positive toward the environment
    double commanded_handle_force_N = 0.0;  ///< to the handle's actuator, same sign
    double grip_position_m = 0.0;           ///< where the hand wants the handle, at the middle of the substep
    double grip_velocity_m_per_s = 0.0;
  };
  using Output = CableChain::Output;
  /// What the master's sensors read.
  struct Reading {
    double motor_position_m = 0.0;
    double hand_force_N = 0.0;  ///< positive when the hand pushes the handle toward the environment
  };

  /// A master held by a hand with the impedance `grip`.
  static Result<CableDrivenMaster> make(const Params& params, const LinearSpring::Params& grip, Seconds dt);
  /// A master that nobody holds.
  static Result<CableDrivenMaster> make(const Params& params, Seconds dt) { return make(params, nobody_holds, dt); }

  /// Advances by one substep. Real-time safe.
  Output step(const Input& input) noexcept {
    const Output output = mechanism_.step({.motor_force_N = amplifier_.step(input.commanded_force_N),
                                           .tip_force_N = handle_actuator_.step(input.commanded_handle_force_N),
                                           .grip_position_m = input.grip_position_m,
                                           .grip_velocity_m_per_s = input.grip_velocity_m_per_s});
    force_sensor_.step(output.grip_force_N);
    return output;
  }

  /// The hand's impedance is `grip` from now on, which must be one that `make` takes. Real-time safe.
  void hold(const LinearSpring::Params& grip) noexcept { mechanism_.hold(grip); }

  /// What the sensors read now: draws one sample of noise.
  Reading measure() noexcept {
    return {.motor_position_m = encoder_.step(mechanism_.motor_position_m()), .hand_force_N = force_sensor_.sample()};
  }

  void reset() noexcept { reset(0.0); }
  /// At rest with every mass at `position_m`.
  void reset(double position_m) noexcept;

  [[nodiscard]] const CableChain& mechanism() const noexcept { return mechanism_; }
  [[nodiscard]] const CurrentAmplifier& amplifier() const noexcept { return amplifier_; }

 private:
  CableDrivenMaster(const CableChain& mechanism, const CurrentAmplifier& amplifier,
                    const CurrentAmplifier& handle_actuator, const Encoder& encoder, const ForceSensor& force_sensor)
      : mechanism_(mechanism),
        amplifier_(amplifier),
        handle_actuator_(handle_actuator),
        encoder_(encoder),
        force_sensor_(force_sensor) {}

  CableChain mechanism_;
  CurrentAmplifier amplifier_;
  CurrentAmplifier handle_actuator_;
  Encoder encoder_;
  ForceSensor force_sensor_;
};

}  // namespace tactus::mechanics
