// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/motor_bus.hpp>
#include <tactus/kernel/core/result.hpp>

#include <cstddef>
#include <limits>
#include <span>

namespace tactus::devices {

/// What a motor can do, at its output.
struct MotorAbility {
  double torque_Nm = 0.0;           ///< largest torque; 0: it accepts no command; infinite: not known
  double velocity_rad_per_s = 0.0;  ///< largest velocity that its messages can represent; 0: not known
  /// Step in which it reports a velocity of its own, not derived from the position. Position and velocity are then
  /// compared (`control::MotionCheck`), and thresholds of the gate follow from the joint's limits. 0: it reports none.
  double velocity_step_rad_per_s = 0.0;
  /// Farthest position of a joint, in either direction from the motor's zero; infinite: not known.
  double position_rad = std::numeric_limits<double>::infinity();
  /// Largest gains of the law that it runs by itself; both 0: it runs none.
  double stiffness_Nm_per_rad = 0.0, damping_Nms_per_rad = 0.0;
};

/// Base class of your own driver: an arm, a handle or a controller that is reached by calls that block. You write what
/// one cycle does; tactus runs it on a thread of its own (`BlockingLink`), stamps and ages the readings, limits the
/// commands, and stops the motors when commands stop or a reading is too old.
///
/// All functions but `motors`, `cycle_s` and `ability` are called on that thread, one after another. They may block,
/// allocate and throw. If the first `open` or the first `exchange` throws or returns an error, the run does not start.
/// If a later `exchange` does, `close` is called, both sites hold with the reason, and `open` is called again every
/// second until it and an `exchange` without torque succeed. The operator can then arm the sites again.
///
/// **The device must remove its torque by itself when `exchange` is no longer called**, within `watchdog_s` of the rig
/// file: the program may be killed at any time. Controllers of robots do; if yours does not, do not drive it.
class BlockingDriver {
 public:
  virtual ~BlockingDriver() = default;

  /// Number of motors, 1 to `most_joints`; constant. They are the joints of the rig file, in its order.
  [[nodiscard]] virtual std::size_t motors() const noexcept = 0;
  /// Shortest time from one call of `exchange` to the next, in s, above 0. A device that paces its caller by blocking
  /// for longer sets the cycle itself.
  [[nodiscard]] virtual double cycle_s() const noexcept { return 0.001; }
  /// Limits of a motor below `motors()`. A rig file that exceeds them is refused.
  [[nodiscard]] virtual MotorAbility ability(std::size_t /*motor*/) const noexcept {
    return {.torque_Nm = std::numeric_limits<double>::infinity()};
  }

  /// Connects, without torque. Errors: why the device cannot be used, with the remedy.
  virtual Check open() = 0;
  /// One cycle: sends a command to every motor and stores what it reports. Position (rad), velocity (rad/s), torque
  /// (N m), temperature, fault and `enabled` of `readings` are yours; the time stamps are set by the caller. Both
  /// are in the motor's own sense: a positive torque must move a free motor up (`MotorJoint` has the sign rule). A
  /// motor whose command is not `enabled` must have no torque. Errors: why the device cannot be driven at present.
  virtual Check exchange(std::span<const MotorCommand> commands, std::span<MotorReading> readings) = 0;
  /// Removes all torque and disconnects. Called once after each `open`, whether or not that succeeded.
  virtual void close() noexcept = 0;
};

}  // namespace tactus::devices
