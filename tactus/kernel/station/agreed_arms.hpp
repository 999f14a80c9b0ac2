// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/station/arm_teleoperator_params.hpp>
#include <tactus/kernel/station/described_arms.hpp>

#include <string>

namespace tactus::station {

/// The parameters that both sites of two arms must have in common before they arm, each under the key of an experiment
/// file: those with which both compute, and the limits and time-outs on which an operator at one site relies at the
/// other. `control::agreement_of` makes the agreement of their bindings.
struct AgreedArms {
  std::string leader, follower;  ///< digests of the arms' models
  ToolPoint leader_tool, follower_tool;
  double rate_Hz = 0.0;
  ArmControlParams control;
  control::SafetyGate::Params leader_gate, follower_gate;
  GripperParams gripper;
  control::PacketJudgeParams packets;
  control::MessageFollower::Params silence;
  control::Watchdog::Params watchdog;
  double answer_within_s = 0.0, blend_s = 0.0;
  static constexpr auto fields() {
    using P = AgreedArms;
    return List{
        field("arm", &P::leader, "Dynamics of the leader."),
        field("arm.follower", &P::follower, "Dynamics of the follower."),
        field("arm.tool", &P::leader_tool, "Point of the leader that the operator holds."),
        field("arm.follower.tool", &P::follower_tool, "Point of the follower that touches the surface."),
        field("servo.rate_Hz", &P::rate_Hz, units::hertz, positive, "Control cycles per second, equal at both sites."),
        field("control", &P::control, "Controllers of both sites."),
        field("rig.leader_gate", &P::leader_gate, "Limits of the leader's motors."),
        field("rig.follower_gate", &P::follower_gate, "Limits of the follower's motors."),
        field("rig.gripper", &P::gripper, "Coupling of the grippers."),
        field("rig.supervision.packets", &P::packets, "Which packets a site accepts."),
        field("rig.supervision.silence", &P::silence, "Reaction to missing packets."),
        field("rig.supervision.watchdog", &P::watchdog, "Timeout after which a site holds."),
        field("rig.supervision.answer_within_s", &P::answer_within_s, units::second, positive, "Timeout of arming."),
        field("rig.supervision.blend_s", &P::blend_s, units::second, positive,
              "Time in which the coupling fades in and out.")};
  }
};

/// The agreed parameters of an experiment with arms, from its file and the models of the arms. Allocates.
AgreedArms agreed_arms(const ArmTeleoperatorParams& params, const DescribedArms& arms);

}  // namespace tactus::station
