// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

/// What arithmetic that is written once for `double` and for a block of lanes needs beyond the operators.
///
/// A lane type brings, found by its arguments, its own `select`, `any`, `min`, `max`, `fabs`, `floor`, `copysign` and
/// `expm1`. Code that is a template on the scalar has no branch on a value but `any`.
namespace tactus {

/// Whether the condition holds in any lane; a `double` is one lane.
constexpr bool any(bool condition) noexcept { return condition; }

/// One value or the other, lane by lane.
template <class Scalar>
constexpr Scalar select(bool condition, const Scalar& yes, const Scalar& no) noexcept {
  return condition ? yes : no;
}

/// The value, or the limit that it lies beyond, for `least <= most`; what is not a number stays so.
template <class Scalar>
constexpr Scalar clamped(const Scalar& value, const Scalar& least, const Scalar& most) noexcept {
  using std::max;
  using std::min;
  return min(max(value, least), most);
}

}  // namespace tactus
