#pragma once

#include <tactus/arm_control/motor_watch.hpp>
#include <tactus/experiments/arm_tapping/arm_pair.hpp>
#include <tactus/station/device.hpp>

#include <cstddef>

/// An arm whose motors are compared with what they are commanded, as a device of a site.
namespace tactus::experiments {

/// The watch of one arm of a pair, by `[rig.motor_watch]`. Errors: those of `MotorWatch::make`, under
/// `rig.motor_watch`.
inline Result<arm_control::MotorWatch> motor_watch(const ArmPairSetup& setup, bool leads) {
  const arm_plants::ArmPlant::Params& arm = (leads ? setup.leader : setup.follower).arm;
  auto made = arm_control::MotorWatch::make(setup.params.rig.motor_watch, arm.chain, arm.tool_m,
                                            Seconds{1.0 / setup.params.servo.rate_Hz});
  if (!made) return under("rig.motor_watch", made.error());
  return made;
}

/// What the watch makes of a reading, `commanded` being what acts on the drives since before it; joints behind those of
/// the arm are not judged. Real-time safe.
inline const arm_control::MotorWatch::Found& watch(arm_control::MotorWatch& motors,
                                                   const Joints<station::DeviceReading>& read,
                                                   const Joints<station::DeviceCommand>& commanded,
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
    const station::DeviceReading& joint = read[static_cast<std::size_t>(i)];
    const station::DeviceCommand& command = commanded[static_cast<std::size_t>(i)];
    input.reading.position[i] = joint.position_m;
    input.reading.velocity[i] = joint.motor_tells.velocity_m_per_s;
    input.reading.torque[i] = joint.motor_tells.force_N;
    input.commanded[i] = command.force_N + command.law.force_N(joint.position_m, joint.motor_tells.velocity_m_per_s);
    input.powered = input.powered && command.enabled;
  }
  return motors.step(input);
}

/// In front of a device that outlives it: `lost` once a motor does not do as it is commanded, until the site takes the
/// power. All but `limits` is real-time safe as far as the device is.
class WatchedArm final : public station::JointDevice {
 public:
  WatchedArm(station::JointDevice& device, const arm_control::MotorWatch& motors)
      : device_(&device), motors_(motors), commanded_(device.limits().size(), {.enabled = false}) {}

  [[nodiscard]] Joints<station::DeviceLimits> limits() const override { return device_->limits(); }
  [[nodiscard]] bool simulated() const noexcept override { return device_->simulated(); }
  Joints<station::DeviceReading> read(const station::Tick& tick) noexcept override {
    const auto read = device_->read(tick);
    watch(motors_, read, commanded_, tick.missed + 1);
    return read;
  }
  void write(const Joints<station::DeviceCommand>& command) noexcept override {
    commanded_ = command;
    device_->write(command);
  }
  [[nodiscard]] station::DeviceHealth health() const noexcept override {
    return found().what == arm_control::MotorFinding::none ? device_->health() : station::DeviceHealth::lost;
  }
  [[nodiscard]] const arm_control::MotorWatch::Found& found() const noexcept { return motors_.found(); }

 private:
  station::JointDevice* device_;
  arm_control::MotorWatch motors_;
  Joints<station::DeviceCommand> commanded_;
};

}  // namespace tactus::experiments
