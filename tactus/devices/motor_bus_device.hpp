#pragma once

#include <tactus/devices/motor_joint.hpp>
#include <tactus/devices/motor_link.hpp>
#include <tactus/station/device.hpp>

#include <array>
#include <cstdint>
#include <memory>

namespace tactus::devices {

/// Motors behind a bus as the joints of a device, in the order that they have there; forces are torques in Nm,
/// positions rad, both of the joint. A motor's torque is told from its current, so it is no reading of a hand: the
/// force that is read is 0.
///
/// `good` while every motor has answered within `late`, `degraded` when the oldest answer is older, `lost` when it is
/// older than `silence`, when the bus ended or refused its motors, or when a joint that is to have power is where, as
/// fast or as hot as it may not be, has a motor with a fault, or has no power a quarter of a second after it was asked
/// for. Lost stays until a command enables nothing: then it is judged anew. A motor that gives no force gets no power,
/// and is judged by its age alone. Wait-free but for `limits`.
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

 private:
  MotorBusDevice(MotorLink& bus, const Params& params);
  [[nodiscard]] station::DeviceHealth judge() noexcept;

  MotorLink* bus_;
  Params params_;
  BusReadings last_;
  BusCommands commands_;
  Joints<station::DeviceReading> reading_;
  std::int64_t now_ns_ = 0;
  std::array<std::int64_t, most_joints> wanted_since_ns_{};
  std::array<bool, most_joints> had_power_{}, placed_{};
  std::array<double, most_joints> turns_rad_{};  ///< whole turns between the motor's number and the joint
  station::DeviceHealth health_ = station::DeviceHealth::degraded;
};

}  // namespace tactus::devices
