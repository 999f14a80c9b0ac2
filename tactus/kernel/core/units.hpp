// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

namespace tactus {

/// A duration in seconds. The one strong unit type that crosses the border into the loop: a sample time cannot be
/// confused with a rate, a gain or a count.
struct Seconds {
  double value;
  explicit constexpr Seconds(double seconds) : value(seconds) {}
};

/// A unit as it is printed, and as the name of a parameter or a recorded column ends.
struct Unit {
  const char* symbol;
  const char* suffix;
};

namespace units {
inline constexpr Unit none{"", ""};
inline constexpr Unit second{"s", "_s"};
inline constexpr Unit hertz{"Hz", "_Hz"};
inline constexpr Unit cycles{"cycles", "_cycles"};
inline constexpr Unit per_second{"1/s", "_per_s"};
inline constexpr Unit kilogram{"kg", "_kg"};
inline constexpr Unit metre{"m", "_m"};
inline constexpr Unit metre_per_second{"m/s", "_m_per_s"};
inline constexpr Unit second_per_metre{"s/m", "_s_per_m"};
inline constexpr Unit newton{"N", "_N"};
inline constexpr Unit newton_per_second{"N/s", "_N_per_s"};
inline constexpr Unit newton_per_metre{"N/m", "_N_per_m"};
inline constexpr Unit newton_per_metre5{"N/m^5", "_N_per_m5"};
inline constexpr Unit newton_second_per_metre{"N s/m", "_N_s_per_m"};
inline constexpr Unit joule{"J", "_J"};
inline constexpr Unit watt{"W", "_W"};
inline constexpr Unit milliampere{"mA", "_mA"};
inline constexpr Unit milliampere_per_metre{"mA/m", "_mA_per_m"};
inline constexpr Unit newton_per_milliampere{"N/mA", "_N_per_mA"};
inline constexpr Unit pascal{"Pa", "_Pa"};
inline constexpr Unit square_metre{"m^2", "_m2"};
inline constexpr Unit cubic_metre{"m^3", "_m3"};
inline constexpr Unit cubic_metre_per_second{"m^3/s", "_m3_per_s"};
inline constexpr Unit cubic_metre_per_second_per_pascal{"m^3/(s Pa)", "_m3_per_s_per_Pa"};

/// Every unit that the end of a name can determine, those of recordings among them.
inline constexpr std::array known{second,
                                  hertz,
                                  cycles,
                                  per_second,
                                  kilogram,
                                  metre,
                                  metre_per_second,
                                  second_per_metre,
                                  newton,
                                  newton_per_second,
                                  newton_per_metre,
                                  newton_per_metre5,
                                  newton_second_per_metre,
                                  joule,
                                  watt,
                                  milliampere,
                                  milliampere_per_metre,
                                  newton_per_milliampere,
                                  pascal,
                                  square_metre,
                                  cubic_metre,
                                  cubic_metre_per_second,
                                  cubic_metre_per_second_per_pascal,
                                  Unit{"ms", "_ms"},
                                  Unit{"us", "_us"},
                                  Unit{"ns", "_ns"},
                                  Unit{"mm", "_mm"},
                                  Unit{"mm/s", "_mm_per_s"},
                                  Unit{"m/s^2", "_m_per_s2"},
                                  Unit{"rad", "_rad"},
                                  Unit{"rad/s", "_rad_per_s"},
                                  Unit{"rad/s^2", "_rad_per_s2"},
                                  Unit{"deg", "_deg"},
                                  Unit{"mN", "_mN"},
                                  Unit{"kN", "_kN"},
                                  Unit{"N m", "_N_m"},
                                  Unit{"A", "_A"},
                                  Unit{"V", "_V"},
                                  Unit{"bar", "_bar"}};
}  // namespace units

/// The unit that the end of `name` states, the longest of those that fit (`torque_N_m` is in N m, not in m); none where
/// there is no such end or nothing before it.
constexpr Unit unit_at_end_of(std::string_view name) {
  Unit found = units::none;
  for (const Unit& unit : units::known) {
    const std::string_view suffix = unit.suffix;
    const bool fits = name.size() > suffix.size() && name.ends_with(suffix);
    if (fits && suffix.size() > std::string_view(found.suffix).size()) found = unit;
  }
  return found;
}

}  // namespace tactus
