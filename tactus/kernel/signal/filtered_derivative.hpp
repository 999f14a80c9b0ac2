// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/scalar.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace tactus::signal {

/// The arithmetic of a `FilteredDerivative`. A template on the scalar, and made of nothing else: a sweep runs it in
/// lanes.
template <class Scalar>
struct FilteredDerivativeMotion {
  Scalar smoothing{}, rate_per_s{};
  Scalar previous{}, velocity{};
  Scalar samples{};  ///< 0 before the first, then 1

  constexpr Scalar step(const Scalar& position) noexcept {
    const Scalar before = select(samples > 0.0, previous, position);
    velocity = velocity + smoothing * ((position - before) * rate_per_s - velocity);
    previous = position;
    samples = 1.0;
    return velocity;
  }
};

/// Velocity (1/s times the unit of the input) from sampled positions, low-passed at `cutoff_Hz`.
///
/// v += α·((x − x_before)/dt − v). The pole 1 − α is placed so that at the cutoff the gain is exactly 3 dB below that
/// of the ideal differentiator, 2π·cutoff/√2. With x = π·cutoff·dt and m = 4x²·sin²x / (2 sin²x − x²) that asks for
/// α² = m·(1 − α), and the root that lies between 0 and 1 is α = m / (√(m + m²/4) + m/2).
///
/// The usual α = ω_c·dt / (1 + ω_c·dt) puts the −3 dB point 16 % too low at a fifteenth of the sample rate, and the
/// pole exp(−ω_c·dt) 1 % too low at a fifth; a bilinear differentiator would ring at half the sample rate.
///
/// The first sample after `make` or `reset` gives zero velocity: only a difference is evidence of motion, so a position
/// that starts far from zero gives no kick. A ramp gives its exact slope once the transient is over.
/// Range: 0 < cutoff < 0.44 of the sample rate; beyond, a backward difference alone has already lost 3 dB.
class FilteredDerivative {
 public:
  struct Params {
    double cutoff_Hz = 300.0;
    static constexpr auto fields() {
      return List{field("cutoff_Hz", &Params::cutoff_Hz, units::hertz, positive,
                        "Frequency at which the gain is 3 dB below that of an ideal differentiator; below 0.44 of "
                        "the sample rate.")};
    }
  };
  using Input = double;
  using Output = double;

  static Result<FilteredDerivative> make(const Params& params, Seconds dt) {
    if (Check error = check(params, dt)) return *std::move(error);
    const double highest_Hz = 0.44 / dt.value;
    if (params.cutoff_Hz >= highest_Hz) {
      return Error{.code = ErrorCode::inconsistent,
                   .parameter = "cutoff_Hz",
                   .message = rounded_number(params.cutoff_Hz) + " Hz must lie below " + rounded_number(highest_Hz) +
                              " Hz, 0.44 of the sample rate: lower the cutoff or sample faster",
                   .place = {}};
    }
    const double x = std::numbers::pi * params.cutoff_Hz * dt.value;
    const double sine2 = std::sin(x) * std::sin(x);
    const double m = 4.0 * x * x * sine2 / (2.0 * sine2 - x * x);
    FilteredDerivative derivative;
    derivative.motion_.smoothing = m / (std::sqrt(m + 0.25 * m * m) + 0.5 * m);
    derivative.motion_.rate_per_s = 1.0 / dt.value;
    return derivative;
  }

  /// The velocity at this sample. Real-time safe.
  double step(double position) noexcept { return motion_.step(position); }
  /// The same where `elapsed_samples` sample times have passed since the sample before: what as many samples on the
  /// straight line between the two would have given. Real-time safe.
  double step(double position, std::int64_t elapsed_samples) noexcept {
    return step_after(position, static_cast<double>(std::max<std::int64_t>(elapsed_samples, 1)));
  }
  /// The same after any positive number of sample times, whole or not. Real-time safe.
  double step_after(double position, double samples) noexcept {
    if (samples == 1.0 || motion_.samples == 0.0) return motion_.step(position);
    const double slope = (position - motion_.previous) / samples * motion_.rate_per_s;
    motion_.velocity = slope + std::pow(1.0 - motion_.smoothing, samples) * (motion_.velocity - slope);
    motion_.previous = position;
    return motion_.velocity;
  }

  /// At rest; the next sample only initialises.
  void reset() noexcept {
    motion_.previous = 0.0;
    motion_.velocity = 0.0;
    motion_.samples = 0.0;
  }

  [[nodiscard]] const FilteredDerivativeMotion<double>& motion() const noexcept { return motion_; }

 private:
  FilteredDerivative() = default;
  FilteredDerivativeMotion<double> motion_;
};

}  // namespace tactus::signal
