// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm/largest_inertia.hpp>
#include <tactus/kernel/arm_control/arm_sites.hpp>
#include <tactus/kernel/control/protective_limits.hpp>
#include <tactus/kernel/control/support_law.hpp>
#include <tactus/kernel/station/make_device_guard.hpp>
#include <tactus/kernel/station/supervised_arms.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <Eigen/Cholesky>

namespace tactus::station {

namespace {

using control::SafetyGate;

Check check_arm_gate(const SafetyGate::Params& gate, const std::string& name, Seconds tick) {
  SafetyGate::Params chosen = gate;
  chosen.encoder.frozen_force_N = 1.5 * gate.force_limit_N;  // follows from each joint's limit, see joint_gates
  if (Check error = control::refuse_default_limits(chosen, name)) return error;
  if (const auto made = SafetyGate::make(gate, tick); !made) return under(name, made.error());
  return std::nullopt;
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

Result<Joints<control::SupervisionParams>> joint_supervision(const ArmRigParams& rig, std::size_t joints) {
  const auto torque = rig.probe_torque.of(joints);
  Joints<control::SupervisionParams> each(joints, rig.supervision);
  for (std::size_t i = 0; i < joints; ++i) {
    double& force_N = each[i].probe.force_N;
    if (torque[i].torque_N_m > 0.0) force_N = torque[i].torque_N_m;
    if (force_N > 0.0) continue;
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "rig.supervision.probe.force_N",
                 .message = "0 N m tries no motor, and joint " + std::to_string(i + 1) +
                            " has no torque of its own below rig.probe_torque: write more than its friction",
                 .place = {}};
  }
  return each;
}

/// That the sign probe can move each joint of the arm, by its inertia at the pose at which it begins. The other joints
/// are free here and nothing rubs, so that what is refused could pass nowhere near that pose. An arm that is too heavy
/// for its gates gets no power, so its probes do not matter; a chain that is wrong is reported by the site.
Check check_probes(const DescribedArm& described, const Joints<control::SupervisionParams>& supervision,
                   const Joints<SafetyGate::Params>& gates) {
  const auto chain = arm::Chain::make(described.arm.chain);
  if (!chain) return std::nullopt;
  const arm::JointVector weight = chain->gravity_torque(described.start);
  const arm::JointMatrix mass = chain->mass_matrix(described.start);
  const arm::JointMatrix mobility =
      mass.llt().solve(arm::JointMatrix(arm::JointMatrix::Identity(mass.rows(), mass.cols())));
  for (std::size_t i = 0; i < described.joints.size(); ++i) {
    if (std::fabs(weight[static_cast<Eigen::Index>(i)]) > gates[i].force_limit_N) return std::nullopt;
  }
  for (std::size_t i = 0; i < described.joints.size(); ++i) {
    const control::SignProbe::Params& probe = supervision[i].probe;
    const auto at = static_cast<Eigen::Index>(i);
    const double inertia_kg_m2 = 1.0 / mobility(at, at);
    const double torque_N_m = std::max(probe.force_N, probe.most_force_N);
    const double needed_N_m = 50.0 * probe.least_m * inertia_kg_m2 / (probe.duration_s * probe.duration_s);
    if (torque_N_m == 0.0 || torque_N_m >= needed_N_m) continue;
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "rig.probe_torque.joint_" + std::to_string(i + 1) + ".torque_N_m",
                 .message = rounded_number(torque_N_m) + " N m cannot move " + described.joints[i] + ", of " +
                            rounded_number(inertia_kg_m2) + " kg m2, by supervision.probe.least_m, " +
                            rounded_number(probe.least_m) + " rad, within supervision.probe.duration_s, " +
                            rounded_number(probe.duration_s) + " s: write from " + rounded_number(needed_N_m) +
                            " N m and its friction up to the gate's limit, " + rounded_number(gates[i].force_limit_N) +
                            " N m, or a longer duration_s",
                 .place = {}};
  }
  return std::nullopt;
}

/// The damping that the drives run while a site is coupled, of each joint of its arm.
Joints<double> own_damping(const ArmTeleoperatorParams& params, const DescribedArms& arms, bool leads) {
  const auto& sites = params.control;
  const std::size_t joints = arms.leader.joints.size();
  const auto gains = sites.follower.gains.of(joints);
  const auto leader_damping = sites.drive_damping.of(joints);
  const bool pulls = sites.method == arm_control::ArmMethod::position_position;
  Joints<double> damping(joints);
  for (std::size_t i = 0; i < joints; ++i) {
    const double pulling = gains[i].damping_N_m_s_per_rad;
    damping[i] = !leads ? pulling : pulls ? sites.force_gain * pulling : leader_damping[i].damping_N_m_s_per_rad;
  }
  return damping;
}

/// How the support of each of the arm's joints is judged, and with which torque its motor is tried first.
void judge_support(const ArmTeleoperatorParams& params, const DescribedArms& arms, bool leads,
                   const Joints<SafetyGate::Params>& gates, const Joints<DeviceLimits>& limits,
                   Joints<control::SupervisionParams>& supervision) {
  const ArmSupportParams& asked = params.rig.support;
  const auto damping = own_damping(params, arms, leads);
  const DescribedArm& arm = leads ? arms.leader : arms.follower;
  const auto& chain = arm.arm.chain;
  if (!arm::Chain::make(chain)) return;  // the site reports what is wrong with it
  // An arm may be armed at any pose: hanging, its shoulder has more than twice the inertia of an arm that is bent.
  const arm::JointVector inertia = arm::largest_inertia(chain);
  for (std::size_t i = 0; i < damping.size(); ++i) {
    control::SignProbe::Params& probe = supervision[i].probe;
    supervision[i].support = control::with_holding_law(
        {.raise_s = asked.raise_s,
         .weight_share = asked.weight_share,
         .weight_limit_N = std::clamp(std::min(gates[i].force_limit_N, chain.joints[i].limits.effort_N_m), 1e-9, 100.0),
         .most_m = asked.most_rad,
         .most_m_per_s = asked.most_rad_per_s},
        {.own_damping_N_s_per_m = damping[i],
         .damping_limit_N_s_per_m = limits[i].damping_N_s_per_m,
         .force_limit_N = gates[i].force_limit_N,
         .trial_force_N = std::max(probe.force_N, probe.most_force_N),
         .friction_N = chain.joints[i].friction.coulomb_N_m},
        Seconds{1.0 / params.servo.rate_Hz});
    probe = control::with_gentle_trial(probe, supervision[i].support, inertia[static_cast<Eigen::Index>(i)]);
  }
}

/// What a site begins with.
struct Begun {
  std::size_t of_arm;  ///< joints
  Seconds tick;
  Joints<SafetyGate::Params> gates;
  Joints<control::SupervisionParams> supervision;
};

Result<Begun> begin(const ArmTeleoperatorParams& params, const DescribedArms& arms, bool leads,
                    const Joints<DeviceLimits>& limits, const ArmSiteStart& start) {
  const SafetyGate::Params& gate = leads ? params.rig.leader_gate : params.rig.follower_gate;
  const std::string name = leads ? "rig.leader_gate" : "rig.follower_gate";
  if (params.control.method == arm_control::ArmMethod::four_channel) {
    return Error{
        .code = ErrorCode::inconsistent,
        .parameter = "control.method",
        .message = "four-channel control is tried in virtual time alone, without supervision: write another method",
        .place = {}};
  }
  if (Check wrong = refuse_tool_coupling(params, "supervision, of tactus faults and of a rig,")) {
    return *std::move(wrong);
  }
  const std::size_t of_arm = arms.leader.joints.size(), joints = limits.size();
  if (joints < of_arm || joints > most_joints) {
    return out_of_bounds("joints", static_cast<double>(joints), between(static_cast<double>(of_arm), most_joints),
                         units::none);
  }
  const Seconds tick{1.0 / params.servo.rate_Hz};
  if (Check error = check_arm_gate(gate, name, tick)) return *std::move(error);
  auto supervised = joint_supervision(params.rig, joints);
  if (!supervised) return supervised.error();
  if (!start.tries_motors) {
    for (control::SupervisionParams& joint : *supervised) joint.probe.force_N = joint.probe.most_force_N = 0.0;
  }
  Begun begun{
      .of_arm = of_arm, .tick = tick, .gates = joint_gates(gate, limits), .supervision = *std::move(supervised)};
  for (std::size_t i = 0; i < joints; ++i) {
    // No motor is tried with more than its gate lets through: leader and follower share a file, not their motors.
    control::SignProbe::Params& probe = begun.supervision[i].probe;
    probe.force_N = std::min(probe.force_N, begun.gates[i].force_limit_N);
    probe.most_force_N = std::min(probe.most_force_N, begun.gates[i].force_limit_N);
  }
  if (start.tries_motors) {
    const DescribedArm& arm = leads ? arms.leader : arms.follower;
    if (Check weak = check_probes(arm, begun.supervision, begun.gates)) return *std::move(weak);
  }
  if (start.judges_support) judge_support(params, arms, leads, begun.gates, limits, begun.supervision);
  return begun;
}

}  // namespace

