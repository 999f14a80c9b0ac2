// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>

#include <array>
#include <cstdint>

namespace tactus::devices::damiao {

/// Motors of the DM series, as the maker calls them.
enum class Model : std::int64_t {
  dm3507,
  dm4310,
  dm4310_48v,
  dm4340,
  dm6006,
  dm8006,
  dm8009,
  dm10010l,
  dm10010,
  dmh6215,
  dmg6220
};
constexpr auto enumerators(Model) {
  return std::array{Enumerator{Model::dm3507, "DM3507"},         Enumerator{Model::dm4310, "DM4310"},
                    Enumerator{Model::dm4310_48v, "DM4310-48V"}, Enumerator{Model::dm4340, "DM4340"},
                    Enumerator{Model::dm6006, "DM6006"},         Enumerator{Model::dm8006, "DM8006"},
                    Enumerator{Model::dm8009, "DM8009"},         Enumerator{Model::dm10010l, "DM10010L"},
                    Enumerator{Model::dm10010, "DM10010"},       Enumerator{Model::dmh6215, "DMH6215"},
                    Enumerator{Model::dmg6220, "DMG6220"}};
}

/// What the ends of a frame's numbers stand for, each from minus to plus: registers PMAX, VMAX and TMAX.
struct Scale {
  double position_rad = 12.5;
  double velocity_rad_per_s = 30.0;
  double torque_Nm = 10.0;
};

/// The largest gains that a frame has a number for, of the law that each motor runs by itself.
inline constexpr double largest_stiffness_Nm_per_rad = 500.0, largest_damping_Nms_per_rad = 5.0;

/// As the maker delivers it. Public drivers disagree on DM3507 and DM4340, so what a motor reports must be compared.
constexpr Scale scale_of(Model model) {
  switch (model) {
    case Model::dm3507:
      return {12.5, 50.0, 5.0};
    case Model::dm4310:
      return {12.5, 30.0, 10.0};
    case Model::dm4310_48v:
      return {12.5, 50.0, 10.0};
    case Model::dm4340:
      return {12.5, 10.0, 28.0};
    case Model::dm6006:
      return {12.5, 45.0, 20.0};
    case Model::dm8006:
      return {12.5, 45.0, 40.0};
    case Model::dm8009:
      return {12.5, 45.0, 54.0};
    case Model::dm10010l:
      return {12.5, 25.0, 200.0};
    case Model::dm10010:
      return {12.5, 20.0, 200.0};
    case Model::dmh6215:
    case Model::dmg6220:
      return {12.5, 45.0, 10.0};
  }
  return {};
}

}  // namespace tactus::devices::damiao
