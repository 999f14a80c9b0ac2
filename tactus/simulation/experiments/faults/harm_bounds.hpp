// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>

namespace tactus::experiments {

/// What an operator at the handle, and whoever is at the tool, may be exposed to by a fault: the largest that a run
/// survives with.
struct HarmBounds {
  double given_J = 0.25;
  double speed_m_per_s = 2.5;
  double strayed_m = 0.15;
  double hand_force_N = 20.0;
  double tool_force_N = 90.0;
  double pressing_N = 10.0;
  double release_s = 1.0;
  static constexpr auto fields() {
    return List{
        field("given_J", &HarmBounds::given_J, units::joule, positive, "Energy that a motor may deliver."),
        field("speed_m_per_s", &HarmBounds::speed_m_per_s, units::metre_per_second, positive,
              "Speed that handle and tool may reach."),
        field("strayed_m", &HarmBounds::strayed_m, units::metre, positive,
              "Distance that handle and tool may move beyond the ends of the operator's path."),
        field("hand_force_N", &HarmBounds::hand_force_N, units::newton, positive, "Force between hand and handle."),
        field("tool_force_N", &HarmBounds::tool_force_N, units::newton, positive,
              "Force between the tool and what it touches."),
        field("pressing_N", &HarmBounds::pressing_N, units::newton, positive,
              "Lasting force between hand and handle, or between the tool and what it touches."),
        field("release_s", &HarmBounds::release_s, units::second, positive,
              "Time from the instant at which both sites are in hold or fault until the motors apply no force.")};
  }
};

}  // namespace tactus::experiments
