// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/wire/wire_end.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/result.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>

/// Motors and handles : commands to them, and the meaning of their replies.
namespace tactus::devices {

/// What is between a motor and a force.
enum class MotorFault : std::int64_t {
  none,
  not_responding,  ///< it did not answer for longer than the bus allows
  voltage,         ///< too high or too low
  current,         ///< too high
  hot,             ///< the drive or the winding
  lost_master,     ///< the motor's own watchdog: it received no command
  overload,        ///< too much torque for too long, or a shock
  encoder,         ///< it does not know where it is
  refused,         ///< it refused what was asked of it
  unknown_status,  ///< it reports a status that this driver does not know, and counts as one with power
  stays_on         ///< it was commanded to switch off and has not reported in time that it is off
};
constexpr auto enumerators(MotorFault) {
  return std::array{
      Enumerator{MotorFault::none, "none"},         Enumerator{MotorFault::not_responding, "not-responding"},
      Enumerator{MotorFault::voltage, "voltage"},   Enumerator{MotorFault::current, "current"},
      Enumerator{MotorFault::hot, "hot"},           Enumerator{MotorFault::lost_master, "lost-master"},
      Enumerator{MotorFault::overload, "overload"}, Enumerator{MotorFault::encoder, "encoder"},
      Enumerator{MotorFault::refused, "refused"},   Enumerator{MotorFault::unknown_status, "unknown-status"},
      Enumerator{MotorFault::stays_on, "stays-on"}};
}

/// The status of a motor that has not reported one.
inline constexpr std::int64_t no_status = -1;

/// What a motor reported last, in its own sense of turning (see `MotorJoint`), at the output of its gear. Positions
/// continue where the wire's number wraps. Trivially copyable: it crosses from the bus thread to the tick.
struct MotorReading {
  double position_rad = 0.0;
  double velocity_rad_per_s = 0.0;
  double torque_Nm = 0.0;  ///< from the current; not of a sensor
  double temperature_C =
      std::numeric_limits<double>::quiet_NaN();  ///< the hotter of those that it reports; NaN: not reported
  MotorFault fault = MotorFault::none;
  std::int64_t enabled = 0;         ///< 1 where the drive has power, or a status that is not known
  std::int64_t off = 0;             ///< 1 once it has reported that it has no power, since it was last to have any
  std::int64_t status = no_status;  ///< as its protocol has it, see `status_text`
  std::int64_t received_ns = -1;    ///< when its last good answer arrived; negative: never
  std::int64_t answers = 0;         ///< good ones, since the start
};

/// The law that a motor runs by itself in addition to the commanded torque, at the rate of its current loop and
/// without the bus's delay, in its own sense of turning, at the output of its gear:
///
///     stiffness·(position − its own) + damping·(velocity − its own)
///
/// Positions as those of `MotorReading`: they continue where the wire's number wraps. It continues by its last law
/// until the next command, or until it loses its power.
struct MotorLaw {
  double position_rad = 0.0;
  double velocity_rad_per_s = 0.0;
  double stiffness_Nm_per_rad = 0.0;
  double damping_Nms_per_rad = 0.0;

  [[nodiscard]] bool acts() const noexcept { return stiffness_Nm_per_rad != 0.0 || damping_Nms_per_rad != 0.0; }
};

/// What a motor is asked for.
struct MotorCommand {
  double torque_Nm = 0.0;    ///< at the output of the gear
  std::int64_t enabled = 0;  ///< 0: no power
  MotorLaw law = {};         ///< comes to the torque
};

/// What a motor reported of itself when it was asked, for a user. Empty: not reported.
struct MotorSheet {
  std::string model;             ///< what it must be by its report, where that is not what was stated
  std::string scales;            ///< of its numbers
  std::string firmware;          ///< its version
  double torque_limit_Nm = 0.0;  ///< the largest that it is sent, at its output; 0: it gives no force
  Check problem;                 ///< what is wrong with it, with the remedy
};

/// How far a bus is with its motors.
enum class BusState : std::int64_t {
  asking,  ///< who is there, and whether they are what the file reports; no motor has power
  ready,   ///< one cycle after another; power where a command enables it
  refused  ///< something is wrong, see `MotorBus::problem`; no motor has power
};
constexpr auto enumerators(BusState) {
  return std::array{Enumerator{BusState::asking, "asking"}, Enumerator{BusState::ready, "ready"},
                    Enumerator{BusState::refused, "refused"}};
}

/// The driver of all motors behind one wire. As soon as it is driven, it asks who is there and checks their replies,
/// then it runs cycles: commands to all motors at once, answers collected until all are there or a deadline passed, and
/// the next. A motor that does not respond costs no other its data.
///
/// A motor that is to have no power is commanded so in every cycle until it has reported that it is off (`OffWatch`):
/// before it is asked anything, without a command that enables it, with a fault, and while the thread ends.
///
/// Real-time safe but for `problem` and `sheet`. Thread: that of the wire; `tactus/hardware/devices/bus_thread.hpp`
/// exchanges with a tick.
class MotorBus : public wire::WireEnd {
 public:
  [[nodiscard]] virtual std::size_t motors() const noexcept = 0;
  [[nodiscard]] virtual BusState state() const noexcept = 0;
  /// Why it is `refused`, with the motor and the remedy. Not real-time safe.
  [[nodiscard]] virtual Check problem() const = 0;
  /// Of a motor below `motors()`, complete unless the bus is still `asking`. Not real-time safe.
  [[nodiscard]] virtual MotorSheet sheet(std::size_t motor) const = 0;
  /// Of a motor below `motors()`.
  [[nodiscard]] virtual const MotorReading& reading(std::size_t motor) const noexcept = 0;
  /// From the next cycle on. A torque that is not a number, or beyond what the motor takes, is never sent: it counts as
  /// no power, respectively as the limit. So do the numbers of a law; beyond a limit torque and gains keep one share,
  /// so nothing grows. A motor that runs no law has no power while it is asked for one.
  virtual void command(std::size_t motor, const MotorCommand& wanted) noexcept = 0;
  /// Cycles that ended, whether or not all motors answered.
  [[nodiscard]] virtual std::int64_t cycles() const noexcept = 0;
};

}  // namespace tactus::devices
