// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/rig/rig_arms.hpp>
#include <tactus/kernel/control/protective_limits.hpp>
#include <tactus/kernel/station/make_device_guard.hpp>
#include <tactus/kernel/station/supervised_arms.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace tactus::devices {

namespace {

using arm_control::ArmMethod;
using arm_control::DriveGains;
using station::ArmTeleoperatorParams;
using station::DescribedArms;

Error problem_at(const std::string& parameter, ErrorCode code, std::string message) {
  return {.code = code, .parameter = parameter, .message = std::move(message), .place = {}};
}

std::string listed(const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  return all;
}

/// The most that the sites ask of each drive's law.
Joints<DriveGains> asked_of_leader(const ArmTeleoperatorParams& params, std::size_t joints) {
  const auto& sites = params.control;
  Joints<DriveGains> asked = sites.follower.gains.of(joints);
  const auto damping = sites.drive_damping.of(joints);
  const bool pulls = sites.method == ArmMethod::position_position;
  for (std::size_t i = 0; i < joints; ++i) {
    asked[i].stiffness_N_m_per_rad *= pulls ? sites.force_gain : 0.0;
    asked[i].damping_N_m_s_per_rad =
        pulls ? sites.force_gain * asked[i].damping_N_m_s_per_rad : damping[i].damping_N_m_s_per_rad;
  }
  return asked;
}
Joints<DriveGains> asked_of_follower(const ArmTeleoperatorParams& params, std::size_t joints) {
  Joints<DriveGains> asked = params.control.follower.gains.of(joints);
  for (DriveGains& gains : asked) gains.stiffness_N_m_per_rad *= params.control.follower.stiffness_share;
  return asked;
}

/// That every check of the arm's gate can be reached within what the joint may do.
Check check_gate(const RigJoint& joint, const control::SafetyGate::Params& gate, const std::string& name) {
  Check error = control::refuse_unreachable(station::tightened(gate, joint.joint.limits()), name);
  if (error) error->message = joint.path + ": " + error->message;
  return error;
}

Check check_joint(const RigJoint& joint, const DriveGains& asked) {
  if (joint.slides || !joint.joint.gives_force) {
    return problem_at(join(joint.path, "model"), ErrorCode::inconsistent,
                      "a " + joint.motor.model +
                          " gives no torque to a joint that turns, so it cannot carry an arm: drive it "
                          "by a file of the kind tapping");
  }
  const auto below = [&](const char* key, double limit, double wanted, const char* unit) -> Check {
    if (wanted <= limit) return std::nullopt;
    return problem_at(
        join(joint.path, key), ErrorCode::inconsistent,
        rounded_number(limit) + unit + " is less than the " + rounded_number(wanted) + unit +
            " that the experiment asks of its motor's own law: write at least that, or lower the gain there");
  };
  const MotorJoint& may = joint.joint;
  if (Check error = below("stiffness_limit_Nm_per_rad", may.stiffness_limit_Nm_per_rad, asked.stiffness_N_m_per_rad,
                          " N m/rad")) {
    return error;
  }
  return below("damping_limit_Nms_per_rad", may.damping_limit_Nms_per_rad, asked.damping_N_m_s_per_rad, " N m s/rad");
}

/// That the limits of a joint of the rig are where the arm's can be. Half a turn beyond them may be how it is mounted;
/// more is another unit, or another joint.
Check check_limits(const RigJoint& joint, const arm::JointLimits& can_be, const std::string& urdf) {
  constexpr double farther_rad = std::numbers::pi;
  for (const auto& [key, value_rad] :
       {std::pair{joint.words().lower, joint.joint.lower_rad}, std::pair{joint.words().upper, joint.joint.upper_rad}}) {
    if (value_rad >= can_be.lower_rad - farther_rad && value_rad <= can_be.upper_rad + farther_rad) continue;
    return problem_at(join(joint.path, key), ErrorCode::inconsistent,
                      rounded_number(value_rad) + " rad is far beyond where " + urdf + " lets this joint be, from " +
                          rounded_number(can_be.lower_rad) + " to " + rounded_number(can_be.upper_rad) +
                          " rad: state it in rad (" + rounded_number(value_rad) + " degrees are " +
                          rounded_number(std::round(value_rad * std::numbers::pi / 180.0 * 1e4) / 1e4) +
                          " rad), or name the joint that the motor moves");
  }
  return std::nullopt;
}

/// The side with its joints in the arm's order, then the others.
Result<RigSide> in_order(const RigSide& side, const station::DescribedArm& arm, const station::GripperParams& gripper,
                         const Joints<DriveGains>& asked, const DriveGains& beside,
                         const control::SafetyGate::Params& gate, const std::string& name) {
  RigSide ordered = side;
  ordered.joints.clear();
  ordered.bus.motors.clear();
  const auto add = [&](const RigJoint& joint, const DriveGains& gains) -> Check {
    if (Check error = check_joint(joint, gains)) return error;
    if (Check error = check_gate(joint, gate, name)) return error;
    ordered.joints.push_back(joint);
    ordered.bus.motors.push_back(joint.motor);
    return std::nullopt;
  };
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const auto found = std::ranges::find(side.joints, arm.joints[i], &RigJoint::name);
    if (found == side.joints.end()) {
      return problem_at(side.path, ErrorCode::missing,
                        "the arm of " + arm.urdf + " has a joint " + arm.joints[i] +
                            ", and the rig has no such joint: write [" + join(side.path, arm.joints[i]) +
                            "]; or, if the arm ends before it (a finger, for example), name the arm's last link as tip "
                            "under [arm] of the experiment");
    }
    if (Check error = add(*found, asked[i])) return *std::move(error);
    if (Check error = check_limits(*found, arm.arm.chain.joints[i].limits, arm.urdf)) return *std::move(error);
  }
  const bool driven = gripper.stiffness_N_m_per_rad > 0.0 || gripper.damping_N_m_s_per_rad > 0.0;
  for (const RigJoint& joint : side.joints) {
    if (std::ranges::find(arm.joints, joint.name()) != arm.joints.end()) continue;
    if (!driven) {
      return problem_at(joint.path, ErrorCode::inconsistent,
                        "the arm of " + arm.urdf + " has no joint of this name but " + listed(arm.joints) +
                            ": call it as the arm does; or, where it is a gripper, write its gains under [rig.gripper] "
                            "of the experiment");
    }
    if (Check error = add(joint, beside)) return *std::move(error);
  }
  return ordered;
}

}  // namespace

Result<RigPair> as_arms(const RigPair& pair, const ArmTeleoperatorParams& params, const DescribedArms& arms) {
  const station::GripperParams& gripper = params.rig.gripper;
  RigPair ordered{.name = pair.name, .leader = {}, .follower = {}};
  if (pair.leader) {
    auto leader = in_order(*pair.leader, arms.leader, gripper, asked_of_leader(params, arms.leader.joints.size()),
                           station::beside_the_arm(params, true), params.rig.leader_gate, "rig.leader_gate");
    if (!leader) return leader.error();
    ordered.leader = *std::move(leader);
  }
  if (pair.follower) {
    auto follower =
        in_order(*pair.follower, arms.follower, gripper, asked_of_follower(params, arms.follower.joints.size()),
                 station::beside_the_arm(params, false), params.rig.follower_gate, "rig.follower_gate");
    if (!follower) return follower.error();
    ordered.follower = *std::move(follower);
  }
  return ordered;
}

}  // namespace tactus::devices
