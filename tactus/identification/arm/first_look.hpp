#pragma once

#include <tactus/identification/arm/data.hpp>
#include <tactus/identification/arm/recording.hpp>

#include <string>
#include <vector>

/// What efforts show before anything is fitted, the URDF's bodies taken as they are.
namespace tactus::arm_identification {

/// `bodies`: the numbers of the URDF's, in order. Errors: `inconsistent` for an effort that is 0 throughout, for two
/// that each explain the other joint and not their own, and for one of the wrong sign.
Check check_efforts(const ArmData& data, const Eigen::VectorXd& bodies, const std::vector<std::string>& joints,
                    const ArmRecording& recording);

/// What is assumed of each joint: the URDF, friction and armature of the size of its torques if the URDF lacks them.
/// `scaled`: whether efforts cannot be torques in N m; then each has the scale with which the URDF explains it best.
std::vector<JointPrior> priors_of(const ArmData& data, const arm::Chain& chain, const arm::Chain::Params& urdf,
                                  const Eigen::VectorXd& bodies, bool& scaled);

}  // namespace tactus::arm_identification
