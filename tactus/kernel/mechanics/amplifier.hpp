// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/scalar.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <cmath>
#include <numbers>

namespace tactus::mechanics {

/// The arithmetic of a `CurrentAmplifier`. A template on the scalar, and made of nothing else: a sweep runs it in
/// lanes.
template <class Scalar>
struct CurrentAmplifierMotion {
  Scalar gain{}, limit_N{};
  Scalar response{};       ///< of the way to the command, what is made by the end of a step
  Scalar mean_response{};  ///< and in the mean over it
  Scalar applied_N{};

  constexpr Scalar step(const Scalar& commanded_N) noexcept {
    const Scalar way_N = clamped<Scalar>(gain * commanded_N, -limit_N, limit_N) - applied_N;
    const Scalar mean_N = applied_N + mean_response * way_N;
    applied_N = applied_N + response * way_N;
    return mean_N;
  }
};

/// Current amplifier and motor constant: commanded force in, applied force out.
///
/// The gain, then the saturation, then a first-order lag: y ← y + (1 − exp(−2π·bandwidth·dt))·(clamp(gain·u, ±limit) −
/// y). That is exact for a command that is held over the step, as a digital controller holds it, at every step size and
/// bandwidth. The lag comes last, so the applied force also stays within the limit. Runs on the plant's substeps; the
/// output is the mean of the applied force over the step, its impulse over its length: exact too, and what a plant that
/// holds the force over its step must be given. The force at the step's end would come half a step early, and with it
/// everything that the device does. A bilinear low-pass would be wrong here for the same reason: it takes its input for
/// a straight line between samples.
/// Source: G. F. Franklin, J. D. Powell, M. Workman, Digital Control of Dynamic Systems, section 4.3 (hold
/// equivalents).
class CurrentAmplifier {
 public:
  struct Params {
    double gain = 1.0;
    double bandwidth_Hz = 5000.0;
    double limit_N = 10.0;
    static constexpr auto fields() {
      return List{field("gain", &Params::gain, units::none, between(0.0, 10.0),
                        "Applied force divided by commanded force; 1 if calibrated."),
                  field("bandwidth_Hz", &Params::bandwidth_Hz, units::hertz, positive,
                        "Corner frequency of the first-order lag."),
                  field("limit_N", &Params::limit_N, units::newton, positive,
                        "Largest force in either direction; above it the amplifier saturates.")};
    }
  };
  using Input = double;
  using Output = double;

  static Result<CurrentAmplifier> make(const Params& params, Seconds dt) {
    if (Check error = signal::check(params, dt)) return *std::move(error);
    CurrentAmplifier amplifier;
    amplifier.motion_.gain = params.gain;
    amplifier.motion_.limit_N = params.limit_N;
    const double lags = 2.0 * std::numbers::pi * params.bandwidth_Hz * dt.value;
    amplifier.motion_.response = -std::expm1(-lags);
    amplifier.motion_.mean_response = 1.0 - amplifier.motion_.response / lags;
    return amplifier;
  }

  /// Applied force in N, mean over the step, from the commanded force in N held over it. Real-time safe.
  double step(double commanded_N) noexcept { return motion_.step(commanded_N); }
  /// Applied force in N at the end of the last step: what a measurement of the current shows there.
  [[nodiscard]] double applied_force_N() const noexcept { return motion_.applied_N; }

  /// No current flows.
  void reset() noexcept { motion_.applied_N = 0.0; }

  [[nodiscard]] const CurrentAmplifierMotion<double>& motion() const noexcept { return motion_; }

 private:
  CurrentAmplifier() = default;
  CurrentAmplifierMotion<double> motion_;
};

}  // namespace tactus::mechanics
