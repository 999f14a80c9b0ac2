// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/chain.hpp>
#include <tactus/kernel/arm_control/each_joint.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <cmath>

namespace tactus::arm_control {

/// How much a joint's displayed torque fades with the speed that it gives.
struct AvoidanceGain {
  double alpha_s_per_rad = 0.0;
  static constexpr auto fields() {
    return List{field("alpha_s_per_rad", &AvoidanceGain::alpha_s_per_rad, Unit{"s/rad", "_s_per_rad"},
                      between(0.0, 1000.0),
                      "alpha: a displayed torque in the direction of motion is multiplied by 1 - alpha times the "
                      "joint's speed. It is zero at the speed 1/alpha and reversed above it.")};
  }
};

/// The “feedback avoidance” of Franka's teleoperation, against a leader that “jumps away”: of each joint by itself,
///
///     τ = τ_r − α·|v·τ_r|·sgn(v)   where v·τ_r > 0,   else τ_r,
///
/// with the reflected torque τ_r, positive up, and the leader's velocity v. So a torque along the motion is
/// τ_r·(1 − α·|v|): gone at 1/α (0.05 rad/s at joint 1), against the motion beyond. One against the motion stays, so
/// what the hand pushes into is whole. Gains as released for a Franka arm. `control.force_gain` multiplies τ_r;
/// released is 1. Without state. Source: frankarobotics/franka_ros2_teleop (Apache-2.0, 2025),
/// `TeleopLeaderController::update` in src/teleop_leader_controller.cpp, where torques have the other sign.
class FeedbackAvoidance {
 public:
  using Params = EachJoint<AvoidanceGain>;
  static constexpr Params released{{18.75}, {15.0}, {13.5}, {9.0}, {5.25}, {3.0}, {1.5}, {1.5}};

  FeedbackAvoidance(const Params& params, int joints) : alpha_(params.of(joints, &AvoidanceGain::alpha_s_per_rad)) {}

  /// What is displayed of `reflected`, in N m. Real-time safe.
  [[nodiscard]] arm::JointVector displayed(arm::JointVector reflected,
                                           const arm::JointVector& velocity) const noexcept {
    for (Eigen::Index i = 0; i < reflected.size(); ++i) {
      if (velocity[i] * reflected[i] > 0.0) reflected[i] *= 1.0 - alpha_[i] * std::fabs(velocity[i]);
    }
    return reflected;
  }

 private:
  arm::JointVector alpha_;
};

}  // namespace tactus::arm_control
