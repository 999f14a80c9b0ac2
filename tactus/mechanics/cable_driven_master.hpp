#pragma once

#include <tactus/core/element.hpp>
#include <tactus/core/parameters.hpp>
#include <tactus/mechanics/amplifier.hpp>
#include <tactus/mechanics/cable_chain.hpp>
#include <tactus/mechanics/encoder.hpp>
#include <tactus/mechanics/operator.hpp>

namespace tactus::mechanics {

/// The master device as a plant: amplifier → motor –cable– drum –linkage– handle ← hand, and an encoder on the motor
/// (paper A, Figs. 2 and 10). The defaults are paper A's Table I.
///
/// It runs on the plant's substeps; the encoder is read at the servo tick.
class CableDrivenMaster {
 public:
  struct Params {
    CableChain::Params mechanism;
    CurrentAmplifier::Params amplifier;
    Encoder::Params encoder{.resolution_m = 1e-5};
    static constexpr auto fields() {
      return std::tuple{field("mechanism", &Params::mechanism, "Motor, cable, drum, linkage and handle."),
                        field("amplifier", &Params::amplifier, "Current amplifier of the motor."),
                        field("encoder", &Params::encoder, "Position encoder on the motor.")};
    }
  };

  struct Input {
    double commanded_force_N = 0.0;  ///< to the amplifier, positive toward the environment
    double grip_position_m = 0.0;    ///< where the hand wants the handle, at the middle of the substep
    double grip_velocity_m_per_s = 0.0;
  };
  using Output = CableChain::Output;

  /// A master held by a hand with the impedance `grip`.
  static Result<CableDrivenMaster> make(const Params& params, const LinearSpring::Params& grip, Seconds dt);
  /// A master that nobody holds.
  static Result<CableDrivenMaster> make(const Params& params, Seconds dt) { return make(params, nobody_holds, dt); }

  /// Advances by one substep. Real-time safe.
  Output step(const Input& input) noexcept {
    return mechanism_.step({.motor_force_N = amplifier_.step(input.commanded_force_N),
                            .grip_position_m = input.grip_position_m,
                            .grip_velocity_m_per_s = input.grip_velocity_m_per_s});
  }

  /// The hand's impedance is `grip` from now on, which must be one that `make` takes. Real-time safe.
  void hold(const LinearSpring::Params& grip) noexcept { mechanism_.hold(grip); }

  /// What the encoder reads now, in m.
  double measure() noexcept { return encoder_.step(mechanism_.motor_position_m()); }

  void reset() noexcept { reset(0.0); }
  /// At rest with every mass at `position_m`.
  void reset(double position_m) noexcept;

  [[nodiscard]] const CableChain& mechanism() const noexcept { return mechanism_; }

 private:
  CableDrivenMaster(const CableChain& mechanism, const CurrentAmplifier& amplifier, const Encoder& encoder)
      : mechanism_(mechanism), amplifier_(amplifier), encoder_(encoder) {}

  CableChain mechanism_;
  CurrentAmplifier amplifier_;
  Encoder encoder_;
};

}  // namespace tactus::mechanics
