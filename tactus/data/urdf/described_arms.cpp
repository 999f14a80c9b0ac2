// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/data/urdf/described_arms.hpp>
#include <tactus/data/urdf/urdf.hpp>
#include <tactus/kernel/arm_control/tool_coupling.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <cstddef>
#include <string>
#include <utility>

namespace tactus::urdf {

using station::ArmParams;
using station::DescribedArm;
using station::DescribedArms;

namespace {

/// `key` is that of its URDF.
Result<DescribedArm> described(const ArmParams& params, const std::string& key, const Urdfs& urdfs) {
  const auto refused = [&key](const Error& error) { return Error{error.code, key, describe(error), {}}; };
  auto urdf = urdfs(params.urdf);
  if (!urdf) return refused(urdf.error());
  const auto read = parse(urdf->text, urdf->file, params.tip);
  if (!read) return refused(read.error());
  if (!read->doubtful_limits.empty()) {
    return Error{ErrorCode::inconsistent, key, read->doubtful_limits.front() + ": an arm that moves needs it", {}};
  }
  const std::size_t joints = read->joints.size();
  const Joints<station::ArmJoint> of_file = params.joints.of(joints);
  DescribedArm found{.urdf = params.urdf,
                     .urdf_text = std::move(urdf->text),
                     .joints = read->joints,
                     .arm = {.chain = read->params, .motors = Joints<arm::MotorParams>(joints)},
                     .start = arm::JointVector::Zero(static_cast<Eigen::Index>(joints))};
  for (std::size_t i = 0; i < joints; ++i) {
    const station::ArmJoint& from = of_file[i];
    found.start[static_cast<Eigen::Index>(i)] = from.start_rad;
    arm::JointParams& joint = found.arm.chain.joints[i];
    joint.drive.armature_kg_m2 = from.armature_kg_m2;
    found.arm.motors[i] = {.torque_limit_N_m = joint.limits.effort_N_m,
                           .position_step_rad = from.position_step_rad,
                           .velocity_step_rad_per_s = from.velocity_step_rad_per_s,
                           .torque_step_N_m = from.torque_step_N_m,
                           .joint_stiffness_N_m_per_rad = from.stiffness_share * params.joint_stiffness_N_m_per_rad,
                           .joint_damping_N_m_s_per_rad = from.stiffness_share * params.joint_damping_N_m_s_per_rad,
                           .play_rad = from.play_rad};
    if (from.play_rad > 0.0 && found.arm.motors[i].joint_stiffness_N_m_per_rad == 0.0) {
      const std::string arm = key.substr(0, key.rfind('.'));
      return Error{ErrorCode::inconsistent,
                   arm + ".joints.joint_" + std::to_string(i + 1) + ".play_rad",
                   "backlash needs an elastic joint behind it: write " + arm +
                       ".joint_stiffness_N_m_per_rad and a stiffness_share above 0, or a play of 0",
                   {}};
    }
  }
  if (params.assumed_joint_stiffness_N_m_per_rad > 0.0) {
    found.assumed_joint_stiffness_N_m_per_rad.resize(found.start.size());
    for (std::size_t i = 0; i < joints; ++i) {
      found.assumed_joint_stiffness_N_m_per_rad[static_cast<Eigen::Index>(i)] =
          of_file[i].stiffness_share * params.assumed_joint_stiffness_N_m_per_rad;
    }
  }
  found.arm.tool_m = arm::Vector3(params.tool.x_m, params.tool.y_m, params.tool.z_m);
  return found;
}

/// Refuses a start that a joint cannot have.
Check check_start(const DescribedArm& of, const std::string& key) {
  for (std::size_t i = 0; i < of.joints.size(); ++i) {
    const double start_rad = of.start[static_cast<Eigen::Index>(i)];
    const arm::JointLimits& limits = of.arm.chain.joints[i].limits;
    if (start_rad >= limits.lower_rad && start_rad <= limits.upper_rad) continue;
    return Error{.code = ErrorCode::out_of_bounds,
                 .parameter = key,
                 .message = "joint '" + of.joints[i] + "' starts at " + rounded_number(start_rad) +
                            ", outside its range from " + rounded_number(limits.lower_rad) + " to " +
                            rounded_number(limits.upper_rad) + " in " + of.urdf + ": set start_rad of joint_" +
                            std::to_string(i + 1) + " within it",
                 .place = {}};
  }
  return std::nullopt;
}

std::string listed(const DescribedArm& of) {
  std::string all;
  for (const std::string& name : of.joints) all += (all.empty() ? "" : ", ") + name;
  return std::to_string(of.joints.size()) + " (" + all + ")";
}

Error inconsistent(std::string key, std::string why) {
  return {.code = ErrorCode::inconsistent, .parameter = std::move(key), .message = std::move(why), .place = {}};
}

}  // namespace

Urdfs urdfs_below(const std::filesystem::path& folder) {
  return [folder](const std::string& name) -> Result<UrdfText> {
    const std::filesystem::path file = folder / name;
    auto text = text_of(file);
    if (!text) return text.error();
    return UrdfText{*std::move(text), file};
  };
}

Result<DescribedArm> describe_arm(const ArmParams& params, const Urdfs& urdfs) {
  if (params.urdf.empty()) {
    return Error{.code = ErrorCode::missing,
                 .parameter = "arm.urdf",
                 .message = "which arm? Name its URDF file, such as arms/openarm-class.urdf",
                 .place = {}};
  }
  auto found = described(params, "arm.urdf", urdfs);
  if (!found) return found;
  if (Check wrong = check_start(*found, "arm.urdf")) return *std::move(wrong);
  return found;
}

namespace {

/// A handle that leads the tool hears the follower's force and tells where it is: what else there is couples joints.
Check refuse_method(const arm_control::ArmLeader::Params& control, arm_control::Coupling coupling) {
  using arm_control::ArmMethod;
  const ArmMethod method = control.method;
  if (coupling == arm_control::Coupling::joints || method == ArmMethod::position_force ||
      method == ArmMethod::cancellation) {
    return std::nullopt;
  }
  return inconsistent("control.method",
                      std::string(name_of(method)) +
                          " couples each joint with its own, and with control.follower.coupling = \"tool\" there are "
                          "none: write position-force or cancellation");
}

/// Both arms, without what the sites believe of them.
Result<DescribedArms> pair_of(const station::ArmPairParams& params, arm_control::Coupling coupling,
                              const Urdfs& urdfs) {
  auto leader = describe_arm(params, urdfs);
  if (!leader) return leader.error();
  if (!station::differs(params)) {
    if (configuration::to_toml(params.follower) != configuration::to_toml(ArmParams{})) {
      return inconsistent("arm.follower.urdf",
                          "empty, so the follower is like the leader, and yet it has keys: name its "
                          "URDF here and describe all of it below arm.follower, or nothing");
    }
    if (coupling == arm_control::Coupling::tool) {
      return inconsistent("arm.follower.urdf",
                          "none, and control.follower.coupling is tool: name the URDF of the arm whose tool the leader "
                          "leads, such as arms/openarm-class.urdf, and describe all of it below arm.follower");
    }
    return DescribedArms{.leader = *leader, .follower = *leader, .exact = {}};
  }
  auto follower = described(params.follower, "arm.follower.urdf", urdfs);
  if (!follower) return follower.error();
  if (coupling == arm_control::Coupling::tool) {
    if (const auto axes = arm_control::ToolCoupling::axes_of(leader->arm.chain); !axes) {
      return Error{axes.error().code, "arm.urdf", axes.error().message, {}};
    }
    if (Check wrong = check_start(*follower, "arm.follower.urdf")) return *std::move(wrong);
    return DescribedArms{.leader = *std::move(leader), .follower = *std::move(follower), .exact = {}};
  }
  if (follower->joints.size() != leader->joints.size()) {
    return inconsistent("arm.follower.urdf",
                        "joint i of the leader commands joint i of the follower, from the base on, so both need "
                        "as many, but the leader has " +
                            listed(*leader) + " and the follower " + listed(*follower) +
                            ": take another arm, make the joints fixed that have no counterpart, or, for a handle "
                            "that slides along three axes, write control.follower.coupling = \"tool\"");
  }
  if (follower->start.any() && follower->start != leader->start) {
    return inconsistent("arm.follower.joints",
                        "the follower begins where the leader does, joint by joint: leave start_rad out, or lead its "
                        "tool (control.follower.coupling)");
  }
  follower->start = leader->start;
  if (Check wrong = check_start(*follower, "arm.follower.urdf")) return *std::move(wrong);
  return DescribedArms{.leader = *std::move(leader), .follower = *std::move(follower), .exact = {}};
}

}  // namespace

namespace {

arm::JointVector assumed_stiffness(const DescribedArm& of) {
  return of.assumed_joint_stiffness_N_m_per_rad.size() > 0 ? of.assumed_joint_stiffness_N_m_per_rad
                                                           : of.joint_stiffness_N_m_per_rad();
}

}  // namespace

Result<DescribedArms> describe_arms(const station::ArmTeleoperatorParams& params, const Urdfs& urdfs) {
  const arm_control::Coupling coupling = params.control.follower.coupling;
  if (Check wrong = refuse_method(params.control, coupling)) return *std::move(wrong);
  if (params.control.tare.cycles > 0 && params.control.method == arm_control::ArmMethod::four_channel) {
    return inconsistent("control.tare.cycles", "the observers of four-channel control take no tare: write 0");
  }
  auto arms = pair_of(params.arm, coupling, urdfs);
  if (!arms) return arms.error();
  for (const DescribedArm* arm : {&arms->leader, &arms->follower}) {
    if (const auto chain = arm::Chain::make(arm->arm.chain); !chain) return under("arm", chain.error());
  }
  arms->exact = {.leader = arms->leader.arm.chain,
                 .follower = arms->follower.arm.chain,
                 .induced = {.chain = arms->leader.arm.chain,
                             .tool_m = arms->leader.arm.tool_m,
                             .joint_stiffness_N_m_per_rad = assumed_stiffness(arms->leader),
                             .joint_damping_N_m_s_per_rad = arms->leader.joint_damping_N_m_s_per_rad()},
                 .hand = params.control.model.hand,
                 .follower_joint_stiffness_N_m_per_rad = assumed_stiffness(arms->follower)};
  return arms;
}

}  // namespace tactus::urdf
