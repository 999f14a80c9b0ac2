// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/effort_limits.hpp>
#include <tactus/kernel/arm_control/feed_forward.hpp>
#include <tactus/kernel/arm_control/wanted_motion.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactus::arm_control {
namespace {

constexpr double contact_Hz = 10.0;       ///< of the torque by which contact is told
constexpr double contact_friction = 2.0;  ///< share of a joint's Coulomb friction, beyond which it is in contact
constexpr double contact_effort = 0.01;   ///< and beyond this one of its effort limit
constexpr double contact_rise_s = 3e-3;
constexpr double contact_fall_m = 0.15;

}  // namespace

WantedMotion::WantedMotion(const Params& params, double friction_velocity_rad_per_s, const Arm& arm,
                           const JointLowPass& low_pass, Seconds dt)
    : chain_(arm.chain),
      tool_m_(arm.tool_m),
      friction_(member_of_each(arm.params.joints, &arm::JointParams::friction)),
      friction_velocity_rad_per_s_(friction_velocity_rad_per_s),
      corner_rad_per_s_(2.0 * std::numbers::pi * params.cutoff_Hz),
      dt_s_(dt.value),
      velocity_(JointVector::Zero(arm.chain.joints())),
      acceleration_(velocity_),
      external_(low_pass),
      touch_N_m_(contact_effort * effort_limits(arm.params)) {
  for (std::size_t i = 0; i < friction_.size(); ++i) {
    double& touch_N_m = touch_N_m_[static_cast<Eigen::Index>(i)];
    touch_N_m = std::max(touch_N_m, contact_friction * friction_[i].coulomb_N_m);
  }
}

Result<WantedMotion> WantedMotion::make(const Params& params, double friction_velocity_rad_per_s, const Arm& arm,
                                        Seconds dt) {
  if (Check wrong = signal::check(params, dt)) return *std::move(wrong);
  if (Check wrong = signal::check_below_nyquist("cutoff_Hz", params.cutoff_Hz, dt)) return *std::move(wrong);
  const auto low_pass =
      JointLowPass::make(JointVector::Constant(arm.chain.joints(), params.cutoff_Hz > 0.0 ? contact_Hz : 0.0), dt);
  if (!low_pass) return low_pass.error();
  return WantedMotion(params, friction_velocity_rad_per_s, arm, *low_pass, dt);
}

/// By implicit Euler, which is stable at any corner.
void WantedMotion::follow(const JointVector& wanted) noexcept {
  const double w = corner_rad_per_s_ * dt_s_;
  acceleration_ =
      (acceleration_ + corner_rad_per_s_ * w * (wanted - velocity_)) / (1.0 + std::numbers::sqrt2 * w + w * w);
  velocity_ += dt_s_ * acceleration_;
}

void WantedMotion::look_for_contact(const ArmReading& reading, const JointVector& external) noexcept {
  if ((external_.step(external).array().abs() > touch_N_m_.array()).any()) {
    contact_ = std::min(1.0, contact_ + dt_s_ / contact_rise_s);
    return;
  }
  const ToolJacobian tool = chain_.jacobian(reading.position, chain_.joints() - 1, tool_m_).topRows<3>();
  contact_ *= std::exp(-(tool * reading.velocity).norm() * dt_s_ / contact_fall_m);
}

JointVector WantedMotion::step(const ArmReading& reading, const JointVector& wanted,
                               const JointVector& external) noexcept {
  follow(wanted);
  look_for_contact(reading, external);
  JointVector torque = chain_.mass_matrix(reading.position) * acceleration_;
  for (std::size_t i = 0; i < friction_.size(); ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    torque[joint] += smooth_friction(friction_[i], velocity_[joint], friction_velocity_rad_per_s_);
  }
  return (1.0 - contact_) * torque;
}

}  // namespace tactus::arm_control
