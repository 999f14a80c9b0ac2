// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/arm/data.hpp>
#include <tactus/identification/arm/recording.hpp>

#include <span>
#include <string>
#include <vector>

/// What efforts show before anything is fitted, the URDF's bodies taken as they are.
namespace tactus::arm_identification {

/// What is known of the unit of efforts.
enum class EffortUnit {
  torque,   ///< N m, or N of a joint that slides: as stated
  current,  ///< of a scale of its own at each joint
  unknown   ///< torques unless they cannot be
};
EffortUnit unit_of(std::span<const ArmRecording> recordings);

/// Errors: `inconsistent` for an effort that is 0 throughout.
Check check_efforts(const ArmData& data, const std::vector<std::string>& joints, const ArmRecording& recording);

/// What is assumed of each joint: the URDF, friction and armature of the size of its torques if the URDF lacks them.
/// `scaled`: whether efforts have scales of their own, as currents have and what is too large or small for a torque;
/// then each has the scale with which the URDF explains it best, and a joint of which the URDF explains little the one
/// in the middle of the others'.
std::vector<JointPrior> priors_of(const ArmData& data, const arm::Chain& chain, const arm::Chain::Params& urdf,
                                  const Eigen::VectorXd& bodies, EffortUnit unit, bool& scaled);

}  // namespace tactus::arm_identification
