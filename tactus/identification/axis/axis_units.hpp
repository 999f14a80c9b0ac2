// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <string_view>

/// Units in which recordings of an axis state positions and forces.
namespace tactus::identification {

struct KnownUnit {
  std::string_view symbol;
  double factor;  ///< to m and N, of a rotary axis to rad and N m
  bool rotary;
};
inline constexpr std::array position_units{KnownUnit{"m", 1.0, false},
                                           KnownUnit{"cm", 1e-2, false},
                                           KnownUnit{"mm", 1e-3, false},
                                           KnownUnit{"um", 1e-6, false},
                                           KnownUnit{"rad", 1.0, true},
                                           KnownUnit{"mrad", 1e-3, true},
                                           KnownUnit{"deg", 0.017453292519943295, true}};
inline constexpr std::array force_units{
    KnownUnit{"N", 1.0, false},   KnownUnit{"mN", 1e-3, false},  KnownUnit{"kN", 1e3, false},
    KnownUnit{"N m", 1.0, true},  KnownUnit{"Nm", 1.0, true},    KnownUnit{"N*m", 1.0, true},
    KnownUnit{"N·m", 1.0, true},  KnownUnit{"N.m", 1.0, true},   KnownUnit{"mN m", 1e-3, true},
    KnownUnit{"mNm", 1e-3, true}, KnownUnit{"N cm", 1e-2, true}, KnownUnit{"kN m", 1e3, true}};

/// The unit of this symbol, or null.
inline const KnownUnit* find_unit(std::span<const KnownUnit> units, std::string_view symbol) {
  const auto found = std::find_if(units.begin(), units.end(), [&](const KnownUnit& u) { return u.symbol == symbol; });
  return found == units.end() ? nullptr : &*found;
}

}  // namespace tactus::identification
