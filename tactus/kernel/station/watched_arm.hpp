// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm_control/motor_watch.hpp>
#include <tactus/kernel/station/arm_teleoperator_params.hpp>
#include <tactus/kernel/station/described_arms.hpp>
#include <tactus/kernel/station/device.hpp>

#include <cstddef>

/// An arm whose motors are compared with what they are commanded, as a device of a site.
namespace tactus::station {

/// The watch of one arm of a pair, by `[rig.motor_watch]`. Errors: those of `MotorWatch::make`, under
/// `rig.motor_watch`.
inline Result<arm_control::MotorWatch> motor_watch(const ArmTeleoperatorParams& params, const DescribedArm& of) {
  auto made = arm_control::MotorWatch::make(params.rig.motor_watch, of.arm.chain, of.arm.tool_m,
                                            Seconds{1.0 / params.servo.rate_Hz});
  if (!made) return under("rig.motor_watch", made.error());
  return made;
}

/// What the watch makes of a reading, `commanded` being what acts on the drives since before it; joints behind those of
/// the arm are not judged. Real-time safe.
inline const arm_control::MotorWatch::Found& watch(arm_control::MotorWatch& motors, const Joints<DeviceReading>& read,
                                                   const Joints<DeviceCommand>& commanded,
                                                   std::int64_t elapsed_ticks) noexcept {
  if (!motors.judges()) return motors.found();
  const Eigen::Index joints = motors.joints();
  arm_control::MotorWatch::Input input{.reading = {.position = arm::JointVector(joints),
                                                   .velocity = arm::JointVector(joints),
                                                   .torque = arm::JointVector(joints)},
                                       .commanded = arm::JointVector(joints),
                                       .powered = true,
                                       .elapsed_ticks = elapsed_ticks};
  for (Eigen::Index i = 0; i < joints; ++i) {
    const DeviceReading& joint = read[static_cast<std::size_t>(i)];
    const DeviceCommand& command = commanded[static_cast<std::size_t>(i)];
    input.reading.position[i] = joint.position_m;
    input.reading.velocity[i] = joint.motor_report.velocity_m_per_s;
    input.reading.torque[i] = joint.motor_report.force_N;
    input.commanded[i] = command.force_N + command.law.force_N(joint.position_m, joint.motor_report.velocity_m_per_s);
    input.powered = input.powered && command.enabled;
  }
  return motors.step(input);
}

/// In front of a device that outlives it: `lost` once a motor does not do as it is commanded, until the site takes the
/// power. All but `limits` is real-time safe as far as the device is.
class WatchedArm final : public JointDevice {
 public:
  WatchedArm(JointDevice& device, const arm_control::MotorWatch& motors)
      : device_(&device), motors_(motors), commanded_(device.limits().size(), {.enabled = false}) {}

  [[nodiscard]] Joints<DeviceLimits> limits() const override { return device_->limits(); }
  [[nodiscard]] bool simulated() const noexcept override { return device_->simulated(); }
  Joints<DeviceReading> read(const Tick& tick) noexcept override {
    const auto read = device_->read(tick);
    watch(motors_, read, commanded_, tick.missed + 1);
    return read;
  }
  void write(const Joints<DeviceCommand>& command) noexcept override {
    commanded_ = command;
    device_->write(command);
  }
  [[nodiscard]] DeviceHealth health() const noexcept override {
    return found().what == arm_control::MotorFinding::none ? device_->health() : DeviceHealth::lost;
  }
  [[nodiscard]] const arm_control::MotorWatch::Found& found() const noexcept { return motors_.found(); }

 private:
  JointDevice* device_;
  arm_control::MotorWatch motors_;
  Joints<DeviceCommand> commanded_;
};

}  // namespace tactus::station
