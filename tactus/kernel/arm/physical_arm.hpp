// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/chain.hpp>
#include <tactus/kernel/core/joints.hpp>

/// An arm with its motors and drives, as it really is: what a plant simulates, and the parameters that the sites of an
/// arm receive.
namespace tactus::arm {

/// A motor with its drive, and what lies between it and the joint.
struct MotorParams {
  double torque_limit_N_m = 1e9;
  /// Steps in which the drive reports position, velocity and torque; 0: it reports them exactly.
  double position_step_rad = 0.0;
  double velocity_step_rad_per_s = 0.0;
  double torque_step_N_m = 0.0;
  /// Of the transmission between motor and link; 0 is rigid.
  double joint_stiffness_N_m_per_rad = 0.0;
  double joint_damping_N_m_s_per_rad = 0.0;
  /// Play between the flanks of that transmission, from end to end: within it motor and link move freely, beyond it the
  /// stiffness above, which then must not be 0, and the damping push and never pull.
  double play_rad = 0.0;
  /// The range of velocity in the host's table over the drive's own (VMAX of Damiao's drives): the host reads so many
  /// times the velocity, and what it commands arrives divided by this. Positive.
  double velocity_scale = 1.0;
  /// The torque that the motor gives over the one that its drive assumes and reports: its torque constant over that of
  /// the drive's table. It scales the drive's law as well. Positive.
  double torque_scale = 1.0;
};

/// The whole arm.
struct PhysicalArm {
  /// Links, armature, Coulomb and viscous friction (no other part of `JointFriction`), gravity, and where end stops
  /// are: at the limits, or where the arm begins if that is beyond.
  Chain::Params chain;
  Joints<MotorParams> motors;
  Vector3 tool_m = Vector3::Zero();  ///< on the last link
  /// A mass at the tool, such as that of a hand, which has inertia and no weight.
  double carried_kg = 0.0;
  double step_s = 1e-4;  ///< of a plant that simulates it
};

}  // namespace tactus::arm
