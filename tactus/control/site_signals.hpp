#pragma once

#include <tactus/control/drive_law.hpp>
#include <tactus/core/joints.hpp>
#include <tactus/core/signals.hpp>

#include <cmath>

/// What the two sites of a teleoperator measure, command and tell one another, and what a controller of a site is. Of
/// one axis each, or, as `Joints` of the same, of a device of several; positions and forces are positive toward the
/// environment unless said otherwise.
namespace tactus::control {

/// What one site tells the other at a tick. Each architecture fills the members that it uses; the rest stay zero.
///
/// Its one description: what is checked, mended and sent over a network follows from it, in this order.
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

/// The newest message of the other site. A site gets one every tick; `fresh` tells whether it arrived since the last.
struct Arrival {
  Message message;
  bool fresh = false;
};

/// What the master's sensors read at a tick, and what came from the slave.
struct MasterInput {
  double motor_position_m = 0.0;
  double hand_force_N = 0.0;  ///< of the hand on the handle, positive when it pushes toward the environment
  Arrival arrival;
  double grip = 1.0;         ///< how firmly the person holds, over nominal, where a sensor tells; 1 without one
  double motor_age_s = 0.0;  ///< of the position at this tick; negative where it is younger
  DriveTells motor_tells = {};
};

/// How firmly the person holds the handle and what else differs from the model that was identified, as the master's
/// controller believes it. Where nothing is estimated, as identified and without deviation.
struct HandEstimate {
  double estimated_grip = 1.0;
  double estimated_grip_deviation = 0.0;
  double linkage_excess = 0.0;
  static constexpr auto signals() {
    using R = HandEstimate;
    return List{observed("estimated_grip", &R::estimated_grip, units::none, "master", "hand", "",
                         "How firmly the person holds, over identified."),
                observed("estimated_grip_deviation", &R::estimated_grip_deviation, units::none, "master", "hand", "",
                         "Standard deviation of that; 0 where nothing is estimated."),
                observed("linkage_excess", &R::linkage_excess, units::none, "master", "hand", "",
                         "By which share the linkage is estimated to be stiffer than identified.")};
  }
};

/// What the master commands and tells, and what its stages made of it, for the log.
struct MasterOutput {
  double motor_force_N = 0.0;   ///< positive toward the environment; a force that pushes the hand back is negative
  double handle_force_N = 0.0;  ///< of a second, vibrotactile actuator on the handle, same sign; zero without one
  Message message;
  double induced_position_m = 0.0;   ///< the estimate of what the displayed force did to the motor, at this instant
  double intended_position_m = 0.0;  ///< measured less induced
  HandEstimate hand = {};
  DriveLaw law = {};       ///< what the motor's drive gives beside `motor_force_N`
  double support_N = 0.0;  ///< of `motor_force_N`, what carries the device: it stays where the rest fades
};

/// What the slave's sensors read at a tick, and what came from the master.
struct SlaveInput {
  double motor_position_m = 0.0;
  double tip_force_N = 0.0;  ///< positive when the environment pushes the slave back
  Arrival arrival;
  double motor_age_s = 0.0;  ///< of the position at this tick; negative where it is younger
  DriveTells motor_tells = {};
};

/// What the slave commands and tells.
struct SlaveOutput {
  double motor_force_N = 0.0;  ///< positive toward the environment
  Message message;
  DriveLaw law = {};       ///< what the motor's drive gives beside `motor_force_N`
  double support_N = 0.0;  ///< of `motor_force_N`, what carries the device: it stays where the rest fades
};

/// Whether every number that a site reads is one, and what drives tell is of motors. Real-time safe.
inline bool is_finite(const DriveTells& tells) noexcept {
  return can_be_told(tells.velocity_m_per_s) && can_be_told(tells.force_N);
}
inline bool is_finite(const Message& message) noexcept {
  bool finite = true;
  for_each_signal<Message>([&](const auto& each) { finite = finite && std::isfinite(message.*each.member); });
  return finite;
}
inline bool is_finite(const MasterInput& input) noexcept {
  return std::isfinite(input.motor_position_m) && std::isfinite(input.motor_age_s) &&
         std::isfinite(input.hand_force_N) && std::isfinite(input.grip) && is_finite(input.motor_tells) &&
         is_finite(input.arrival.message);
}
inline bool is_finite(const SlaveInput& input) noexcept {
  return std::isfinite(input.motor_position_m) && std::isfinite(input.motor_age_s) &&
         std::isfinite(input.tip_force_N) && is_finite(input.motor_tells) && is_finite(input.arrival.message);
}

template <class T>
bool is_finite(const Joints<T>& joints) noexcept {
  bool finite = true;
  for (const T& each : joints) finite = finite && is_finite(each);
  return finite;
}

/// What the force sensor says that pushes back against the motor, in N: the hand, or what is at the tip. Real-time
/// safe.
inline double resisting_N(const MasterInput& input) noexcept { return -input.hand_force_N; }
inline double resisting_N(const SlaveInput& input) noexcept { return input.tip_force_N; }

/// Puts what was read last in the place of each number that is none. Real-time safe.
inline void mend(double& value, double last) noexcept {
  if (!std::isfinite(value)) value = last;
}
inline void mend(DriveTells& tells, const DriveTells& last) noexcept {
  if (!can_be_told(tells.velocity_m_per_s)) tells.velocity_m_per_s = last.velocity_m_per_s;
  if (!can_be_told(tells.force_N)) tells.force_N = last.force_N;
}
inline void mend(Message& message, const Message& last) noexcept {
  for_each_signal<Message>([&](const auto& each) { mend(message.*each.member, last.*each.member); });
}
inline void mend(MasterInput& input, const MasterInput& last) noexcept {
  mend(input.motor_position_m, last.motor_position_m);
  mend(input.motor_age_s, last.motor_age_s);
  mend(input.hand_force_N, last.hand_force_N);
  mend(input.grip, last.grip);
  mend(input.motor_tells, last.motor_tells);
  mend(input.arrival.message, last.arrival.message);
}
inline void mend(SlaveInput& input, const SlaveInput& last) noexcept {
  mend(input.motor_position_m, last.motor_position_m);
  mend(input.motor_age_s, last.motor_age_s);
  mend(input.tip_force_N, last.tip_force_N);
  mend(input.motor_tells, last.motor_tells);
  mend(input.arrival.message, last.arrival.message);
}

}  // namespace tactus::control
