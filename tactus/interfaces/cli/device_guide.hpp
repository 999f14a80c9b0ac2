// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <string>

namespace tactus::cli {

/// Leads a user through the poses of `devices::guide_poses` with the arm of one side (`name`) of the rig, without
/// power, and prints what disagrees with the URDF of the experiment (TOML, kind `arm-tapping`). A line on standard
/// input ends each pose. False if anything disagrees. Errors: those of both files; `missing` for a joint of the arm
/// that the side does not have; those of the bus; `failed` if standard input ends, or a motor does not respond.
Result<bool> guide_arm(const std::string& rig, const std::string& name, const std::string& experiment);

}  // namespace tactus::cli
