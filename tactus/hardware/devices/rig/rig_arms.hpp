// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/rig/rig.hpp>
#include <tactus/kernel/station/arm_teleoperator_params.hpp>
#include <tactus/kernel/station/described_arms.hpp>

/// A pair of a rig as two arms, each driven by a site that knows all its joints
/// (`tactus/kernel/arm_control/arm_sites.hpp`). `params` and `arms` are those that the sites are made of. Nothing here
/// is real-time safe.
namespace tactus::devices {

/// The pair, or the one side of it that the file has, with its joints in the order of the arm's, from the base on, then
/// those that the arm does not have, such as that of a gripper. Joints are matched by name.
///
/// Errors, whose parameters are those of the rig's file: `inconsistent` for a joint that the arm does not have where
/// the experiment has no gains for it (`rig.gripper`), one that slides or gives no force, and limits below the gains
/// that the sites ask of a drive; `missing` for a joint of the arm that the rig does not have.
Result<RigPair> as_arms(const RigPair& pair, const station::ArmTeleoperatorParams& params,
                        const station::DescribedArms& arms);

}  // namespace tactus::devices
