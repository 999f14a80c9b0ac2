// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/effort_limits.hpp>
#include <tactus/kernel/arm_control/torque_bias.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactus::arm_control {
namespace {

constexpr double bias_slow_Hz = 2.0;
constexpr double bias_moving_m_per_s = 0.03;
constexpr double unfelt_effort = 0.01, most_bias_effort = 0.05;  ///< shares of an effort limit

}  // namespace

TorqueBias::TorqueBias(double distance_m, const arm::Chain::Params& arm, Seconds dt)
    : distance_m_(distance_m),
      dt_s_(dt.value),
      passed_(1.0 - std::exp(-2.0 * std::numbers::pi * bias_slow_Hz * dt.value)),
      touch_N_m_(unfelt_effort * effort_limits(arm)),
      most_N_m_(most_bias_effort * effort_limits(arm)),
      slow_(JointVector::Zero(touch_N_m_.size())),
      bias_(slow_) {
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    double& touch_N_m = touch_N_m_[static_cast<Eigen::Index>(i)];
    touch_N_m = std::max(touch_N_m, arm.joints[i].friction.coulomb_N_m);
  }
}

const JointVector& TorqueBias::step(const JointVector& external, double tool_m_per_s) noexcept {
  slow_ += passed_ * (external - slow_);
  const bool touches = ((external - bias_).array().abs() > touch_N_m_.array()).any();
  if (tool_m_per_s > bias_moving_m_per_s && !touches) {
    bias_ += (1.0 - std::exp(-tool_m_per_s * dt_s_ / distance_m_)) * (slow_ - bias_);
    bias_ = bias_.cwiseMax(-most_N_m_).cwiseMin(most_N_m_);
  }
  return bias_;
}

}  // namespace tactus::arm_control
