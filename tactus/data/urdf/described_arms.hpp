// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/station/arm_teleoperator_params.hpp>
#include <tactus/kernel/station/described_arms.hpp>

#include <filesystem>
#include <functional>
#include <string>

/// The arms of a teleoperator from their URDFs and an experiment's file. Nothing here is real-time safe.
namespace tactus::urdf {

/// The text of a URDF, and the file that errors name.
struct UrdfText {
  std::string text;
  std::filesystem::path file;
};
/// Where the URDFs are that an experiment names.
using Urdfs = std::function<Result<UrdfText>(const std::string& name)>;
/// Files, from `folder` on. Errors: those of `text_of`.
Urdfs urdfs_below(const std::filesystem::path& folder);

/// Reads the URDF and adds the rest from `params`. Errors: `missing` without a URDF; those of its text and of `parse`.
Result<station::DescribedArm> describe_arm(const station::ArmParams& params, const Urdfs& urdfs);

/// Both arms, checked. The models of gravity and friction that the sites use are exact. Errors: those of `describe_arm`
/// and of `arm::Chain::make`; `inconsistent` where keys describe a follower that has no URDF of its own, and for
/// a method that couples joints where a handle leads the tool; of arms that are led joint by joint, for different
/// numbers of joints and for another start of the follower; of one that leads the tool, for a follower without a URDF
/// and for a leader that is no handle.
Result<station::DescribedArms> describe_arms(const station::ArmTeleoperatorParams& params, const Urdfs& urdfs);

}  // namespace tactus::urdf
