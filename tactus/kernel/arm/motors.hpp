// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/chain.hpp>

/// What the motors of an arm report and receive.
namespace tactus::arm {

/// Of all motors at one instant. Positions count at the motor's side of an elastic joint, in rad of the joint.
struct ArmReading {
  JointVector position;
  JointVector velocity;
  JointVector torque;  ///< N m that the motor gives to the joint, as its drive assumes
};

/// The law that a drive runs by itself, much faster than its bus ("MIT mode" of Damiao's and many others' motors):
///
///     torque = stiffness·(position − q) + damping·(velocity − q̇) + torque,   kept within what the motor can give.
struct ArmCommand {
  JointVector position;
  JointVector velocity;
  JointVector stiffness;  ///< N m/rad
  JointVector damping;    ///< N m s/rad
  JointVector torque;     ///< N m

  /// Torques alone. Real-time safe.
  static ArmCommand of_torque(const JointVector& torque) noexcept {
    const JointVector none = JointVector::Zero(torque.size());
    return {.position = none, .velocity = none, .stiffness = none, .damping = none, .torque = torque};
  }
};

}  // namespace tactus::arm