arm_control::DriveGains beside_the_arm(const ArmTeleoperatorParams& params, bool leads) {
  const GripperParams& gripper = params.rig.gripper;
  const double share = leads ? gripper.leader_share : 1.0;
  return {.stiffness_N_m_per_rad = share * gripper.stiffness_N_m_per_rad,
          .damping_N_m_s_per_rad = share * gripper.damping_N_m_s_per_rad};
}

Joints<SafetyGate::Params> joint_gates(const SafetyGate::Params& of_all, const Joints<DeviceLimits>& limits) {
  Joints<SafetyGate::Params> each(limits.size());
  for (std::size_t i = 0; i < limits.size(); ++i) {
    each[i] = tightened(of_all, limits[i]);
    const bool unchosen = of_all.encoder.frozen_force_N == SafetyGate::Params{}.encoder.frozen_force_N;
    constexpr double gives_none_N = 1e-6, change = 1.5;
    if (unchosen && each[i].force_limit_N > gives_none_N) {
      each[i].encoder.frozen_force_N = change * each[i].force_limit_N;
    }
  }
  return each;
}

Result<control::JointSupervisedMaster> arm_leader_site(const ArmTeleoperatorParams& params, const DescribedArms& arms,
                                                       const Joints<DeviceLimits>& limits, const ArmSiteStart& start) {
  const auto begun = begin(params, arms, true, limits, start);
  if (!begun) return begun.error();
  const auto& sites = params.control;
  const Joints<arm_control::DriveGains> beside(limits.size() - begun->of_arm, beside_the_arm(params, true));
  auto leads = arm_control::leader_site(sites,
                                        {.carried = within(arms.leader.arm.chain, begun->gates),
                                         .induced = arms.exact.induced,
                                         .gains = sites.follower.gains.of(begun->of_arm),
                                         .tare = sites.tare},
                                        begun->gates, begun->tick, beside);
  if (!leads) return under("control", leads.error());
  auto master =
      control::supervise_master(*std::move(leads), begun->supervision, start.session, begun->tick, start.agreement);
  if (!master) return under("rig", master.error());
  return master;
}

