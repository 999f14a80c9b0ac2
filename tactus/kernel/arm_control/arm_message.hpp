// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/motors.hpp>

namespace tactus::arm_control {

using arm::ArmCommand;
using arm::ArmReading;
using arm::JointVector;

/// What the sites of two arms send each other, in the leader's joints. The leader reports where the follower shall be;
/// the follower where it is and which torque acts on it from outside, positive where it turns the joint up. Both have
/// those joints, or the follower's site knows what they are to its own (`ToolCoupling`).
struct ArmMessage {
  JointVector position;
  JointVector velocity;
  JointVector external_torque;
  /// That flowed into the line at the site's port so far, in J, as `PassiveLeader` counts it; empty where nobody does.
  JointVector energy_J = {};

  /// An arm that rests there and touches nothing.
  static ArmMessage at_rest(const JointVector& position) noexcept {
    const JointVector none = arm::JointVector::Zero(position.size());
    return {.position = position, .velocity = none, .external_torque = none, .energy_J = none};
  }
};

}  // namespace tactus::arm_control
