// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/signals.hpp>

namespace tactus::station {

/// A control cycle of a one-axis teleoperator and of what it drives. Positions and forces as at the tick; contact over
/// the tick that follows.
struct TeleoperatorRecord {
  double time_s = 0.0;
  double master_position_m = 0.0;         ///< measured, at the motor
  double induced_position_m = 0.0;        ///< the model's estimate of what the force did to it
  double command_m = 0.0;                 ///< position command that left the master
  double slave_position_m = 0.0;          ///< measured, at the motor
  double tip_position_m = 0.0;            ///< of the slave, true
  double displayed_force_N = 0.0;         ///< at the motor, positive when it pushes the hand back
  double handle_force_N = 0.0;            ///< to the handle's actuator, positive toward the environment
  double hand_force_N = 0.0;              ///< measured, positive when the hand pushes toward the environment
  double sent_force_N = 0.0;              ///< tip force that the slave sent, positive when the slave is pushed back
  double contact_force_N = 0.0;           ///< true, mean until the next tick
  double peak_contact_force_N = 0.0;      ///< true, largest substep until the next tick
  bool touched = false;                   ///< the tip met the wall by the next tick
  double touched_at_s = 0.0;              ///< when, if so
  double estimated_grip = 1.0;            ///< of the hand, over identified, as the master's controller assumes
  double estimated_grip_deviation = 0.0;  ///< standard deviation of that; 0 where nothing is estimated
  /// For logs and exports. All is translated to the operator's hand.
  static constexpr auto signals() {
    constexpr const char* onward = "toward the environment";
    constexpr const char* back = "pushes the hand back";
    return List{
        observed("time_s", &TeleoperatorRecord::time_s, units::second, "", "", "",
                 "Virtual time of the control cycle."),
        observed("master_position_m", &TeleoperatorRecord::master_position_m, units::metre, "master", "hand", onward,
                 "Measured, at the motor."),
        observed("induced_position_m", &TeleoperatorRecord::induced_position_m, units::metre, "master", "hand", onward,
                 "The model's estimate of what the displayed force did to the master's position."),
        observed("command_m", &TeleoperatorRecord::command_m, units::metre, "master", "slave", onward,
                 "Position command that left the master."),
        observed("slave_position_m", &TeleoperatorRecord::slave_position_m, units::metre, "slave", "slave", onward,
                 "Measured, at the motor."),
        observed("tip_position_m", &TeleoperatorRecord::tip_position_m, units::metre, "slave", "slave", onward,
                 "Of the slave's tip, true."),
        observed("displayed_force_N", &TeleoperatorRecord::displayed_force_N, units::newton, "master", "hand", back,
                 "Force that the gate let through to the master's motor."),
        observed("handle_force_N", &TeleoperatorRecord::handle_force_N, units::newton, "master", "hand", onward,
                 "Force of the actuator on the handle."),
        observed("hand_force_N", &TeleoperatorRecord::hand_force_N, units::newton, "master", "hand", onward,
                 "Measured force of the hand on the handle."),
        observed("sent_force_N", &TeleoperatorRecord::sent_force_N, units::newton, "slave", "slave",
                 "the slave is pushed back", "Tip force that the slave sent to the master, measured or estimated."),
        observed("contact_force_N", &TeleoperatorRecord::contact_force_N, units::newton, "environment", "slave",
                 "the wall is pressed", "True, mean until the next control cycle."),
        observed("peak_contact_force_N", &TeleoperatorRecord::peak_contact_force_N, units::newton, "environment",
                 "slave", "the wall is pressed", "True, largest substep until the next control cycle."),
        observed("touched", &TeleoperatorRecord::touched, units::none, "environment", "", "",
                 "The tip met the wall by the next control cycle."),
        observed("touched_at_s", &TeleoperatorRecord::touched_at_s, units::second, "environment", "", "",
                 "When the tip met the wall, where it did; else 0."),
        observed("estimated_grip", &TeleoperatorRecord::estimated_grip, units::none, "master", "hand", "",
                 "How firmly the operator holds, over identified, as the master's controller assumes."),
        observed("estimated_grip_deviation", &TeleoperatorRecord::estimated_grip_deviation, units::none, "master",
                 "hand", "", "Standard deviation of that; 0 where nothing is estimated.")};
  }
};

}  // namespace tactus::station