Result<control::JointSupervisedSlave> arm_follower_site(const ArmTeleoperatorParams& params, const DescribedArms& arms,
                                                        const Joints<DeviceLimits>& limits, const ArmSiteStart& start) {
  const auto begun = begin(params, arms, false, limits, start);
  if (!begun) return begun.error();
  const Joints<arm_control::DriveGains> beside(limits.size() - begun->of_arm, beside_the_arm(params, false));
  auto follows =
      arm_control::follower_site(params.control.follower,
                                 {.chain = within(arms.follower.arm.chain, begun->gates),
                                  .tool_m = arms.follower.arm.tool_m,
                                  .joint_stiffness_N_m_per_rad = arms.exact.follower_joint_stiffness_N_m_per_rad,
                                  .passivity = {params.control.passivity, params.control.force_gain},
                                  .tare = params.control.tare},
                                 begun->gates, begun->tick, beside);
  if (!follows) return under("control.follower", follows.error());
  auto slave =
      control::supervise_slave(*std::move(follows), begun->supervision, start.session, begun->tick, start.agreement);
  if (!slave) return under("rig", slave.error());
  return slave;
}

Result<SupervisedArms> supervise_arms(const ArmTeleoperatorParams& params, const DescribedArms& arms,
                                      const Joints<DeviceLimits>& leader, const Joints<DeviceLimits>& follower,
                                      const ArmStart& start) {
  ArmSiteStart own{
      .session = start.leader_session, .tries_motors = start.tries_motors, .judges_support = start.judges_support};
  auto leads = arm_leader_site(params, arms, leader, own);
  if (!leads) return leads.error();
  own.session = start.follower_session;
  auto follows = arm_follower_site(params, arms, follower, own);
  if (!follows) return follows.error();
  return SupervisedArms{*std::move(leads), *std::move(follows)};
}

Result<JointSupervisedPair> arm_sites(const ArmTeleoperatorParams& params, const DescribedArms& arms,
                                      const Joints<DeviceLimits>& leader, const Joints<DeviceLimits>& follower) {
  auto sites = supervise_arms(params, arms, leader, follower, {});
  if (!sites) return sites.error();
  return JointSupervisedPair::around(std::move(sites->leader), std::move(sites->follower), {},
                                     Seconds{1.0 / params.servo.rate_Hz}, Joints<double>(leader.size(), 0.0));
}

}  // namespace tactus::station
