// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/arm_vibration/released_law.hpp>

#include <cmath>
#include <cstddef>

namespace tactus::experiments {

ReleasedLaw::ReleasedLaw(const Params& params, const arm::Chain& chain)
    : chain_(chain),
      joints_(params.joints.of(static_cast<std::size_t>(chain.joints()))),
      velocity_share_(params.velocity_share),
      friction_share_(params.friction_share),
      stiffness_(arm::JointVector::Zero(chain.joints())),
      damping_(stiffness_) {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    stiffness_[static_cast<Eigen::Index>(i)] = joints_[i].stiffness_N_m_per_rad;
    damping_[static_cast<Eigen::Index>(i)] = joints_[i].damping_N_m_s_per_rad;
  }
}

Result<ReleasedLaw> ReleasedLaw::make(const Params& params, const arm::Chain::Params& arm) {
  if (Check wrong = validate(params)) return *std::move(wrong);
  const auto chain = arm::Chain::make(arm);
  if (!chain) return chain.error();
  return ReleasedLaw(params, *chain);
}

arm::ArmCommand ReleasedLaw::command(const arm::ArmReading& own, const arm::JointVector& other_position,
                                     const arm::JointVector& other_velocity) const noexcept {
  arm::ArmCommand told{.position = other_position,
                       .velocity = velocity_share_ * other_velocity,
                       .stiffness = stiffness_,
                       .damping = damping_,
                       .torque = chain_.gravity_torque(own.position)};
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const ReleasedJoint& joint = joints_[i];
    const auto at = static_cast<Eigen::Index>(i);
    const double v = own.velocity[at];
    told.torque[at] += friction_share_ * (joint.coulomb_N_m * std::tanh(0.1 * joint.turn_s_per_rad * v) +
                                          joint.viscous_N_m_s_per_rad * v + joint.offset_N_m);
  }
  return told;
}

}  // namespace tactus::experiments
