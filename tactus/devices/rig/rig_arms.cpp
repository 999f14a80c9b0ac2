#include <tactus/arm_control/arm_sites.hpp>
#include <tactus/control/protective_limits.hpp>
#include <tactus/control/supervised_site.hpp>
#include <tactus/devices/rig/rig_arms.hpp>
#include <tactus/station/wall.hpp>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace tactus::devices {

namespace {

using arm_control::ArmMethod;
using arm_control::DriveGains;
using control::SafetyGate;
using experiments::ArmPairSetup;

Error problem_at(const std::string& parameter, ErrorCode code, std::string message) {
  return {.code = code, .parameter = parameter, .message = std::move(message), .place = {}};
}

std::string listed(const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  return all;
}

/// The most that the sites ask of each drive's law.
Joints<DriveGains> asked_of_leader(const ArmPairSetup& setup) {
  const auto& sites = setup.params.control;
  const std::size_t joints = setup.joints.size();
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
Joints<DriveGains> asked_of_follower(const ArmPairSetup& setup) {
  Joints<DriveGains> asked = setup.params.control.follower.gains.of(setup.joints.size());
  for (DriveGains& gains : asked) gains.stiffness_N_m_per_rad *= setup.params.control.follower.stiffness_share;
  return asked;
}

/// The same of a joint that the arm does not have.
DriveGains asked_beside(const ArmPairSetup& setup, bool leads) {
  const experiments::GripperParams& gripper = setup.params.rig.gripper;
  const double share = leads ? gripper.leader_share : 1.0;
  return {.stiffness_N_m_per_rad = share * gripper.stiffness_N_m_per_rad,
          .damping_N_m_s_per_rad = share * gripper.damping_N_m_s_per_rad};
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
        format_number(limit) + unit + " is less than the " + format_number(wanted) + unit +
            " that the experiment asks of its motor's own law: write at least that, or lower the gain there");
  };
  const MotorJoint& may = joint.joint;
  if (Check error = below("stiffness_limit_Nm_per_rad", may.stiffness_limit_Nm_per_rad, asked.stiffness_N_m_per_rad,
                          " N m/rad")) {
    return error;
  }
  return below("damping_limit_Nms_per_rad", may.damping_limit_Nms_per_rad, asked.damping_N_m_s_per_rad, " N m s/rad");
}

/// The side with its joints in the arm's order, then the others.
Result<RigSide> in_order(const RigSide& side, const ArmPairSetup& setup, const Joints<DriveGains>& asked,
                         const DriveGains& beside) {
  RigSide ordered = side;
  ordered.joints.clear();
  ordered.bus.motors.clear();
  const auto add = [&ordered](const RigJoint& joint, const DriveGains& gains) -> Check {
    if (Check error = check_joint(joint, gains)) return error;
    ordered.joints.push_back(joint);
    ordered.bus.motors.push_back(joint.motor);
    return std::nullopt;
  };
  for (std::size_t i = 0; i < setup.joints.size(); ++i) {
    const auto found = std::ranges::find(side.joints, setup.joints[i], &RigJoint::name);
    if (found == side.joints.end()) {
      return problem_at(side.path, ErrorCode::missing,
                        "the arm of " + setup.params.arm.urdf + " has a joint " + setup.joints[i] +
                            ", and the rig has none: write [" + join(side.path, setup.joints[i]) + "]");
    }
    if (Check error = add(*found, asked[i])) return *std::move(error);
  }
  const experiments::GripperParams& gripper = setup.params.rig.gripper;
  const bool driven = gripper.stiffness_N_m_per_rad > 0.0 || gripper.damping_N_m_s_per_rad > 0.0;
  for (const RigJoint& joint : side.joints) {
    if (std::ranges::find(setup.joints, joint.name()) != setup.joints.end()) continue;
    if (!driven) {
      return problem_at(joint.path, ErrorCode::inconsistent,
                        "the arm of " + setup.params.arm.urdf + " has no joint of this name but " +
                            listed(setup.joints) +
                            ": call it as the arm does; or, where it is a gripper, write its gains under [rig.gripper] "
                            "of the experiment");
    }
    if (Check error = add(joint, beside)) return *std::move(error);
  }
  return ordered;
}

Check check_gate(const SafetyGate::Params& gate, const std::string& name, Seconds tick) {
  if (Check error = control::refuse_default_limits(gate, name)) return error;
  if (const auto made = SafetyGate::make(gate, tick); !made) return under(name, made.error());
  return std::nullopt;
}

