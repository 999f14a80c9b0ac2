#include <tactus/configuration/toml_writer.hpp>
#include <tactus/core/parameters.hpp>
#include <tactus/experiments/arm_tapping/described_arm.hpp>
#include <tactus/urdf/urdf.hpp>

#include <cstddef>
#include <string>
#include <utility>

namespace tactus::experiments {

namespace {

arm::JointVector of_each_motor(const DescribedArm& of, double arm_plants::MotorParams::*number) {
  arm::JointVector found(of.start.size());
  for (std::size_t i = 0; i < of.arm.motors.size(); ++i) {
    found[static_cast<Eigen::Index>(i)] = of.arm.motors[i].*number;
  }
  return found;
}

/// `key` is that of its URDF.
Result<DescribedArm> described(const ArmParams& params, const std::string& key, const Urdfs& urdfs) {
  const auto refused = [&key](const Error& error) { return Error{error.code, key, describe(error), {}}; };
  auto urdf = urdfs(params.urdf);
  if (!urdf) return refused(urdf.error());
  const auto read = urdf::parse(urdf->text, urdf->file);
  if (!read) return refused(read.error());
  if (!read->doubtful_limits.empty()) {
    return Error{ErrorCode::inconsistent, key, read->doubtful_limits.front() + ": an arm that moves needs it", {}};
  }
  const std::size_t joints = read->joints.size();
  const Joints<ArmJoint> of_file = params.joints.of(joints);
  DescribedArm found{.urdf = params.urdf,
                     .urdf_text = std::move(urdf->text),
                     .joints = read->joints,
                     .arm = {.chain = read->params, .motors = Joints<arm_plants::MotorParams>(joints)},
                     .start = arm::JointVector::Zero(static_cast<Eigen::Index>(joints))};
  for (std::size_t i = 0; i < joints; ++i) {
    const ArmJoint& from = of_file[i];
    found.start[static_cast<Eigen::Index>(i)] = from.start_rad;
    arm::JointParams& joint = found.arm.chain.joints[i];
    joint.drive.armature_kg_m2 = from.armature_kg_m2;
    found.arm.motors[i] = {.torque_limit_N_m = joint.limits.effort_N_m,
                           .position_step_rad = from.position_step_rad,
                           .velocity_step_rad_per_s = from.velocity_step_rad_per_s,
                           .torque_step_N_m = from.torque_step_N_m,
                           .joint_stiffness_N_m_per_rad = from.stiffness_share * params.joint_stiffness_N_m_per_rad,
                           .joint_damping_N_m_s_per_rad = from.stiffness_share * params.joint_damping_N_m_s_per_rad};
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

arm::JointVector DescribedArm::joint_stiffness_N_m_per_rad() const {
  return of_each_motor(*this, &arm_plants::MotorParams::joint_stiffness_N_m_per_rad);
}
arm::JointVector DescribedArm::joint_damping_N_m_s_per_rad() const {
  return of_each_motor(*this, &arm_plants::MotorParams::joint_damping_N_m_s_per_rad);
}

Urdfs urdfs_below(const std::filesystem::path& folder) {
  return [folder](const std::string& name) -> Result<UrdfText> {
    const std::filesystem::path file = folder / name;
    auto text = urdf::text_of(file);
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

Result<DescribedPair> describe_pair(const ArmPairParams& params, arm_control::Coupling coupling, const Urdfs& urdfs) {
  auto leader = describe_arm(params, urdfs);
  if (!leader) return leader.error();
  if (!differs(params)) {
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
    return DescribedPair{.leader = *leader, .follower = *leader};
  }
  auto follower = described(params.follower, "arm.follower.urdf", urdfs);
  if (!follower) return follower.error();
  if (coupling == arm_control::Coupling::tool) {
    if (const auto axes = arm_control::ToolCoupling::axes_of(leader->arm.chain); !axes) {
      return Error{axes.error().code, "arm.urdf", axes.error().message, {}};
    }
    if (Check wrong = check_start(*follower, "arm.follower.urdf")) return *std::move(wrong);
    return DescribedPair{.leader = *std::move(leader), .follower = *std::move(follower)};
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
  return DescribedPair{.leader = *std::move(leader), .follower = *std::move(follower)};
}

Check refuse_tool_coupling(const ArmTappingParams& params, std::string_view what) {
  if (params.control.follower.coupling == arm_control::Coupling::joints) return std::nullopt;
  return inconsistent("control.follower.coupling",
                      "tool: " + std::string(what) +
                          " knows arms alone that command one another joint by joint: look at taps in virtual time, "
                          "or write joints and take a leader that has the follower's joints");
}

bool is_of_arms(const configuration::Document& document) {
  const auto kind = document.text_at("task.kind");
  return kind && *kind == name_of(ArmTappingKind::arm_tapping);
}

}  // namespace tactus::experiments
