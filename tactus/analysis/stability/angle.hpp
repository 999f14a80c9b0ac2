// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

namespace tactus::stability {

/// A whole turn, rad: f Hz are turn · f rad/s.
inline constexpr double turn = 2.0 * std::numbers::pi;
/// A radian, degrees.
inline constexpr double degree = 180.0 / std::numbers::pi;

}  // namespace tactus::stability
