// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/drive_law.hpp>
#include <tactus/kernel/core/joints.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/station/tick.hpp>

#include <array>

namespace tactus::station {

/// What a device can do, and what is never asked of it: `DeviceGuard` keeps it to that, whoever commands. 0: not
/// stated. Positions and forces as in `tactus/kernel/control/site.hpp`: positive toward the environment, translated to
/// the point where the operator, or the environment, touches it.
struct DeviceLimits {
  double force_N = 0.0;           ///< largest force of the motor, either way
  double handle_force_N = 0.0;    ///< of a second actuator on the handle; 0 without one
  double rate_N_per_s = 0.0;      ///< fastest change of either force
  double velocity_m_per_s = 0.0;  ///< fastest that the device may be
  double position_m = 0.0;        ///< farthest that it may be from zero
  /// Of the law that its drive runs by itself, largest gains; one that takes none leaves both 0. One that takes a law
  /// reports velocity and force of its motor.
  double stiffness_N_per_m = 0.0;
  double damping_N_s_per_m = 0.0;
  /// Step of the velocity that it reports. 0: it reports none of its own, or one that its driver derives from the
  /// position; then position and velocity are not compared (`control::MotionCheck`).
  double velocity_step_m_per_s = 0.0;
};

/// Whether a device can be trusted with the next tick.
enum class DeviceHealth {
  good,
  degraded,        ///< the reading is an old one
  not_responding,  ///< it is too old to act on; a newer one may come
  lost             ///< nothing it states or does can be relied on
};
constexpr auto enumerators(DeviceHealth) {
  return std::array{Enumerator{DeviceHealth::good, "good"}, Enumerator{DeviceHealth::degraded, "degraded"},
                    Enumerator{DeviceHealth::not_responding, "not-responding"}, Enumerator{DeviceHealth::lost, "lost"}};
}

struct DeviceReading {
  double position_m = 0.0;  ///< at the motor
  double force_N = 0.0;     ///< master: hand on the handle, positive toward the environment; slave: environment on the
                            ///< tip, positive when it pushes the slave back
  double grip = 1.0;        ///< master: how firmly the operator holds, over nominal, if a sensor measures it
  double age_s = 0.0;       ///< of the position at the tick's deadline; negative where it was measured after that
  control::DriveReport motor_report = {};
};

struct DeviceCommand {
  double force_N = 0.0;         ///< of the motor, positive toward the environment
  double handle_force_N = 0.0;  ///< of the second actuator, same sign
  bool enabled = true;          ///< false: the forces end at the rate limit, then the drive has no power
  control::DriveLaw law = {};   ///< comes to the motor's force, for a drive that takes one
};

/// Hardware of one axis, or of several joints behind one bus, or what stands for it: where a user plugs in. Once a tick
/// `read` and then `write` are called, on the servo thread; both and `health` must not allocate, lock, throw or block.
/// A bus that blocks has a thread of its own, and these exchange the newest values with it. The command holds until the
/// next one.
template <class Reading>
class DeviceOf {
 public:
  using Command = Each<Reading, DeviceCommand>;

  virtual ~DeviceOf() = default;
  /// Of each joint; their number is the number of joints. Not real-time safe.
  [[nodiscard]] virtual Each<Reading, DeviceLimits> limits() const = 0;
  /// Whether nobody can be hurt by it. Anything else needs limits of its own and gates that somebody has set.
  [[nodiscard]] virtual bool simulated() const noexcept { return false; }
  /// What the sensors read at this tick. A device that has nothing new gives its last reading and is `degraded`.
  virtual Reading read(const Tick& tick) noexcept = 0;
  /// To the actuators.
  virtual void write(const Command& command) noexcept = 0;
  /// Of the device as a whole.
  [[nodiscard]] virtual DeviceHealth health() const noexcept = 0;
};
/// Of one axis.
using Device = DeviceOf<DeviceReading>;
/// Of several joints.
using JointDevice = DeviceOf<Joints<DeviceReading>>;

}  // namespace tactus::station
