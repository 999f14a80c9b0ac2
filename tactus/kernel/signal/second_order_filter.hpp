// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/checks.hpp>
#include <tactus/kernel/signal/sections.hpp>

#include <array>
#include <cmath>
#include <numbers>

namespace tactus::signal {

/// What a `SecondOrderFilter` lets through.
enum class FilterKind { low_pass, high_pass, notch };

/// The words for a filter kind in a file.
constexpr auto enumerators(FilterKind) {
  return std::array{Enumerator<FilterKind>{FilterKind::low_pass, "low-pass"},
                    Enumerator<FilterKind>{FilterKind::high_pass, "high-pass"},
                    Enumerator<FilterKind>{FilterKind::notch, "notch"}};
}

/// Second-order low-pass, high-pass (both Butterworth) or notch.
///
///     low-pass   H(s) = 1 / (s² + √2 s + 1)      high-pass   H(s) = s² / (s² + √2 s + 1)       (s over ω_c)
///     notch      H(s) = (s² + ω_0²) / (s² + B s + ω_0²)
///
/// Bilinear transform, every named frequency prewarped by its own tangent: the gain is −3 dB exactly at `frequency_Hz`
/// (low-pass, high-pass), exactly zero there (notch), and the two −3 dB edges of the notch are exactly
/// `notch_width_Hz` apart. A design by quality factor instead (frequency over width, warped together) gives a width
/// that shrinks toward half the sample rate.
/// Stable for 0 < frequency, width < half the sample rate. Starts at rest at zero; `settle` starts elsewhere.
/// Sources: Oppenheim and Schafer, Discrete-Time Signal Processing, section 7.2; P. A. Regalia and S. K. Mitra, Tunable
/// digital frequency response equalization filters, IEEE Trans. ASSP 35(1), 1987 (the notch as (1 + allpass) / 2).
class SecondOrderFilter {
 public:
  struct Params {
    FilterKind kind = FilterKind::low_pass;
    double frequency_Hz = 300.0;
    double notch_width_Hz = 50.0;
    static constexpr auto fields() {
      return List{
          field("kind", &Params::kind, "What passes: low-pass, high-pass or notch (all but a band)."),
          field("frequency_Hz", &Params::frequency_Hz, units::hertz, positive,
                "The -3 dB frequency of a low-pass or high-pass, the centre of a notch; below half the sample rate."),
          field("notch_width_Hz", &Params::notch_width_Hz, units::hertz, positive,
                "Distance between the two -3 dB frequencies of a notch, below half the sample rate; the other kinds "
                "have no width.")};
    }
  };
  using Input = double;
  using Output = double;

  static Result<SecondOrderFilter> make(const Params& params, Seconds dt) {
    if (Check error = check(params, dt)) return *std::move(error);
    if (Check error = check_below_nyquist("frequency_Hz", params.frequency_Hz, dt)) return *std::move(error);
    SecondOrderFilter filter;
    if (params.kind == FilterKind::notch) {
      if (Check error = check_below_nyquist("notch_width_Hz", params.notch_width_Hz, dt)) return *std::move(error);
      const double g = std::tan(std::numbers::pi * params.notch_width_Hz * dt.value);
      const double b0 = 1.0 / (1.0 + g);
      const double b1 = -2.0 * b0 * std::cos(2.0 * std::numbers::pi * params.frequency_Hz * dt.value);
      filter.section_ = {.b0 = b0, .b1 = b1, .b2 = b0, .a1 = b1, .a2 = (1.0 - g) * b0};
      return filter;
    }
    const double k = std::tan(std::numbers::pi * params.frequency_Hz * dt.value);
    const double scale = 1.0 / (1.0 + std::numbers::sqrt2 * k + k * k);
    const bool low = params.kind == FilterKind::low_pass;
    const double b0 = low ? k * k * scale : scale;
    filter.section_ = {.b0 = b0,
                       .b1 = low ? 2.0 * b0 : -2.0 * b0,
                       .b2 = b0,
                       .a1 = 2.0 * (k * k - 1.0) * scale,
                       .a2 = (1.0 - std::numbers::sqrt2 * k + k * k) * scale};
    filter.gain_at_rest_ = low ? 1.0 : 0.0;
    return filter;
  }

  /// The filtered sample. Real-time safe.
  double step(double input) noexcept { return section_.step(input); }

  /// Back to rest at zero.
  void reset() noexcept { settle(0.0); }

  /// Takes on the state of a filter whose input has been `value` forever, so that a signal that starts there starts
  /// without a transient. Real-time safe.
  void settle(double value) noexcept {
    const double output = gain_at_rest_ * value;
    section_.state_1 = output - section_.b0 * value;
    section_.state_2 = section_.b2 * value - section_.a2 * output;
  }

  /// Coefficients and state as they are.
  [[nodiscard]] const SecondOrderSection<double>& section() const noexcept { return section_; }

 private:
  SecondOrderFilter() = default;
  SecondOrderSection<double> section_;
  double gain_at_rest_ = 1.0;
};

}  // namespace tactus::signal
