// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/arm_stability/linear_arm.hpp>
#include <tactus/kernel/signal/decompositions.hpp>

#include <cstddef>

namespace tactus::arm_stability {

Eigen::MatrixXd weight_slope(const arm::Chain& chain, const arm::JointVector& position) {
  constexpr double apart_rad = 1e-5;
  const Eigen::Index joints = position.size();
  Eigen::MatrixXd slope(joints, joints);
  for (Eigen::Index i = 0; i < joints; ++i) {
    arm::JointVector above = position, below = position;
    above[i] += apart_rad;
    below[i] -= apart_rad;
    slope.col(i) = (chain.gravity_torque(above) - chain.gravity_torque(below)) / (2.0 * apart_rad);
  }
  return slope;
}

Result<stability::StateSpace> linear_arm(const arm_plants::ArmPlant::Params& arm, const arm::JointVector& position,
                                         const Holding& holding) {
  const auto chain = arm::Chain::make(arm.chain);
  if (!chain) return chain.error();
  const Eigen::Index n = position.size();
  const Eigen::MatrixXd tool = chain->jacobian(position, chain->joints() - 1, arm.tool_m);
  const Eigen::MatrixXd moving = tool.topRows(3);
  Eigen::VectorXd armature(n), spring(n), spring_damping(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    armature[i] = arm.chain.joints[at].drive.reflected_kg_m2();
    spring[i] = arm.motors[at].joint_stiffness_N_m_per_rad;
    spring_damping[i] = arm.motors[at].joint_damping_N_m_s_per_rad;
  }
  const Eigen::MatrixXd inertia =
      Eigen::MatrixXd(chain->mass_matrix(position)) + arm.carried_kg * moving.transpose() * moving;
  const Eigen::MatrixXd stiffness = weight_slope(*chain, position) + tool.transpose() * holding.stiffness * tool;
  const Eigen::MatrixXd damping = tool.transpose() * holding.damping * tool;
  const Eigen::MatrixXd at_motor_stiffness = holding.drive_stiffness.asDiagonal();
  const Eigen::MatrixXd at_motor_damping = (holding.drive_damping + holding.rubbing).asDiagonal();

  // Inertia, damping and stiffness of all coordinates: of elastic joints the motors, then the links.
  const bool elastic = (spring.array() > 0.0).any();
  const Eigen::Index all = elastic ? 2 * n : n;
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(all, all), d = m, k = m;
  m.bottomRightCorner(n, n) = inertia;
  d.bottomRightCorner(n, n) = damping;
  k.bottomRightCorner(n, n) = stiffness;
  if (elastic) {
    m.bottomRightCorner(n, n) -= Eigen::MatrixXd(armature.asDiagonal());
    m.topLeftCorner(n, n) = armature.asDiagonal();
    for (Eigen::Index i = 0; i < n; ++i) {
      Eigen::VectorXd bend = Eigen::VectorXd::Zero(all);
      bend[i] = 1.0;
      bend[n + i] = -1.0;
      k += spring[i] * bend * bend.transpose();
      d += spring_damping[i] * bend * bend.transpose();
    }
  }
  k.topLeftCorner(n, n) += at_motor_stiffness;
  d.topLeftCorner(n, n) += at_motor_damping;

  const Eigen::MatrixXd inverse = signal::inverse_of_definite(m);
  stability::StateSpace system{.a = Eigen::MatrixXd::Zero(2 * all, 2 * all),
                               .b = Eigen::MatrixXd::Zero(2 * all, n),
                               .c = Eigen::MatrixXd::Zero(4 * n, 2 * all),
                               .d = Eigen::MatrixXd::Zero(4 * n, n)};
  system.a.topRightCorner(all, all).setIdentity();
  system.a.bottomLeftCorner(all, all) = -inverse * k;
  system.a.bottomRightCorner(all, all) = -inverse * d;
  system.b.bottomRows(all) = inverse.leftCols(n);
  const Eigen::Index of_links = all - n;
  system.c.block(0, 0, n, n).setIdentity();
  system.c.block(n, all, n, n).setIdentity();
  system.c.block(2 * n, of_links, n, n).setIdentity();
  system.c.block(3 * n, all + of_links, n, n).setIdentity();
  return system;
}

}  // namespace tactus::arm_stability
