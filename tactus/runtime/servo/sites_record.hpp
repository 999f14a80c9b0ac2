// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/signals.hpp>
#include <tactus/kernel/station/site_pair.hpp>

#include <cstdint>

namespace tactus::runtime {

/// All that the sites read and all that they gave in one step: with the configuration, enough to step them again.
struct SitesRecord : Part<control::Message, "to_slave_">, Part<control::Message, "to_master_">, control::HandEstimate {
  using ToSlave = Part<control::Message, "to_slave_">;
  using ToMaster = Part<control::Message, "to_master_">;
  std::int64_t tap = 0;
  std::int64_t tick = 0;
  std::int64_t missed = 0;
  double master_position_m = 0.0;
  double hand_force_N = 0.0;
  double grip = 0.0;
  double slave_position_m = 0.0;
  double tip_force_N = 0.0;
  double master_force_N = 0.0;
  double handle_force_N = 0.0;
  double induced_position_m = 0.0;
  double intended_position_m = 0.0;
  double slave_force_N = 0.0;
  static constexpr auto signals() {
    using R = SitesRecord;
    return joined(
        List{observed("tap", &R::tap, units::none, "", "", "", "Number of the tap, from 0."),
             observed("tick", &R::tick, units::none, "", "", "",
                      "Number of the deadline in the tap, missed ones counted."),
             observed("missed", &R::missed, units::none, "", "", "", "Deadlines missed right before this one."),
             observed("master_position_m", &R::master_position_m, units::metre, "master", "hand",
                      "toward the environment", "Read at the motor."),
             observed("hand_force_N", &R::hand_force_N, units::newton, "master", "hand", "toward the environment",
                      "Read on the handle."),
             observed("grip", &R::grip, units::none, "master", "", "",
                      "Read: how firmly the operator holds, over nominal."),
             observed("slave_position_m", &R::slave_position_m, units::metre, "slave", "slave",
                      "toward the environment", "Read at the motor."),
             observed("tip_force_N", &R::tip_force_N, units::newton, "slave", "slave", "the slave is pushed back",
                      "Read at the tip."),
             observed("master_force_N", &R::master_force_N, units::newton, "master", "hand", "toward the environment",
                      "Commanded to the motor."),
             observed("handle_force_N", &R::handle_force_N, units::newton, "master", "hand", "toward the environment",
                      "Commanded to the actuator on the handle."),
             observed("induced_position_m", &R::induced_position_m, units::metre, "master", "hand",
                      "toward the environment", "Estimated effect of the displayed force."),
             observed("intended_position_m", &R::intended_position_m, units::metre, "master", "hand",
                      "toward the environment", "Measured less induced."),
             observed("slave_force_N", &R::slave_force_N, units::newton, "slave", "slave", "toward the environment",
                      "Commanded to the motor.")},
        ToSlave::signals(), ToMaster::signals(), control::HandEstimate::signals());
  }
};

/// The record of a step. Real-time safe.
SitesRecord recorded(std::int64_t tap, const station::Tick& tick, const station::BarePair::Output& step) noexcept;

}  // namespace tactus::runtime
