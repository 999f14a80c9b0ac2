// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/drive_law.hpp>
#include <tactus/kernel/core/joints.hpp>
#include <tactus/kernel/core/signals.hpp>

#include <cmath>

/// What the two sites of a teleoperator measure, command and send one another, and what a controller of a site is. Of
/// one axis each, or, as `Joints` of the same, of a device of several; positions and forces are positive toward the
/// environment unless stated otherwise.
namespace tactus::control {

/// What one site sends the other in a tick. Each architecture fills the members that it uses; the rest stay zero.
///
/// Its one description: what is checked, corrected and sent over a network follows from it, in this order.
struct Message {
  double position_m = 0.0;
  double velocity_m_per_s = 0.0;
  double force_N = 0.0;
  double wave = 0.0;
  double energy_J = 0.0;
  static constexpr auto signals() {
    return List{
        observed("position_m", &Message::position_m, units::metre, "", "slave", "toward the environment",
                 "Where the other site shall be, or where this one is."),
        observed("velocity_m_per_s", &Message::velocity_m_per_s, units::metre_per_second, "", "slave",
                 "toward the environment", "Of that position."),
        observed("force_N", &Message::force_N, units::newton, "", "slave", "the slave is pushed back",
                 "Tip force, or what the architecture makes of it."),
        observed("wave", &Message::wave, units::none, "", "", "", "Wave variable, in the square root of a watt."),
        observed("energy_J", &Message::energy_J, units::joule, "", "", "",
                 "Sent so far, a running total: a lost message then loses no energy.")};
  }
};

/// The newest message of the other site. A site gets one every tick; `fresh` reports whether it arrived since the last.
struct Arrival {
  Message message;
  bool fresh = false;
};

/// What the master's sensors read at a tick, and what came from the slave.
struct MasterInput {
  double motor_position_m = 0.0;
  double hand_force_N = 0.0;  ///< of the hand on the handle, positive when it pushes toward the environment
  Arrival arrival;
  double grip = 1.0;         ///< how firmly the operator holds, over nominal, if a sensor measures it; 1 without one
  double motor_age_s = 0.0;  ///< of the position at this tick; negative where it is younger
  DriveReport motor_report = {};
};

/// How firmly the operator holds the handle and what else differs from the model that was identified, as the master's
/// controller assumes it. Where nothing is estimated, as identified and without deviation.
struct HandEstimate {
  double estimated_grip = 1.0;
  double estimated_grip_deviation = 0.0;
  double linkage_excess = 0.0;
  static constexpr auto signals() {
    using R = HandEstimate;
    return List{observed("estimated_grip", &R::estimated_grip, units::none, "master", "hand", "",
                         "How firmly the operator holds, over identified."),
                observed("estimated_grip_deviation", &R::estimated_grip_deviation, units::none, "master", "hand", "",
                         "Standard deviation of that; 0 where nothing is estimated."),
                observed("linkage_excess", &R::linkage_excess, units::none, "master", "hand", "",
                         "By which share the linkage is estimated to be stiffer than identified.")};
  }
};

/// What the master commands and sends, and what its stages made of it, for the log.
struct MasterOutput {
  double motor_force_N = 0.0;   ///< positive toward the environment; a force that pushes the hand back is negative
  double handle_force_N = 0.0;  ///< of a second, vibrotactile actuator on the handle, same sign; zero without one
  Message message;
  double induced_position_m = 0.0;   ///< the estimate of what the displayed force did to the motor, at this instant
  double intended_position_m = 0.0;  ///< measured less induced
  HandEstimate hand = {};
  DriveLaw law = {};       ///< what the motor's drive gives alongside `motor_force_N`
  double support_N = 0.0;  ///< of `motor_force_N`, what carries the device: it stays where the rest fades
};

/// What the slave's sensors read at a tick, and what came from the master.
struct SlaveInput {
  double motor_position_m = 0.0;
  double tip_force_N = 0.0;  ///< positive when the environment pushes the slave back
  Arrival arrival;
  double motor_age_s = 0.0;  ///< of the position at this tick; negative where it is younger
  DriveReport motor_report = {};
};

/// What the slave commands and sends.
struct SlaveOutput {
  double motor_force_N = 0.0;  ///< positive toward the environment
  Message message;
  DriveLaw law = {};       ///< what the motor's drive gives alongside `motor_force_N`
  double support_N = 0.0;  ///< of `motor_force_N`, what carries the device: it stays where the rest fades
};

/// Whether every number is one. Real-time safe.
inline bool is_finite(const Message& message) noexcept {
  bool finite = true;
  for_each_signal<Message>([&](const auto& each) { finite = finite && std::isfinite(message.*each.member); });
  return finite;
}
template <class T>
bool is_finite(const Joints<T>& joints) noexcept {
  bool finite = true;
  for (const T& each : joints) finite = finite && is_finite(each);
  return finite;
}

/// What the force sensor states that pushes back against the motor, in N: the hand, or what is at the tip. Real-time
/// safe.
inline double resisting_N(const MasterInput& input) noexcept { return -input.hand_force_N; }
inline double resisting_N(const SlaveInput& input) noexcept { return input.tip_force_N; }

/// Takes over each number that is one, and of what a drive reports what is of motors; what was read last stays in the
/// place of the others. Whether all were taken. One number after the other, for a copy of the whole would wait for them
/// to be written. Real-time safe.
inline bool take_over(double& last, double read) noexcept {
  const bool finite = std::isfinite(read);
  if (finite) last = read;
  return finite;
}
inline bool take_over(DriveReport& last, const DriveReport& read) noexcept {
  const bool velocity = can_be_told(read.velocity_m_per_s), force = can_be_told(read.force_N);
  if (velocity) last.velocity_m_per_s = read.velocity_m_per_s;
  if (force) last.force_N = read.force_N;
  return velocity && force;
}
inline bool take_over(Arrival& last, const Arrival& read) noexcept {
  bool all = true;
  for_each_signal<Message>(
      [&](const auto& each) { all = take_over(last.message.*each.member, read.message.*each.member) && all; });
  last.fresh = read.fresh;
  return all;
}
inline bool take_over(MasterInput& last, const MasterInput& read) noexcept {
  bool all = take_over(last.motor_position_m, read.motor_position_m);
  all = take_over(last.motor_age_s, read.motor_age_s) && all;
  all = take_over(last.hand_force_N, read.hand_force_N) && all;
  all = take_over(last.grip, read.grip) && all;
  all = take_over(last.motor_report, read.motor_report) && all;
  return take_over(last.arrival, read.arrival) && all;
}
inline bool take_over(SlaveInput& last, const SlaveInput& read) noexcept {
  bool all = take_over(last.motor_position_m, read.motor_position_m);
  all = take_over(last.motor_age_s, read.motor_age_s) && all;
  all = take_over(last.tip_force_N, read.tip_force_N) && all;
  all = take_over(last.motor_report, read.motor_report) && all;
  return take_over(last.arrival, read.arrival) && all;
}

}  // namespace tactus::control
