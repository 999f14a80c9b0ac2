// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm_control/arm_follower.hpp>
#include <tactus/kernel/arm_control/arm_leader.hpp>
#include <tactus/kernel/arm_control/motor_watch.hpp>
#include <tactus/kernel/arm_control/tare.hpp>
#include <tactus/kernel/control/safety_gate.hpp>
#include <tactus/kernel/control/supervision.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <cstdint>
#include <string>
#include <string_view>

/// Parameters of a teleoperator of two arms, whether its sites drive motors or simulated arms: `[arm]`, `[control]`,
/// `[servo]` and `[rig]` of an experiment's file.
namespace tactus::station {

/// A joint and its drive: what its URDF does not contain, and where the joint starts.
struct ArmJoint {
  double start_rad = 0.0;
  double armature_kg_m2 = 0.0;
  double stiffness_share = 1.0;
  double position_step_rad = 0.0;
  double velocity_step_rad_per_s = 0.0;
  double torque_step_N_m = 0.0;
  double play_rad = 0.0;
  static constexpr auto fields() {
    using J = ArmJoint;
    namespace u = arm::units;
    return List{field("start_rad", &J::start_rad, u::radian, any_finite,
                      "Initial position. A follower that is commanded joint by joint starts at the leader's position."),
                field("armature_kg_m2", &J::armature_kg_m2, u::kilogram_metre2, non_negative,
                      "Rotor inertia, referred to the joint's side of the gear."),
                field("stiffness_share", &J::stiffness_share, units::none, positive_up_to(100.0),
                      "Only with elastic joints: factor for this joint on joint_stiffness_N_m_per_rad, on the assumed "
                      "stiffness and on joint_damping_N_m_s_per_rad of its arm."),
                field("position_step_rad", &J::position_step_rad, u::radian, between(0.0, 0.1),
                      "Step of the position that the drive reports; 0: exact."),
                field("velocity_step_rad_per_s", &J::velocity_step_rad_per_s, u::radian_per_second, between(0.0, 1.0),
                      "Step of the velocity that the drive reports."),
                field("torque_step_N_m", &J::torque_step_N_m, u::newton_metre, between(0.0, 1.0),
                      "Step of the torque that the drive reports."),
                field("play_rad", &J::play_rad, u::radian, between(0.0, 0.1),
                      "Backlash of the gear from flank to flank, referred to the joint. Needs an elastic joint.")};
  }
};

struct ToolPoint {
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;
  static constexpr auto fields() {
    return List{field("x_m", &ToolPoint::x_m, units::metre, any_finite,
                      "Position of this point along the x axis of the last link's frame."),
                field("y_m", &ToolPoint::y_m, units::metre, any_finite,
                      "Position of this point along the y axis of the last link's frame."),
                field("z_m", &ToolPoint::z_m, units::metre, any_finite,
                      "Position of this point along the z axis of the last link's frame.")};
  }
};

/// An arm as its URDF and its file have it. Of joints that slide rad stands for m, and N m for N.
struct ArmParams {
  std::string urdf;
  std::string tip;
  ToolPoint tool;
  double joint_stiffness_N_m_per_rad = 0.0;
  double assumed_joint_stiffness_N_m_per_rad = 0.0;
  double joint_damping_N_m_s_per_rad = 0.0;
  arm_control::EachJoint<ArmJoint> joints;
  static constexpr auto fields() {
    using A = ArmParams;
    return List{field("urdf", &A::urdf,
                      "URDF of the arm, z up. A relative path starts at the folder of the experiment file. Its effort "
                      "limits limit the motors; its damping and friction act at the joints."),
                field("tip", &A::tip,
                      "Link at which the arm ends. Joints off the chain to it, such as those of a gripper's fingers, "
                      "count as fixed. Needed if the URDF has branches or moving joints beyond the tip. Empty: the end "
                      "of the only chain."),
                field("tool", &A::tool, "The point that the operator holds, or that touches the surface."),
                field("joint_stiffness_N_m_per_rad", &A::joint_stiffness_N_m_per_rad, Unit{"N m/rad", "_N_m_per_rad"},
                      between(0.0, 1e6), "Stiffness of the transmission between motor and link; 0 is rigid."),
                field("assumed_joint_stiffness_N_m_per_rad", &A::assumed_joint_stiffness_N_m_per_rad,
                      Unit{"N m/rad", "_N_m_per_rad"}, between(0.0, 1e6),
                      "Joint stiffness that models and observers of elastic joints assume; 0: the true value, "
                      "joint_stiffness_N_m_per_rad."),
                field("joint_damping_N_m_s_per_rad", &A::joint_damping_N_m_s_per_rad,
                      arm::units::newton_metre_second_per_radian, between(0.0, 100.0),
                      "Damping in parallel with joint_stiffness_N_m_per_rad."),
                field("joints", &A::joints, "Properties of each joint that the URDF does not contain.")};
  }
};

/// Leader and follower. Joint i of the leader, counted from the base on, commands joint i of the follower, angle for
/// angle, so both have as many joints, with the same zero and sense; or it leads the follower's tool
/// (`arm_control::Coupling`), and both are what they are.
struct ArmPairParams : ArmParams {
  ArmParams follower;
  static constexpr auto fields() {
    return joined(
        ArmParams::fields(),
        List{field("follower", &ArmPairParams::follower,
                   "The follower, if it differs from the leader. Set urdf and all other keys here. Without a urdf the "
                   "follower is like the leader. Joint i of the leader, counted from the base, commands the angle of "
                   "joint i of the follower, unless control.follower.coupling is tool.")});
  }
};

struct ArmControlParams : arm_control::ArmLeader::Params {
  arm_control::ArmFollower::Params follower = {};
  arm_control::Tare::Params tare = {};
  static constexpr auto fields() {
    return joined(
        arm_control::ArmLeader::Params::fields(),
        List{field("follower", &ArmControlParams::follower, "The follower's site."),
             field("tare", &ArmControlParams::tare,
                   "Measurement of the errors of both arms' gravity compensation. With simulated taps it takes place "
                   "before the operator takes the leader. On a rig the operator requests it with the command tare.")});
  }
};

struct ArmClockParams {
  double rate_Hz = 1000.0;
  double plant_step_s = 1e-4;
  std::int64_t extra_delay_cycles = 0;
  static constexpr auto fields() {
    return List{field("rate_Hz", &ArmClockParams::rate_Hz, units::hertz, between(100.0, 10000.0),
                      "Control cycles per second; a command acts from the next control cycle on."),
                field("plant_step_s", &ArmClockParams::plant_step_s, units::second, between(1e-6, 5e-4),
                      "Integration step of the simulated arms. It is shortened if necessary, so that a control cycle "
                      "is a whole number of steps."),
                field("extra_delay_cycles", &ArmClockParams::extra_delay_cycles, between(0, 20),
                      "Additional control cycles until a command acts on a simulated arm. The sites always assume one "
                      "cycle in all.")};
  }
};

struct ProbeTorque {
  double torque_N_m = 0.0;
  static constexpr auto fields() {
    return List{field("torque_N_m", &ProbeTorque::torque_N_m, arm::units::newton_metre, between(0.0, 100.0),
                      "Peak torque of the test of the joint's motor. Must be greater than the friction of the joint. "
                      "0: supervision.probe.force_N.")};
  }
};

/// A gripper, or any other joint that the arm does not have: each drive pulls its own to the position of the other's.
struct GripperParams : arm_control::DriveGains {
  double leader_share = 0.0;
  static constexpr auto fields() {
    return joined(arm_control::DriveGains::fields(),
                  List{field("leader_share", &GripperParams::leader_share, units::none, between(0.0, 1.0),
                             "Gains of the leader's drive divided by the gains above, which are the follower's.")});
  }
};

/// How the motors of an arm take over its weight on arming (`control::SupportCheck`).
struct ArmSupportParams {
  double raise_s = 4.0;
  double weight_share = 0.3;
  double most_rad = 0.02;
  double most_rad_per_s = 0.4;
  static constexpr auto fields() {
    using P = ArmSupportParams;
    return List{
        field("raise_s", &P::raise_s, units::second, between(0.5, 30.0),
              "Time in which gravity compensation ramps in."),
        field("weight_share", &P::weight_share, units::none, positive_up_to(1.0),
              "Tolerated error of gravity compensation as a share of a joint's gravity torque, but at least the torque "
              "of the motor test. Above it the arm is released."),
        field("most_rad", &P::most_rad, arm::units::radian, positive_up_to(0.03),
              "Travel of a joint during the ramp above which the arm is released; in m for a sliding joint."),
        field("most_rad_per_s", &P::most_rad_per_s, arm::units::radian_per_second, positive_up_to(0.5),
              "Speed of a joint during the ramp above which the arm is released; in m/s for a sliding joint.")};
  }
};

/// Gates and supervision before the motors of a rig, and in `tactus faults`. Taps in virtual time run without them.
struct ArmRigParams {
  control::SafetyGate::Params leader_gate;
  control::SafetyGate::Params follower_gate;
  control::SupervisionParams supervision;
  ArmSupportParams support;
  arm_control::EachJoint<ProbeTorque> probe_torque;
  arm_control::MotorWatch::Params motor_watch;
  GripperParams gripper{{.stiffness_N_m_per_rad = 0.0, .damping_N_m_s_per_rad = 0.0}};
  static constexpr auto fields() {
    using P = ArmRigParams;
    return List{field("leader_gate", &P::leader_gate,
                      "The safety gate of each of the leader's joints; the limits of the rig file apply as well."),
                field("follower_gate", &P::follower_gate, "The safety gate of each of the follower's joints."),
                field("supervision", &P::supervision, "Supervision of each site and of its peer."),
                field("support", &P::support, "The ramp of gravity compensation on arming, and its checks."),
                field("probe_torque", &P::probe_torque, "The torque that tests the sign of each motor on arming."),
                field("motor_watch", &P::motor_watch, "Detection of a motor that does not apply the commanded torque."),
                field("gripper", &P::gripper,
                      "Gains of the rig's joints that the arm's URDF does not contain, such as a gripper; without "
                      "gains such a joint is refused.")};
  }
};

/// What the sites of two arms compute with. Kinds of experiments add what is simulated, and the task.
struct ArmTeleoperatorParams {
  ArmPairParams arm;
  ArmControlParams control;
  ArmClockParams servo;
  ArmRigParams rig;
  static constexpr auto fields() {
    using P = ArmTeleoperatorParams;
    return List{field("arm", &P::arm, "The leader, and also the follower unless arm.follower describes another arm."),
                field("control", &P::control, "The sites of both arms."), field("servo", &P::servo, "The clocks."),
                field("rig", &P::rig,
                      "Only with --device and tactus faults: gates and supervision between the sites and the motors of "
                      "a rig. For a rotary joint, N, m and m/s in a key mean N m, rad and rad/s.")};
  }
};

/// Whether the follower is another arm than the leader.
inline bool differs(const ArmPairParams& params) { return !params.follower.urdf.empty(); }

/// Errors: `inconsistent`, under `control.tare.cycles`, for a run in which nobody can ask for a tare.
Check refuse_tare(const ArmTeleoperatorParams& params);

/// Errors: `inconsistent`, under `control.follower.coupling`, for a leader that leads the tool: `what` ("tactus
/// faults") knows arms that are led joint by joint alone.
Check refuse_tool_coupling(const ArmTeleoperatorParams& params, std::string_view what);

}  // namespace tactus::station
