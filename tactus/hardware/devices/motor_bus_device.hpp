// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/motor_joint.hpp>
#include <tactus/hardware/devices/motor_link.hpp>
#include <tactus/kernel/station/device.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace tactus::devices {

/// What keeps a device from being good.
enum class Trouble : std::int64_t {
  none,
  late,            ///< a motor's answer is old
  not_responding,  ///< its last reply is too old to act on, or the motor reports that it received no command
  bus_ended,       ///< the port was closed
  bus_refused,     ///< a motor is not what the file reports
  position,        ///< a joint is where it may have no power
  velocity,        ///< it is faster than it may be
  temperature,     ///< its motor is hotter than it may be
  motor_fault,     ///< its motor reports that something is wrong
  no_power,        ///< its motor was asked to have power and is off
  guard_gone,      ///< the guard process of its motors is gone, see `GuardState`
  guard_acted      ///< this program was stopped, and the guard process has switched its motors off
};
constexpr auto enumerators(Trouble) {
  return std::array{Enumerator{Trouble::none, "none"},
                    Enumerator{Trouble::late, "late"},
                    Enumerator{Trouble::not_responding, "not-responding"},
                    Enumerator{Trouble::bus_ended, "bus-ended"},
                    Enumerator{Trouble::bus_refused, "bus-refused"},
                    Enumerator{Trouble::position, "position"},
                    Enumerator{Trouble::velocity, "velocity"},
                    Enumerator{Trouble::temperature, "temperature"},
                    Enumerator{Trouble::motor_fault, "motor-fault"},
                    Enumerator{Trouble::no_power, "no-power"},
                    Enumerator{Trouble::guard_gone, "guard-gone"},
                    Enumerator{Trouble::guard_acted, "guard-acted"}};
}

/// That, and whose it is.
struct DeviceTrouble {
  Trouble what = Trouble::none;
  std::size_t joint = 0;  ///< the first that has it, or the one whose answer is oldest
  MotorFault fault = MotorFault::none;
  std::int64_t status = no_status;  ///< of its motor, as its protocol has it
  double age_s = 0.0;               ///< of the oldest answer
  double cycle_age_s = 0.0;  ///< since a cycle of the bus ended, whoever answered: old where our own thread was stopped
};

/// Motors behind a bus as the joints of a device, in the order that they have there; forces are torques in Nm,
/// positions rad, both of the joint. A motor's torque is computed from its current, so it is no reading of a hand: the
/// force that is read is 0, and torque and velocity are what the motor reports (`motor_report`).
///
/// Where a joint has limits for it, its motor runs the law of the command by itself. Torque and law together are held
/// to the joint's torque limit at the newest reading, in one share; until the next command the motor continues by that
/// law, so what it gives may leave the limit by the stiffness times the way. When commands stop, it does so until the
/// bus's silence or its own watchdog takes its power.
///
/// `good` while every motor has answered within `late`, `degraded` when the oldest answer is older, `not_responding`
/// when it is older than `silence`, `lost` when the bus ended or refused its motors, or when a joint that is to have
/// power is where, as fast or as hot as it may not be, has a motor with a fault, or has no power a quarter of a second
/// after it was asked for. Not responding and lost stay until a command enables nothing: then it is judged again. A
/// motor that gives no force gets no power, and is judged by its age alone. Wait-free but for `limits`.
class MotorBusDevice final : public station::JointDevice {
 public:
  struct Params {
    Joints<MotorJoint> joints;  ///< one for each motor
    double late_s = 0.01;
    double silence_s = 0.05;
  };
  /// On a link that outlives it, with a motor for each joint. Errors: `inconsistent`.
  static Result<std::unique_ptr<MotorBusDevice>> make(MotorLink& bus, const Params& params);
  MotorBusDevice(const MotorBusDevice&) = delete;
  MotorBusDevice& operator=(const MotorBusDevice&) = delete;
  /// Takes the power.
  ~MotorBusDevice() override;

  [[nodiscard]] Joints<station::DeviceLimits> limits() const override;
  Joints<station::DeviceReading> read(const station::Tick& tick) noexcept override;
  void write(const Joints<station::DeviceCommand>& command) noexcept override;
  [[nodiscard]] station::DeviceHealth health() const noexcept override { return health_; }
  /// What `health` was judged by.
  [[nodiscard]] const DeviceTrouble& trouble() const noexcept { return trouble_; }

 private:
  MotorBusDevice(MotorLink& bus, const Params& params);
  void judge(const DeviceTrouble& trouble) noexcept;
  [[nodiscard]] DeviceTrouble found() noexcept;

  MotorLink* bus_;
  Params params_;
  BusReadings last_;
  BusCommands commands_;
  Joints<station::DeviceReading> reading_;
  std::int64_t now_ns_ = 0;
  std::array<std::int64_t, most_joints> wanted_since_ns_{};
  std::array<bool, most_joints> had_power_{}, placed_{};
  std::array<double, most_joints> turns_rad_{};  ///< whole turns between the motor's number and the joint
  DeviceTrouble trouble_;
  station::DeviceHealth health_ = station::DeviceHealth::degraded;
};

}  // namespace tactus::devices
