// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/induced_motion.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>

namespace tactus::arm_control {

InducedMotion::InducedMotion(const Params& params, const Site& site, const Arm& arm, const arm::Chain& chain,
                             Seconds dt)
    : chain_(chain),
      friction_(member_of_each(arm.chain.joints, &arm::JointParams::friction)),
      armature_(JointVector::Zero(chain.joints())),
      tool_m_(arm.tool_m),
      hand_(params.hand),
      site_(site),
      drive_damping_(site.drive_damping_N_m_s_per_rad.size() == chain.joints() ? site.drive_damping_N_m_s_per_rad
                                                                               : JointVector::Zero(chain.joints())),
      drive_damping_limit_(drive_damping_, site.drive_damping_limit_N_s_per_m),
      diagonal_(params.inertia == InertiaModel::diagonal),
      elastic_(params.joints == JointModel::elastic),
      joint_stiffness_(arm.joint_stiffness_N_m_per_rad),
      joint_damping_(arm.joint_damping_N_m_s_per_rad.size() == chain.joints() ? arm.joint_damping_N_m_s_per_rad
                                                                              : JointVector::Zero(chain.joints())),
      dt_s_(dt.value),
      washed_(1.0 - std::exp(-2.0 * std::numbers::pi * params.washout_Hz * dt.value)),
      damper_washed_(1.0 - std::exp(-2.0 * std::numbers::pi * site.damping_washout_Hz * dt.value)) {
  for (std::size_t i = 0; i < friction_.size(); ++i) {
    armature_[static_cast<Eigen::Index>(i)] = arm.chain.joints[i].drive.reflected_kg_m2();
  }
  reset();
}

Result<InducedMotion> InducedMotion::make(const Params& params, const Site& site, const Arm& arm, Seconds dt) {
  if (Check wrong = signal::check(params, dt)) return *std::move(wrong);
  const auto chain = arm::Chain::make(arm.chain);
  if (!chain) return chain.error();
  if (params.joints == JointModel::elastic) {
    if (Check wrong = check_stiffness(arm.joint_stiffness_N_m_per_rad, chain->joints())) return *std::move(wrong);
  }
  return InducedMotion(params, site, arm, *chain, dt);
}

void InducedMotion::reset() noexcept {
  position_ = State::Zero((elastic_ ? 2 : 1) * joints());
  velocity_ = position_;
  slow_position_ = JointVector::Zero(joints());
  slow_velocity_ = slow_position_;
  slow_for_dampers_ = slow_position_;
}

double InducedMotion::net_friction(std::size_t joint, double velocity) const noexcept {
  const arm::JointFriction& f = friction_[joint];
  const double left = f.coulomb_N_m * (f.direction(velocity) -
                                       site_.friction_share * std::tanh(velocity / site_.friction_velocity_rad_per_s));
  return left + (1.0 - site_.friction_share) * f.viscous_N_m_s_per_rad * velocity;
}

double InducedMotion::friction_secant(std::size_t joint, double velocity, double induced) const noexcept {
  constexpr double least = 1e-6;  // below it the secant is the slope
  const double over = std::copysign(std::max(std::fabs(induced), least), induced);
  return std::max(0.0, (net_friction(joint, velocity) - net_friction(joint, velocity - over)) / over);
}

InducedMotion::Matrices InducedMotion::matrices(const JointVector& measured_position) const noexcept {
  const Eigen::Index count = joints();
  const arm::Jacobian jacobian = chain_.jacobian(measured_position, chain_.joints() - 1, tool_m_);
  const double lever2_m2 = hand_.lever_m * hand_.lever_m;
  // What one N/m at the tool is in joints, and what a hand holds that feels turns at its lever.
  const JointMatrix moving = jacobian.topRows<3>().transpose() * jacobian.topRows<3>();
  const JointMatrix held = moving + lever2_m2 * (jacobian.bottomRows<3>().transpose() * jacobian.bottomRows<3>());
  JointMatrix inertia = chain_.mass_matrix(measured_position);
  if (diagonal_) inertia = JointMatrix(inertia.diagonal().asDiagonal());
  inertia += hand_.mass_kg * moving;
  const JointMatrix stiffness = hand_.stiffness_N_per_m * held;
  const JointMatrix damping = hand_.damping_N_s_per_m * held;
  JointMatrix of_site = site_.damping_N_s_per_m * moving;
  of_site.diagonal() += drive_damping_;
  if (drive_damping_limit_.limits()) {
    const ToolJacobian tool = jacobian.topRows<3>();
    of_site -= tool.transpose() * drive_damping_limit_.excess(tool) * tool;
  }
  if (!elastic_) return {.inertia = inertia, .damping = damping + of_site, .stiffness = stiffness, .of_site = of_site};
  const StateMatrix none = StateMatrix::Zero(2 * count, 2 * count);
  Matrices found{.inertia = none, .damping = none, .stiffness = none, .of_site = of_site};
  const auto join = [count](StateMatrix& matrix, const JointVector& spring) {
    matrix.topLeftCorner(count, count).diagonal() += spring;
    matrix.bottomRightCorner(count, count).diagonal() += spring;
    matrix.topRightCorner(count, count).diagonal() -= spring;
    matrix.bottomLeftCorner(count, count).diagonal() -= spring;
  };
  found.inertia.bottomRightCorner(count, count) = inertia;
  found.inertia.bottomRightCorner(count, count).diagonal() -= armature_;
  found.inertia.topLeftCorner(count, count).diagonal() = armature_;
  found.damping.topLeftCorner(count, count) = of_site;
  found.damping.bottomRightCorner(count, count) = damping;
  found.stiffness.bottomRightCorner(count, count) = stiffness;
  join(found.stiffness, joint_stiffness_);
  join(found.damping, joint_damping_);
  return found;
}

void InducedMotion::step(const JointVector& displayed, const JointVector& measured_position,
                         const JointVector& measured_velocity, const JointMatrix& left_out) noexcept {
  const Matrices m = matrices(measured_position);
  const StateMatrix half = 0.5 * dt_s_ * (m.damping + 0.5 * dt_s_ * m.stiffness);
  State right = (m.inertia - half) * velocity_ - dt_s_ * (m.stiffness * position_);
  right.head(joints()) += dt_s_ * displayed;
  if (left_out.size() > 0) right.head(joints()) += dt_s_ * (left_out * (m.of_site * slow_for_dampers_));
  StateMatrix left = m.inertia + half;
  for (Eigen::Index i = 0; i < joints(); ++i) {
    left(i, i) += dt_s_ * friction_secant(static_cast<std::size_t>(i), measured_velocity[i], velocity_[i]);
  }
  const State before = velocity_;
  velocity_ = Eigen::LLT<StateMatrix>(left).solve(right);
  position_ += 0.5 * dt_s_ * (before + velocity_);
  slow_position_ += washed_ * (position_.head(joints()) - slow_position_);
  slow_velocity_ += washed_ * (velocity_.head(joints()) - slow_velocity_);
  slow_for_dampers_ += damper_washed_ * (velocity_.head(joints()) - slow_for_dampers_);
}

}  // namespace tactus::arm_control
