// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/hand.hpp>
#include <tactus/kernel/arm/physical_arm.hpp>
#include <tactus/kernel/arm_control/induced_motion.hpp>

#include <string>
#include <vector>

namespace tactus::station {

/// An arm as its URDF and an experiment's file describe it, and where its joints begin.
struct DescribedArm {
  std::string urdf;                 ///< its name in the file
  std::string urdf_text;            ///< the text of that file
  std::vector<std::string> joints;  ///< their names, from the base on
  arm::PhysicalArm arm;
  arm::JointVector start;
  /// What the sites take the stiffness of each transmission for, if that is not what it is; else without rows.
  arm::JointVector assumed_joint_stiffness_N_m_per_rad = {};

  /// Of each joint's transmission; 0 is rigid.
  [[nodiscard]] arm::JointVector joint_stiffness_N_m_per_rad() const;
  [[nodiscard]] arm::JointVector joint_damping_N_m_s_per_rad() const;
};

/// The models that the sites of two arms compute with, as far as an experiment draws errors of them.
struct ArmModelParams {
  arm::Chain::Params leader;    ///< for gravity compensation and everything else that the leader's site computes
  arm::Chain::Params follower;  ///< for gravity compensation, observer and wanted motion of the follower's site
  arm_control::InducedMotion::Arm induced;                ///< the leader, for the model of induced motion
  arm::HandImpedance hand;                                ///< that holds it, for the same
  arm::JointVector follower_joint_stiffness_N_m_per_rad;  ///< for an observer of elastic joints
  /// What a tare found that gravity compensation lacks (`arm_control::Tare`), N m; no rows: there was none.
  arm::JointVector leader_lacking_N_m = {};
  arm::JointVector follower_lacking_N_m = {};
};

/// Both arms of a teleoperator. The sites compute gravity and friction from these themselves.
struct DescribedArms {
  DescribedArm leader;
  DescribedArm
      follower;  ///< the same as the leader, or another arm; led joint by joint, it begins where the leader does
  ArmModelParams exact;  ///< models without error, but that the hand is control.model.hand
};

}  // namespace tactus::station
