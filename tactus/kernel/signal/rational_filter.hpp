// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <array>
#include <complex>
#include <cstddef>
#include <span>

namespace tactus::signal {

/// A rational function of s, coefficients by ascending power: numerator_2 is that of s².
struct RationalFunction {
  double numerator_0 = 1.0, numerator_1 = 0.0, numerator_2 = 0.0, numerator_3 = 0.0, numerator_4 = 0.0;
  double denominator_0 = 1.0, denominator_1 = 0.0, denominator_2 = 0.0, denominator_3 = 0.0, denominator_4 = 0.0;
  static constexpr auto fields() {
    using R = RationalFunction;
    return List{field("numerator_0", &R::numerator_0, units::none, any_finite, "Numerator, constant."),
                field("numerator_1", &R::numerator_1, units::none, any_finite, "Numerator, s."),
                field("numerator_2", &R::numerator_2, units::none, any_finite, "Numerator, s^2."),
                field("numerator_3", &R::numerator_3, units::none, any_finite, "Numerator, s^3."),
                field("numerator_4", &R::numerator_4, units::none, any_finite, "Numerator, s^4."),
                field("denominator_0", &R::denominator_0, units::none, any_finite, "Denominator, constant."),
                field("denominator_1", &R::denominator_1, units::none, any_finite, "Denominator, s."),
                field("denominator_2", &R::denominator_2, units::none, any_finite, "Denominator, s^2."),
                field("denominator_3", &R::denominator_3, units::none, any_finite, "Denominator, s^3."),
                field("denominator_4", &R::denominator_4, units::none, any_finite, "Denominator, s^4.")};
  }
  using Coefficients = std::array<double, 5>;
  [[nodiscard]] constexpr Coefficients numerator() const {
    return {numerator_0, numerator_1, numerator_2, numerator_3, numerator_4};
  }
  [[nodiscard]] constexpr Coefficients denominator() const {
    return {denominator_0, denominator_1, denominator_2, denominator_3, denominator_4};
  }
  static constexpr RationalFunction of(const Coefficients& n, const Coefficients& d) {
    return {n[0], n[1], n[2], n[3], n[4], d[0], d[1], d[2], d[3], d[4]};
  }
  /// The value at `s`.
  [[nodiscard]] std::complex<double> operator()(std::complex<double> s) const;
};

/// The highest power with a coefficient that is not zero; 0 for the zero polynomial.
std::size_t degree(std::span<const double> ascending);
/// All roots left of the imaginary axis (Routh's array). False for the zero polynomial.
bool is_hurwitz(std::span<const double> ascending);

/// A proper and stable rational function up to the fourth order, sampled by the bilinear transform: each integrator of
/// the controllable canonical form becomes the trapezoidal rule, and the one algebraic loop is solved in closed form.
/// So the response at f is that of the continuous function at tan(π·f·dt)/(π·dt).
///
/// Errors of `make`: `inconsistent`, naming numerator or denominator, when the function is improper or not stable.
/// Starts at rest at zero.
class RationalFilter {
 public:
  using Params = RationalFunction;
  using Input = double;
  using Output = double;

  static Result<RationalFilter> make(const Params& params, Seconds dt);

  /// The filtered sample. Real-time safe.
  double step(double input) noexcept {
    const RationalFunction::Coefficients known = half_advanced();
    double highest = input;
    for (std::size_t i = 0; i < order_; ++i) highest -= a_[i] * known[i];
    highest *= loop_;
    double output = b_[order_] * highest;
    for (std::size_t i = 0; i < order_; ++i) {
      x_[i] = known[i] + reach_[i] * highest;
      output += b_[i] * x_[i];
    }
    x_[order_] = highest;
    return output;
  }
  void reset() noexcept { x_ = {}; }

 private:
  RationalFilter() = default;
  /// The states at the new tick but for what the new highest derivative adds.
  [[nodiscard]] RationalFunction::Coefficients half_advanced() const noexcept {
    RationalFunction::Coefficients known{};
    double next_known = 0.0;
    for (std::size_t i = order_; i-- > 0;) {
      known[i] = x_[i] + half_dt_ * (x_[i + 1] + next_known);
      next_known = known[i];
    }
    return known;
  }

  std::size_t order_ = 0;
  double half_dt_ = 0.0;
  double loop_ = 1.0;                         // 1 / (1 + Σ a_i·reach_i)
  RationalFunction::Coefficients a_{}, b_{};  // monic denominator; numerator over the same factor
  RationalFunction::Coefficients reach_{};    // (dt/2)^(order − i)
  RationalFunction::Coefficients x_{};        // x_[i + 1] is the derivative of x_[i]
};

}  // namespace tactus::signal
