// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/units.hpp>
#include <tactus/kernel/core/parameters.hpp>

namespace tactus::arm {

/// A hand that holds a tool: a spring and a damper from the tool to where the hand wants it, in every direction alike,
/// and a mass that moves with it. It holds the tool's attitude as two such springs would at `lever_m` to either
/// side of it: by stiffness·lever² in N m/rad, and damped so.
struct HandImpedance {
  double mass_kg = 0.1;
  double stiffness_N_per_m = 60.0;
  double damping_N_s_per_m = 10.0;
  double lever_m = 0.0;
  static constexpr auto fields() {
    using H = HandImpedance;
    return List{field("mass_kg", &H::mass_kg, tactus::units::kilogram, between(0.0, 5.0),
                      "Mass of the hand that moves with the tool."),
                field("stiffness_N_per_m", &H::stiffness_N_per_m, tactus::units::newton_per_metre, between(0.0, 1e5),
                      "Stiffness of the hand in each direction."),
                field("damping_N_s_per_m", &H::damping_N_s_per_m, tactus::units::newton_second_per_metre,
                      between(0.0, 1e4), "Damping of the hand in each direction."),
                field("lever_m", &H::lever_m, tactus::units::metre, between(0.0, 0.5),
                      "Half of the breadth of the grip: lever arm with which the hand resists a rotation of the tool; "
                      "0: the tool turns freely in the hand.")};
  }
};

}  // namespace tactus::arm