Joints<SafetyGate::Params> gates(const SafetyGate::Params& of_all, const Joints<station::DeviceLimits>& limits) {
  Joints<SafetyGate::Params> each(limits.size());
  for (std::size_t i = 0; i < limits.size(); ++i) each[i] = station::tightened(of_all, limits[i]);
  return each;
}

/// The arm with no more torque than its gates let through.
arm::Chain::Params within(const arm::Chain::Params& chain, const Joints<SafetyGate::Params>& gates) {
  arm::Chain::Params own = chain;
  for (std::size_t i = 0; i < own.joints.size(); ++i) {
    double& most_N_m = own.joints[i].limits.effort_N_m;
    most_N_m = std::min(most_N_m, gates[i].force_limit_N);
  }
  return own;
}

Result<Joints<control::SupervisionParams>> supervision(const experiments::ArmRigParams& rig, std::size_t joints) {
  const auto torque = rig.probe_torque.of(joints);
  Joints<control::SupervisionParams> each(joints, rig.supervision);
  for (std::size_t i = 0; i < joints; ++i) {
    double& force_N = each[i].probe.force_N;
    if (torque[i].torque_N_m > 0.0) force_N = torque[i].torque_N_m;
    if (force_N > 0.0) continue;
    return problem_at("rig.supervision.probe.force_N", ErrorCode::inconsistent,
                      "0 N m tries no motor, and joint " + std::to_string(i + 1) +
                          " has no torque of its own below rig.probe_torque: write more than its friction");
  }
  return each;
}

}  // namespace

Result<RigPair> as_arms(const RigPair& pair, const ArmPairSetup& setup) {
  const auto leader = in_order(*pair.leader, setup, asked_of_leader(setup), asked_beside(setup, true));
  if (!leader) return leader.error();
  const auto follower = in_order(*pair.follower, setup, asked_of_follower(setup), asked_beside(setup, false));
  if (!follower) return follower.error();
  return RigPair{.name = pair.name, .leader = *leader, .follower = *follower};
}

Result<station::JointSupervisedPair> arm_sites(const ArmPairSetup& setup, const Joints<station::DeviceLimits>& leader,
                                               const Joints<station::DeviceLimits>& follower) {
  const auto& sites = setup.params.control;
  const experiments::ArmRigParams& rig = setup.params.rig;
  if (sites.method == ArmMethod::four_channel) {
    return problem_at("control.method", ErrorCode::inconsistent,
                      "four-channel control is tried in virtual time alone: write another method for a rig");
  }
  const std::size_t of_arm = setup.joints.size(), joints = leader.size();
  if (joints < of_arm || joints > most_joints) {
    return out_of_bounds("joints", static_cast<double>(joints), between(static_cast<double>(of_arm), most_joints),
                         units::none);
  }
  const Joints<DriveGains> beside_leader(joints - of_arm, asked_beside(setup, true));
  const Joints<DriveGains> beside_follower(joints - of_arm, asked_beside(setup, false));
  const Seconds tick{1.0 / setup.params.servo.rate_Hz};
  if (Check error = check_gate(rig.leader_gate, "rig.leader_gate", tick)) return *std::move(error);
  if (Check error = check_gate(rig.follower_gate, "rig.follower_gate", tick)) return *std::move(error);
  const auto supervised = supervision(rig, joints);
  if (!supervised) return supervised.error();
  const auto leader_gates = gates(rig.leader_gate, leader), follower_gates = gates(rig.follower_gate, follower);
  auto leads = arm_control::leader_site(sites,
                                        {.carried = within(setup.arm.chain, leader_gates),
                                         .induced = setup.induced,
                                         .gains = sites.follower.gains.of(of_arm)},
                                        leader_gates, tick, beside_leader);
  if (!leads) return under("control", leads.error());
  auto follows = arm_control::follower_site(sites.follower,
                                            {.chain = within(setup.arm.chain, follower_gates),
                                             .tool_m = setup.arm.tool_m,
                                             .joint_stiffness_N_m_per_rad = setup.induced.joint_stiffness_N_m_per_rad},
                                            follower_gates, tick, beside_follower);
  if (!follows) return under("control.follower", follows.error());
  constexpr std::int64_t master_session = 1, slave_session = 2;
  auto master = control::supervise_master(*std::move(leads), *supervised, master_session, tick);
  if (!master) return under("rig", master.error());
  auto slave = control::supervise_slave(*std::move(follows), *supervised, slave_session, tick);
  if (!slave) return under("rig", slave.error());
  return station::JointSupervisedPair::around(*std::move(master), *std::move(slave), {}, tick,
                                              Joints<double>(joints, 0.0));
}

}  // namespace tactus::devices
