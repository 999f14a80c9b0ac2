// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/factr_law.hpp>

#include <cmath>

namespace tactus::arm_control {

FactrLaw::FactrLaw(const Params& params, const arm::Chain::Params& arm, const arm::Chain& chain)
    : params_(params),
      chain_(chain),
      lower_(chain.joints()),
      upper_(chain.joints()),
      target_(JointVector::Zero(chain.joints())),
      dither_sign_(JointVector::Ones(chain.joints())) {
  for (Eigen::Index i = 0; i < lower_.size(); ++i) {
    const arm::JointLimits& limits = arm.joints[static_cast<std::size_t>(i)].limits;
    lower_[i] = limits.lower_rad + params.limit_margin_rad;
    upper_[i] = limits.upper_rad - params.limit_margin_rad;
  }
}

/// (I − J⁺J)·torque: what is left beside the rows of J, made orthogonal. A row that the others explain, as in a
/// singular pose, has no say.
JointVector FactrLaw::without_moving_the_tool(const JointVector& position, JointVector torque) const noexcept {
  constexpr double least_share = 1e-6;
  arm::Jacobian rows = chain_.jacobian(position, chain_.joints() - 1, arm::Vector3::Zero());
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const double length = rows.row(i).norm();
    for (int round = 0; round < 2; ++round) {
      for (Eigen::Index before = 0; before < i; ++before) {
        rows.row(i) -= rows.row(before).dot(rows.row(i)) * rows.row(before);
      }
    }
    const double left = rows.row(i).norm();
    if (left > least_share * length) {
      rows.row(i) /= left;
    } else {
      rows.row(i).setZero();
    }
    torque -= rows.row(i).dot(torque) * rows.row(i).transpose();
  }
  return torque;
}

JointVector FactrLaw::step(const ArmReading& reading) noexcept {
  if (!started_) {
    target_ = reading.position;
    started_ = true;
  }
  const JointVector bias = chain_.bias(reading.position, reading.velocity);
  JointVector torque = without_moving_the_tool(reading.position,
                                               params_.null_space_stiffness_N_m_per_rad * (target_ - reading.position) -
                                                   params_.null_space_damping_N_m_s_per_rad * reading.velocity);
  torque += bias - chain_.gravity_torque(reading.position) - params_.damping_N_m_s_per_rad * reading.velocity;
  for (Eigen::Index i = 0; i < torque.size(); ++i) {
    const double q = reading.position[i];
    const double v = reading.velocity[i];
    if (q > upper_[i] || q < lower_[i]) {
      torque[i] -= params_.limit_stiffness_N_m_per_rad * (q - (q > upper_[i] ? upper_[i] : lower_[i])) +
                   params_.limit_damping_N_m_s_per_rad * v;
    }
    if (std::fabs(v) >= params_.dither_below_rad_per_s) continue;
    torque[i] += dither_sign_[i] * params_.dither_share * std::fabs(bias[i]);
    dither_sign_[i] = -dither_sign_[i];
  }
  return torque;
}

}  // namespace tactus::arm_control
