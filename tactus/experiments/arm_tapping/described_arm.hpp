#pragma once

#include <tactus/experiments/arm_tapping/params.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace tactus::experiments {

/// An arm as a file describes it, and where its joints begin.
struct DescribedArm {
  std::vector<std::string> joints;  ///< their names, from the base on
  arm_plants::ArmPlant::Params arm;
  arm::JointVector start;
};

/// Reads the URDF, from `folder` on, and adds what it does not say. Errors: `missing` without a URDF; those of
/// `urdf::read`.
Result<DescribedArm> describe_arm(const ArmPairParams& params, const std::filesystem::path& folder);

}  // namespace tactus::experiments
