// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm_control/arm_follower.hpp>
#include <tactus/kernel/arm_control/arm_leader.hpp>
#include <tactus/kernel/control/site.hpp>

/// The controllers of two arms as sites of several joints, like any other: gates are behind them, supervision around
/// them, and `station::step` steps them. Of a joint's message the force is the torque from outside that resists it, and
/// its device reports velocity and torque of its motors and takes a law (`control::DriveLaw`). The gravity
/// compensation of the site is its support: it stays while the coupling comes and goes. Where the leader leads the tool
/// (`ToolCoupling`) the follower's first three joints carry the messages of the leader's three; its others carry
/// nothing.
namespace tactus::arm_control {

/// The last limits before the drive of each joint, for an arm in virtual time: as wide as a gate can be, so that
/// nothing but the arm's own limits shapes its motion.
control::SafetyGate::Params widest_gate();

/// The site of the arm that an operator holds. `gates` has one for each joint; the law of a drive passes them with its
/// force. Joints alongside the arm's, such as that of a gripper, are behind them: each drive pulls its own, with the
/// gains `beside`, to where the other side's is, and nothing carries it. Errors: those of `ArmLeader::make`; those of a
/// gate, under `gate` and the joint; `inconsistent` for another number of gates, or more than `most_joints` joints.
Result<control::JointMasterSite> leader_site(const ArmLeader::Params& params, const ArmLeader::Arm& arm,
                                             const Joints<control::SafetyGate::Params>& gates, Seconds dt,
                                             const Joints<DriveGains>& beside = {});
/// The same of the arm that touches things. What its device reads as force at the tip is taken for what sensors in the
/// joints measure, where `params.torque` states it.
Result<control::JointSlaveSite> follower_site(const ArmFollower::Params& params, const ArmFollower::Arm& arm,
                                              const Joints<control::SafetyGate::Params>& gates, Seconds dt,
                                              const Joints<DriveGains>& beside = {});

}  // namespace tactus::arm_control
