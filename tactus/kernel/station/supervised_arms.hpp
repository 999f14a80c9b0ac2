// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/supervised_site.hpp>
#include <tactus/kernel/station/arm_teleoperator_params.hpp>
#include <tactus/kernel/station/described_arms.hpp>
#include <tactus/kernel/station/device.hpp>
#include <tactus/kernel/station/site_pair.hpp>

#include <cstddef>
#include <cstdint>

/// The sites of two arms as they run before motors: gates and supervision of `[rig]` around the controllers.
namespace tactus::station {

/// How a joint that the arm does not have is driven, as `[rig.gripper]` states.
arm_control::DriveGains beside_the_arm(const ArmTeleoperatorParams& params, bool leads);

/// The gates of a site's joints: those of the file, within what each joint of its device allows.
Joints<control::SafetyGate::Params> joint_gates(const control::SafetyGate::Params& of_all,
                                                const Joints<DeviceLimits>& limits);

/// One start of a site.
struct ArmSiteStart {
  std::int64_t session = 1;           ///< not 0, and of no start before
  control::Agreement agreement = {};  ///< as in `control::supervise_master`
  bool tries_motors = true;           ///< on arming
  bool judges_support = true;         ///< the same; false: it comes in over `blend_s`, whatever moves
};

/// One site before a device of these limits, joint by joint, those of the arm first: its gates are within them, and so
/// is the torque that the site assumes to have. Errors: those of the controller, under `control`; of gates and
/// supervision, under `rig`; `inconsistent` for gates that nobody chose, naming their keys, and for a method that is
/// tried in virtual time alone.
Result<control::JointSupervisedMaster> arm_leader_site(const ArmTeleoperatorParams& params, const DescribedArms& arms,
                                                       const Joints<DeviceLimits>& limits, const ArmSiteStart& start);
Result<control::JointSupervisedSlave> arm_follower_site(const ArmTeleoperatorParams& params, const DescribedArms& arms,
                                                        const Joints<DeviceLimits>& limits, const ArmSiteStart& start);

/// One start of both sites.
struct ArmStart {
  std::int64_t leader_session = 1;  ///< not 0, and of no start before
  std::int64_t follower_session = 2;
  bool tries_motors = true;  ///< on arming
  bool judges_support = true;
};
struct SupervisedArms {
  control::JointSupervisedMaster leader;
  control::JointSupervisedSlave follower;
};

/// Both. Errors: those of either.
Result<SupervisedArms> supervise_arms(const ArmTeleoperatorParams& params, const DescribedArms& arms,
                                      const Joints<DeviceLimits>& leader, const Joints<DeviceLimits>& follower,
                                      const ArmStart& start);

/// Both on one clock, with no channel between them. The same.
Result<JointSupervisedPair> arm_sites(const ArmTeleoperatorParams& params, const DescribedArms& arms,
                                      const Joints<DeviceLimits>& leader, const Joints<DeviceLimits>& follower);

}  // namespace tactus::station
