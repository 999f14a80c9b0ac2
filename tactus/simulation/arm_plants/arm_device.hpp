// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/station/device.hpp>
#include <tactus/simulation/arm_plants/arm_plant.hpp>

#include <cstddef>
#include <utility>
#include <vector>

namespace tactus::arm_plants {

/// A simulated arm behind its bus, as the device of a site: drives that report velocity and torque and run a law, of
/// which a command acts from the next tick on. Sensors of torque in its joints, where something `touches` it, report
/// exactly that, as the force that pushes back.
///
/// A value: a copy continues by itself. A tick does not allocate.
class ArmDevice final : public station::JointDevice {
 public:
  using Reading = Joints<station::DeviceReading>;

  /// `limits` are those of each joint, beyond which nobody shall command it.
  /// A command acts `extra_delay_ticks` later than that.
  ArmDevice(ArmPlant plant, const Joints<station::DeviceLimits>& limits, std::size_t extra_delay_ticks = 0)
      : plant_(std::move(plant)),
        limits_(limits),
        reading_(limits.size()),
        on_its_way_(1 + extra_delay_ticks, Joints<station::DeviceCommand>(limits.size())) {}

  [[nodiscard]] Joints<station::DeviceLimits> limits() const override { return limits_; }
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  Reading read(const station::Tick&) noexcept override;
  /// The command before goes to the drives; one that takes the power leaves them no torque.
  void write(const Joints<station::DeviceCommand>& command) noexcept override;
  [[nodiscard]] station::DeviceHealth health() const noexcept override { return health_; }

  /// What touches the tool from outside at this tick, for the sensors in the joints.
  void touches(const ToolForce& on_tool) noexcept;
  /// What it states of itself from now on.
  void set_health(station::DeviceHealth health) noexcept { health_ = health; }
  /// One step of the arm.
  void step(const ToolForce& on_tool) { plant_.step(on_tool); }
  [[nodiscard]] const ArmPlant& plant() const noexcept { return plant_; }

 private:
  ArmPlant plant_;
  Joints<station::DeviceLimits> limits_;
  Reading reading_;
  std::vector<Joints<station::DeviceCommand>> on_its_way_;  ///< a ring
  std::size_t oldest_ = 0;
  station::DeviceHealth health_ = station::DeviceHealth::good;
};

}  // namespace tactus::arm_plants
