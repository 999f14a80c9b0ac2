// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/low_pass.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace tactus::control {

/// Whether the force sensor at a tip can be right, from the balance of forces on the device: below the bandwidth of its
/// inertia what the motor gives arrives at the tip, but for friction.
///
///     | low-pass(F_motor − F_tip) | ≤ residual_limit
///
/// The residual of a sensor that dropped out is the force of contact, that of a bias the bias. Inertia adds m·Δv/τ for
/// a change of velocity Δv within the time constant τ of the low-pass, and friction adds itself, so the limit must be
/// above both. What is smaller passes unseen. After a gap the low-pass continues as if the difference had been there
/// all along, but no longer than a tenth of its time constant, about as long as an impact: one reading alone proves
/// nothing. Like a momentum observer with its mass set to zero (A. De Luca and R. Mattone, Sensorless robot collision
/// detection, ICRA 2005).
class ForceSensorCheck {
 public:
  struct Params {
    double residual_limit_N = 20.0;
    double cutoff_Hz = 8.0;
    static constexpr auto fields() {
      return List{field("residual_limit_N", &Params::residual_limit_N, units::newton, positive_up_to(200.0),
                        "Largest low-passed difference between the motor's force and the sensor's."),
                  field("cutoff_Hz", &Params::cutoff_Hz, units::hertz, between(0.1, 200.0),
                        "Corner frequency of the low-pass on this difference.")};
    }
  };
  struct Input {
    double acted_N = 0.0;            ///< of the motor, positive toward the environment
    double tip_force_N = 0.0;        ///< of the sensor, positive when the environment pushes back
    std::int64_t elapsed_ticks = 1;  ///< since the step before
  };
  using Output = bool;

  static Result<ForceSensorCheck> make(const Params& params, Seconds dt) {
    if (auto error = signal::check(params, dt)) return *std::move(error);
    const auto low_pass = signal::LowPass::make({.cutoff_Hz = params.cutoff_Hz}, dt);
    if (!low_pass) return low_pass.error();
    const double time_constant_s = 1.0 / (2.0 * std::numbers::pi * params.cutoff_Hz);
    return ForceSensorCheck(params.residual_limit_N, *low_pass, std::lround(0.1 * time_constant_s / dt.value));
  }

  /// True where the sensor cannot be right. Both forces must be finite. Real-time safe.
  bool step(const Input& input) noexcept {
    const std::int64_t samples = std::min(input.elapsed_ticks, most_ticks_);
    return std::fabs(low_pass_.step(input.acted_N - input.tip_force_N, samples)) > residual_limit_N_;
  }
  /// No difference so far.
  void reset() noexcept { low_pass_.reset(); }

 private:
  ForceSensorCheck(double residual_limit_N, const signal::LowPass& low_pass, std::int64_t most_ticks)
      : residual_limit_N_(residual_limit_N), most_ticks_(most_ticks), low_pass_(low_pass) {}

  double residual_limit_N_;
  std::int64_t most_ticks_;  ///< that one reading counts for
  signal::LowPass low_pass_;
};

}  // namespace tactus::control
