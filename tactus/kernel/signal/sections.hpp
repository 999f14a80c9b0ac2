// SPDX-License-Identifier: Apache-2.0
#pragma once

/// The arithmetic of the linear filters, apart from how a frequency becomes coefficients.
///
/// Templates on the scalar, so that one source serves the servo (`double`) and a sweep (a block of lanes). Transposed
/// direct form II: two states for two orders, and the least round-off of the direct forms in floating point, because
/// each state holds a small difference and not a long history of the input.
/// Source: A. V. Oppenheim, R. W. Schafer, Discrete-Time Signal Processing, 3rd ed., section 6.3.
namespace tactus::signal {

/// y = (b0 + b1 z⁻¹) / (1 + a1 z⁻¹) · u.
template <class Scalar>
struct FirstOrderSection {
  Scalar b0{}, b1{}, a1{};
  Scalar state{};

  constexpr Scalar step(Scalar input) noexcept {
    const Scalar output = b0 * input + state;
    state = b1 * input - a1 * output;
    return output;
  }
};

/// y = (b0 + b1 z⁻¹ + b2 z⁻²) / (1 + a1 z⁻¹ + a2 z⁻²) · u.
template <class Scalar>
struct SecondOrderSection {
  Scalar b0{}, b1{}, b2{}, a1{}, a2{};
  Scalar state_1{}, state_2{};

  constexpr Scalar step(Scalar input) noexcept {
    const Scalar output = b0 * input + state_1;
    state_1 = b1 * input - a1 * output + state_2;
    state_2 = b2 * input - a2 * output;
    return output;
  }
};

}  // namespace tactus::signal
