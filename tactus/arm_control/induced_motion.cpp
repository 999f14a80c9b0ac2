#include <tactus/arm_control/induced_motion.hpp>
#include <tactus/signal/checks.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>

namespace tactus::arm_control {

using arm::JointMatrix;

InducedMotion::InducedMotion(const Params& params, const Site& site, const arm::Chain::Params& arm,
                             const arm::Chain& chain, const arm::Vector3& tool_m, Seconds dt)
    : chain_(chain),
      friction_(member_of_each(arm.joints, &arm::JointParams::friction)),
      tool_m_(tool_m),
      hand_(params.hand),
      site_(site),
      diagonal_(params.inertia == InertiaModel::diagonal),
      dt_s_(dt.value),
      washed_(1.0 - std::exp(-2.0 * std::numbers::pi * params.washout_Hz * dt.value)) {
  reset();
}

Result<InducedMotion> InducedMotion::make(const Params& params, const Site& site, const arm::Chain::Params& arm,
                                          const arm::Vector3& tool_m, Seconds dt) {
  if (Check wrong = signal::check(params, dt)) return *std::move(wrong);
  const auto chain = arm::Chain::make(arm);
  if (!chain) return chain.error();
  return InducedMotion(params, site, arm, *chain, tool_m, dt);
}

void InducedMotion::reset() noexcept {
  position_ = JointVector::Zero(chain_.joints());
  velocity_ = position_;
  slow_position_ = position_;
  slow_velocity_ = position_;
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

void InducedMotion::step(const JointVector& displayed, const JointVector& measured_position,
                         const JointVector& measured_velocity) noexcept {
  const int joints = chain_.joints();
  const arm::Jacobian jacobian = chain_.jacobian(measured_position, joints - 1, tool_m_);
  const double lever2_m2 = hand_.lever_m * hand_.lever_m;
  // What one N/m at the tool is in joints; a metre of the tool's turn counts at the lever.
  const JointMatrix moving = jacobian.topRows<3>().transpose() * jacobian.topRows<3>();
  const JointMatrix held = moving + lever2_m2 * (jacobian.bottomRows<3>().transpose() * jacobian.bottomRows<3>());
  JointMatrix inertia = chain_.mass_matrix(measured_position);
  if (diagonal_) inertia = JointMatrix(inertia.diagonal().asDiagonal());
  inertia += hand_.mass_kg * moving;
  JointMatrix left = inertia + dt_s_ * (hand_.damping_N_s_per_m + dt_s_ * hand_.stiffness_N_per_m) * held +
                     dt_s_ * site_.damping_N_s_per_m * moving;
  for (int i = 0; i < joints; ++i) {
    left(i, i) += dt_s_ * friction_secant(static_cast<std::size_t>(i), measured_velocity[i], velocity_[i]);
  }
  const JointVector right = inertia * velocity_ + dt_s_ * (displayed - hand_.stiffness_N_per_m * (held * position_));
  velocity_ = Eigen::LLT<JointMatrix>(left).solve(right);
  position_ += dt_s_ * velocity_;
  slow_position_ += washed_ * (position_ - slow_position_);
  slow_velocity_ += washed_ * (velocity_ - slow_velocity_);
}

}  // namespace tactus::arm_control
