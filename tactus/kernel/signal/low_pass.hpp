// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/checks.hpp>
#include <tactus/kernel/signal/sections.hpp>

#include <cmath>
#include <cstdint>
#include <numbers>

namespace tactus::signal {

/// First-order low-pass, H(s) = 1 / (1 + s/ω_c): gain 1 at rest, −3 dB and −45° exactly at `cutoff_Hz`.
///
/// Bilinear transform with the cutoff prewarped: k = tan(π·cutoff·dt), H(z) = k (1 + z⁻¹) / ((1 + k) + (k − 1) z⁻¹).
/// The obvious form, y += (1 − exp(−ω_c·dt))·(u − y), is exact for a held input, but its −3 dB point leaves the name
/// behind as the cutoff nears the sample rate, and it has no zero there. For an input that really is held, see
/// `mechanics::CurrentAmplifier`.
/// Stable for 0 < cutoff < half the sample rate. Starts at rest at zero; `settle` starts elsewhere.
/// Source: Oppenheim and Schafer, Discrete-Time Signal Processing, section 7.2.
class LowPass {
 public:
  struct Params {
    double cutoff_Hz = 300.0;
    static constexpr auto fields() {
      return List{field("cutoff_Hz", &Params::cutoff_Hz, units::hertz, positive,
                        "Frequency at which the gain has fallen by 3 dB; below half the sample rate.")};
    }
  };
  using Input = double;
  using Output = double;

  static Result<LowPass> make(const Params& params, Seconds dt) {
    if (Check error = check(params, dt)) return *std::move(error);
    if (Check error = check_below_nyquist("cutoff_Hz", params.cutoff_Hz, dt)) return *std::move(error);
    const double k = std::tan(std::numbers::pi * params.cutoff_Hz * dt.value);
    const double b = k / (1.0 + k);
    LowPass filter;
    filter.section_ = {.b0 = b, .b1 = b, .a1 = (k - 1.0) / (k + 1.0)};
    return filter;
  }

  /// The filtered sample. Real-time safe.
  double step(double input) noexcept { return section_.step(input); }
  /// The last of `samples` filtered samples of one input. Real-time safe.
  double step(double input, std::int64_t samples) noexcept {
    if (samples > 1) {
      const double settled = (1.0 - section_.b0) * input;
      section_.state = settled + std::pow(-section_.a1, static_cast<double>(samples - 1)) * (section_.state - settled);
    }
    return section_.step(input);
  }

  /// Back to rest at zero.
  void reset() noexcept { settle(0.0); }

  /// Takes on the state of a filter whose input has been `value` forever, so that a signal that starts there starts
  /// without a transient. Real-time safe.
  void settle(double value) noexcept { section_.state = (1.0 - section_.b0) * value; }

  /// Coefficients and state as they are.
  [[nodiscard]] const FirstOrderSection<double>& section() const noexcept { return section_; }

 private:
  LowPass() = default;
  FirstOrderSection<double> section_;
};

}  // namespace tactus::signal
