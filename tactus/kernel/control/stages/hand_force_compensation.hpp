// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/model/induced_motion_model.hpp>
#include <tactus/kernel/control/stages/stage.hpp>
#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/sections.hpp>

#include <complex>

namespace tactus::control {

/// The pole of the lightest mode of the master in the hand, in 1/s, of the two with positive imaginary part: motor and
/// drum as one mass on the linkage, the handle in the hand. The cable is taken as rigid, for its own mode lies far
/// above. Real where linkage and hand damp everything. Cold.
std::complex<double> linkage_mode(const MasterModel& master);

/// Undoes what the master does to a force between motor and hand, so that the hand gets what the slave felt:
/// paper A's future work (Kuchenbecker and Niemeyer, "Induced Master Motion in Force-Reflecting Teleoperation", Sec.
/// IX).
///
/// Between motor and hand lies a mode, `linkage_mode` s₁: the hand gets 9 dB too much at 75 Hz with the default master,
/// and too little above. The element puts zeros on that mode and well damped poles p at the edge of the band, each
/// mapped to z = exp(s·dt):
///
///     C(z) = g (1 − 2 Re z₁ z⁻¹ + |z₁|² z⁻²) / (1 − 2 Re z_p z⁻¹ + |z_p|² z⁻²),   s_p = 2π band_Hz (−1 + i)/√2
///
/// with g such that a constant force passes as it is. From motor to hand it leaves a Butterworth low-pass at the band's
/// edge, and what the handle's mass and the hand's damper filter above some 200 Hz. The price is force: above the band
/// it asks about (band_Hz·2π/|s₁|)² times as much of the motor, 7 times for 200 Hz, noise included.
///
/// Starts from the first sample, as if the force had always been that. With `band_Hz` 0 it is off and changes no bit.
class HandForceCompensation {
 public:
  struct Params {
    MasterModel master;
    double band_Hz = 0.0;
    static constexpr auto fields() {
      return List{field("master", &Params::master, "Mass of master and hand."),
                  field("band_Hz", &Params::band_Hz, units::hertz, non_negative,
                        "Where the force at the hand is 3 dB down; below half the servo rate; 0 is off.")};
    }
  };
  /// The force in N that the hand should get.
  using Input = double;
  /// The force in N for the motor.
  using Output = double;

  static constexpr int linear_states = 2;
  static constexpr std::optional<Unfit> not_on_lanes(const Params& params) {
    if (params.band_Hz == 0.0) return {};
    return Unfit{"band_Hz", "write 0"};
  }

  /// Errors: a value out of bounds; a band at or above half the sample rate; `inconsistent` where the model has no mode
  /// to undo.
  static Result<HandForceCompensation> make(const Params& params, Seconds dt);

  /// Real-time safe.
  double step(double force_N) noexcept {
    if (!on_) return force_N;
    if (!started_) settle(force_N);
    started_ = true;
    return section_.step(force_N);
  }
  void reset() noexcept {
    section_.state_1 = section_.state_2 = 0.0;
    started_ = false;
  }
  [[nodiscard]] bool on() const noexcept { return on_; }

 private:
  HandForceCompensation() = default;
  void settle(double force_N) noexcept {
    section_.state_1 = force_N - section_.b0 * force_N;
    section_.state_2 = section_.b2 * force_N - section_.a2 * force_N;
  }

  signal::SecondOrderSection<double> section_;
  bool on_ = false;
  bool started_ = false;
};

}  // namespace tactus::control
