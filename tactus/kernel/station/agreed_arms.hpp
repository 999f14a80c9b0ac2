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
  std::string leader, follower;  ///< digests of the model parameters of both arms
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
        field("arm.follower", &P::follower, "The same of the follower."),
        field("arm.tool", &P::leader_tool, "Where the leader's hand is."),
        field("arm.follower.tool", &P::follower_tool, "Where the follower touches."),
        field("servo.rate_Hz", &P::rate_Hz, units::hertz, positive, "Control cycles per second, equal at both sites."),
        field("control", &P::control, "Each site takes the other to be its half."),
        field("rig.leader_gate", &P::leader_gate, "What the leader's motors do at most."),
        field("rig.follower_gate", &P::follower_gate, "What the follower's motors do at most."),
        field("rig.gripper", &P::gripper, "Both ends of a spring between the sites."),
        field("rig.supervision.packets", &P::packets, "What a site accepts of the other."),
        field("rig.supervision.silence", &P::silence, "What a site does in silence."),
        field("rig.supervision.watchdog", &P::watchdog, "When it holds."),
        field("rig.supervision.answer_within_s", &P::answer_within_s, units::second, positive,
              "When an arming is given up."),
        field("rig.supervision.blend_s", &P::blend_s, units::second, positive, "How a force comes and goes.")};
  }
};

/// Of an experiment with arms, and of the model parameters of its arms. Allocates.
AgreedArms agreed_arms(const ArmTeleoperatorParams& params, const DescribedArms& arms);

}  // namespace tactus::station
