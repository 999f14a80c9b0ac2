// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/arm_plants/arm_device.hpp>

namespace tactus::arm_plants {

ArmDevice::Reading ArmDevice::read(const station::Tick&) noexcept {
  const ArmReading now = plant_.read();
  for (std::size_t i = 0; i < reading_.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    reading_[i].position_m = now.position[at];
    reading_[i].motor_report = {.velocity_m_per_s = now.velocity[at], .force_N = now.torque[at]};
  }
  return reading_;
}

void ArmDevice::write(const Joints<station::DeviceCommand>& command) noexcept {
  const JointVector none = JointVector::Zero(static_cast<Eigen::Index>(reading_.size()));
  ArmCommand acts{.position = none, .velocity = none, .stiffness = none, .damping = none, .torque = none};
  Joints<station::DeviceCommand>& told = on_its_way_[oldest_];
  for (std::size_t i = 0; i < told.size(); ++i) {
    if (!told[i].enabled) continue;
    const auto at = static_cast<Eigen::Index>(i);
    acts.position[at] = told[i].law.position_m;
    acts.velocity[at] = told[i].law.velocity_m_per_s;
    acts.stiffness[at] = told[i].law.stiffness_N_per_m;
    acts.damping[at] = told[i].law.damping_N_s_per_m;
    acts.torque[at] = told[i].force_N;
  }
  plant_.write(acts);
  told = command;
  oldest_ = oldest_ + 1 == on_its_way_.size() ? 0 : oldest_ + 1;
}

void ArmDevice::touches(const ToolForce& on_tool) noexcept {
  const JointVector torque = plant_.torque_of(on_tool);
  for (std::size_t i = 0; i < reading_.size(); ++i) reading_[i].force_N = -torque[static_cast<Eigen::Index>(i)];
}

}  // namespace tactus::arm_plants
