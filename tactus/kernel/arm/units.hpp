// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/units.hpp>

/// Units of joints that turn. Of one that slides, read rad as m, N m as N and kg m^2 as kg.
namespace tactus::arm::units {

inline constexpr Unit radian{"rad", "_rad"};
inline constexpr Unit radian_per_second{"rad/s", "_rad_per_s"};
inline constexpr Unit newton_metre{"N m", "_N_m"};
inline constexpr Unit newton_metre_second_per_radian{"N m s/rad", "_N_m_s_per_rad"};
inline constexpr Unit kilogram_metre2{"kg m^2", "_kg_m2"};
inline constexpr Unit metre_per_second2{"m/s^2", "_m_per_s2"};

}  // namespace tactus::arm::units
