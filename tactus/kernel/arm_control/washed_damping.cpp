// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/washed_damping.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/LU>

namespace tactus::arm_control {
namespace {

constexpr double braking_effort = 0.01;  ///< share of a joint's effort limit beyond which it is in contact
constexpr double braking_rise_s = 3e-3;
constexpr double braking_fall_s = 0.3;
constexpr double normal_s = 0.02;  ///< of the low-pass on the contact's direction
constexpr double least_m2 = 1e-6;  ///< keeps the force of a singular pose finite

}  // namespace

WashedDamping::WashedDamping(double washout_Hz, const JointVector& effort_limit, Seconds dt)
    : dt_s_(dt.value),
      washed_(1.0 - std::exp(-2.0 * std::numbers::pi * washout_Hz * dt.value)),
      faded_(std::exp(-dt.value / braking_fall_s)),
      touch_N_m_(braking_effort * effort_limit),
      slow_(JointVector::Zero(effort_limit.size())),
      left_(JointMatrix::Identity(effort_limit.size(), effort_limit.size())) {}

JointVector WashedDamping::step(const ToolJacobian& tool, const JointMatrix& dampers, const JointVector& velocity,
                                const JointVector& external) noexcept {
  slow_ += washed_ * (velocity - slow_);
  const arm::Matrix3 moves = tool * tool.transpose() + least_m2 * arm::Matrix3::Identity();
  const arm::Matrix3 held = moves.inverse();
  if ((external.array().abs() > touch_N_m_.array()).any()) {
    contact_ = std::min(1.0, contact_ + dt_s_ / braking_rise_s);
    const arm::Vector3 force_N = held * (tool * external);
    force_N_ += (1.0 - std::exp(-dt_s_ / normal_s)) * (force_N - force_N_);
  } else {
    contact_ *= faded_;
  }
  left_.setIdentity();
  if (const double size = force_N_.norm(); size > 0.0 && contact_ > 0.0) {
    const arm::Vector3 normal = force_N_ / size;
    const JointVector along = tool.transpose() * normal;
    const JointVector force_of = tool.transpose() * (held * normal);
    left_ -= contact_ * along * force_of.transpose();
  }
  return left_ * (dampers * slow_);
}

}  // namespace tactus::arm_control
