// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <array>
#include <complex>

namespace tactus::signal {

/// What a `KalmanPredictor` takes the signal for.
enum class Kinematics { constant_velocity, constant_acceleration };

/// The words for kinematics in a file.
constexpr auto enumerators(Kinematics) {
  return std::array{Enumerator<Kinematics>{Kinematics::constant_velocity, "constant-velocity"},
                    Enumerator<Kinematics>{Kinematics::constant_acceleration, "constant-acceleration"}};
}

/// Prediction by the steady Kalman filter of a signal that moves at constant velocity or acceleration but for white
/// noise of density q² on the next derivative, measured with noise of deviation r:
///
///     y = x̂ + h·v̂ + h²/2·â,   h the horizon, the estimate with the newest sample in it, â = 0 for constant velocity.
///
/// These are the α-β and α-β-γ filters with the gains that are best for q/r; only this ratio matters. The larger it is,
/// the wider the band and the more noise passes. A ramp is predicted exactly in the steady state, a parabola by
/// constant-acceleration. Starts at rest at zero.
/// Sources: R. E. Kalman, J. Basic Engineering 82, 1960; P. R. Kalata, The tracking index, IEEE Trans. Aerospace and
/// Electronic Systems 20(2), 1984 (there the noise is held over a tick, here it is continuous).
class KalmanPredictor {
 public:
  struct Params {
    Kinematics kinematics = Kinematics::constant_acceleration;
    double process_noise = 3.0;
    double measurement_noise = 3e-6;
    double horizon_s = 0.0036;
    static constexpr auto fields() {
      return List{field("kinematics", &Params::kinematics,
                        "Motion model: constant velocity or constant acceleration, apart from the process noise."),
                  field("process_noise", &Params::process_noise, units::none, positive,
                        "q: standard deviation of the change, within one second, of the quantity that kinematics "
                        "names: velocity (signal/s) or acceleration (signal/s^2)."),
                  field("measurement_noise", &Params::measurement_noise, units::none, positive,
                        "r: standard deviation of a sample, in the unit of the signal; for an encoder its step divided "
                        "by the root of 12."),
                  field("horizon_s", &Params::horizon_s, units::second, between(0.0, 10.0),
                        "Time after the newest sample for which the signal is predicted.")};
    }
  };
  using Input = double;
  using Output = double;
  using Gain = std::array<double, 3>;

  /// Errors: a value out of bounds; `inconsistent` when no gain can be found in double precision, for noises that lie
  /// too far apart.
  static Result<KalmanPredictor> make(const Params& params, Seconds dt);

  /// The predicted sample. Real-time safe.
  double step(double input) noexcept;
  /// Back to rest at zero.
  void reset() noexcept { state_ = {}; }

  /// Of the signal, its change per tick and the change of that: α, β and γ (0 for constant velocity).
  [[nodiscard]] const Gain& gain() const noexcept { return gain_; }
  /// H at `frequency_Hz`, above 0 to half the sample rate.
  [[nodiscard]] std::complex<double> response(double frequency_Hz) const noexcept;
  /// RMS out over RMS in for white noise, from the impulse response. Not real-time safe.
  [[nodiscard]] double white_noise_gain() const noexcept;

 private:
  KalmanPredictor() = default;
  double sample_time_s_ = 0.0;
  double horizon_ticks_ = 0.0;
  Gain gain_{};
  Gain state_{};  ///< predicted for the next sample: signal, change per tick, change of that
};

}  // namespace tactus::signal
