// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/station/described_arms.hpp>

#include <cstddef>

namespace tactus::station {

namespace {

arm::JointVector of_each_motor(const DescribedArm& of, double arm::MotorParams::*number) {
  arm::JointVector found(of.start.size());
  for (std::size_t i = 0; i < of.arm.motors.size(); ++i) {
    found[static_cast<Eigen::Index>(i)] = of.arm.motors[i].*number;
  }
  return found;
}

}  // namespace

arm::JointVector DescribedArm::joint_stiffness_N_m_per_rad() const {
  return of_each_motor(*this, &arm::MotorParams::joint_stiffness_N_m_per_rad);
}
arm::JointVector DescribedArm::joint_damping_N_m_s_per_rad() const {
  return of_each_motor(*this, &arm::MotorParams::joint_damping_N_m_s_per_rad);
}

}  // namespace tactus::station
