#pragma once

#include <array>

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
inline constexpr Unit metre{"m", "_m"};
inline constexpr Unit metre_per_second{"m/s", "_m_per_s"};
inline constexpr Unit newton{"N", "_N"};
inline constexpr Unit newton_per_second{"N/s", "_N_per_s"};
inline constexpr Unit newton_per_metre{"N/m", "_N_per_m"};
inline constexpr Unit newton_per_metre5{"N/m^5", "_N_per_m5"};
inline constexpr Unit newton_second_per_metre{"N s/m", "_N_s_per_m"};
inline constexpr Unit second_per_metre{"s/m", "_s_per_m"};
inline constexpr Unit kilogram{"kg", "_kg"};
inline constexpr Unit per_second{"1/s", "_per_s"};
inline constexpr Unit cycles{"cycles", "_cycles"};

/// Every unit there is, for reading a unit off the end of a name.
inline constexpr std::array all{none, second, hertz, metre, metre_per_second, newton, newton_per_second, newton_per_metre, newton_per_metre5, newton_second_per_metre, second_per_metre, kilogram, per_second, cycles};
}  // namespace units

}  // namespace tactus
