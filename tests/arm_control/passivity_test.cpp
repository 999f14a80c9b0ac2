// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/arm_follower.hpp>
#include <tactus/kernel/arm_control/arm_leader.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <cmath>
#include <cstddef>
#include <deque>
#include <string>

#include "tests/allocation_counter.hpp"
#include "tests/arm_plants/openarm.hpp"

namespace tactus::arm_control::passivity_test {
namespace {

constexpr Seconds tick{1e-3};
constexpr int joints = 7;
constexpr PassivePort ports[] = {PassivePort::joints, PassivePort::tool};

/// Dampers as large as they may be, so that what a port lacks is what it really takes.
PassivityParams unlimited(PassivePort port) {
  PassivityParams params{.port = port, .tool_limit_N_s_per_m = 1000.0};
  for_each_field<EachJoint<PassivityLimit>>(
      [&](const auto& each) { (params.joint_limits.*each.member).damping_N_m_s_per_rad = 50.0; });
  return params;
}

ToolJacobian tool_at(const JointVector& position) {
  static const arm::Chain chain = *arm::Chain::make(arm_plants::openarm_class().chain);
  return chain.jacobian(position, joints - 1, arm_plants::openarm_class().tool_m).topRows<3>();
}

JointVector drawn(double most, signal::Random& random) {
  JointVector vector(joints);
  for (double& each : vector) each = random.uniform(-most, most);
  return vector;
}

ArmReading at(const JointVector& position, const JointVector& velocity) {
  return {.position = position, .velocity = velocity, .torque = JointVector::Zero(joints)};
}

/// What a port's own numbers add up to.
double sum(PassivePort port, const JointVector& energy_J) {
  return port == PassivePort::tool ? energy_J[0] : energy_J.sum();
}

TEST(Passivity, WhatAHandPutsInIsTheWorkAgainstTheTorqueThatActed) {
  constexpr double gain = 2.0;
  for (const PassivePort port : ports) {
    PassiveLeader leader(unlimited(port), gain, joints, tick);
    JointVector position = arm_plants::bent();
    const JointVector torque = JointVector::LinSpaced(joints, 0.2, 0.8);
    const JointVector velocity = JointVector::Constant(joints, -0.1);
    constexpr int ticks = 100;
    for (int k = 0; k < ticks; ++k) {
      const JointVector brake =
          leader.brake(at(position, velocity), torque, JointVector::Zero(joints), tool_at(position));
      EXPECT_EQ(brake.norm(), 0.0) << "a hand that pushes needs no brake";
      position += tick.value * velocity;
    }
    // Of the steps between a hundred ticks the first was before any torque acted.
    EXPECT_NEAR(sum(port, leader.in_J()), 0.1 * torque.sum() * tick.value * (ticks - 2) / gain, 1e-12);
  }
}

TEST(Passivity, AFollowerStandsStillAgainstATorqueForWhichNoEnergyCame) {
  for (const PassivePort port : ports) {
    PassiveFollower follower({.params = unlimited(port)}, joints, tick);
    const JointVector resists = JointVector::Constant(joints, -0.5);
    JointVector along(joints), across = JointVector::Zero(joints);
    along.setConstant(0.1);
    across[0] = 0.2;
    across[1] = -0.2;  // does no work against equal torques
    const JointVector velocity = port == PassivePort::tool ? JointVector(along + across) : along;
    JointVector told = arm_plants::bent();
    ArmMessage wanted;
    for (int k = 0; k < 50; ++k) {
      wanted = ArmMessage::at_rest(told);
      wanted.velocity = velocity;
      follower.hold_back(wanted, resists);
      told += tick.value * velocity;
    }
    const JointVector moved = wanted.position - arm_plants::bent();
    EXPECT_NEAR(moved.dot(resists), 0.0, 1e-12);
    if (port == PassivePort::joints) {
      EXPECT_LT(moved.norm(), 1e-12);
      EXPECT_LT(wanted.velocity.norm(), 1e-9);
    } else {
      EXPECT_LT((moved - 49 * tick.value * across).norm(), 1e-12) << "what does no work is free";
    }
  }
}

TEST(Passivity, AFollowerCatchesUpWithinTheRecoveryTimeOnceItMay) {
  const PassivityParams params = unlimited(PassivePort::joints);
  PassiveFollower follower({.params = params}, joints, tick);
  JointVector told = arm_plants::bent();
  const auto step = [&](double torque, double energy_J) {
    ArmMessage wanted = ArmMessage::at_rest(told);
    wanted.energy_J.setConstant(energy_J);
    follower.hold_back(wanted, JointVector::Constant(joints, torque));
    return wanted;
  };
  step(0.0, 0.0);
  told.array() += 0.01;
  EXPECT_NEAR(step(-0.5, 0.0).position[2], arm_plants::bent()[2], 1e-12);
  // A torque of 0.5 N m along 10 mrad takes 5 mJ.
  for (int k = 0; k < 50; ++k) step(-0.5, 1.0);
  EXPECT_NEAR(told[2] - step(-0.5, 1.0).position[2], 0.01 * std::pow(1.0 - 1.0 / 50.0, 51), 1e-6);
}

/// A hand that shakes the leader at 8 Hz, and a follower that pulls at springs: a line of some ticks feeds the shaking.
TEST(Passivity, NoMoreEnergyComesOutOfTheLineThanWentIn) {
  constexpr double stiffness_N_m_per_rad = 100.0, rad_per_s = 50.0;
  struct Line {
    double energy_J = 0.0, least_J = 0.0;
    void add(double in_J) {
      energy_J += in_J;
      least_J = std::fmin(least_J, energy_J);
    }
  };
  for (const PassivePort port : {PassivePort::none, PassivePort::joints, PassivePort::tool}) {
    for (const double gain : {0.5, 4.0}) {
      for (const std::size_t delay : {std::size_t{1}, std::size_t{20}}) {
        PassiveLeader leader(unlimited(port), gain, joints, tick);
        PassiveFollower follower({.params = unlimited(port), .gain = gain}, joints, tick);
        signal::Random random(7);
        const JointVector reach = drawn(0.02, random), none = JointVector::Zero(joints);
        JointVector position = arm_plants::bent(), slave = position, torque = none, acting = none, sent = none;
        std::deque<ArmMessage> to_leader(delay, ArmMessage::at_rest(position)), to_follower(to_leader);
        Line line;
        for (int k = 0; k < 1000; ++k) {
          const double phase = rad_per_s * tick.value * k;
          const JointVector step = arm_plants::bent() + std::sin(phase) * reach - position;
          const ArmReading now = at(position + step, rad_per_s * std::cos(phase) * reach);
          position = now.position;
          // Into the line goes what is done against the leader's motors, and by what drives the follower on.
          line.add(-acting.dot(step) / gain);
          acting = sent;
          const ArmMessage heard = to_leader.front();
          sent = gain * heard.external_torque;
          if (leader.counts()) sent += leader.brake(now, sent, heard.energy_J, tool_at(position));
          ArmMessage wanted = to_follower.front();
          if (follower.counts()) follower.hold_back(wanted, torque);
          line.add(torque.dot(wanted.position - slave));
          slave = wanted.position;
          torque = stiffness_N_m_per_rad * (arm_plants::bent() - slave);
          to_leader.pop_front();
          to_leader.push_back({now.position, none, torque, follower.in_J()});
          to_follower.pop_front();
          to_follower.push_back({now.position, now.velocity, none, leader.in_J()});
        }
        // A damper acts two ticks late; as much may come out before.
        constexpr double late_J = 0.1;
        if (port == PassivePort::none) {
          EXPECT_LT(line.least_J, -5.0 * late_J) << gain << " " << delay;
        } else {
          EXPECT_GT(line.least_J, -late_J) << name_of(port) << " " << gain << " " << delay;
        }
      }
    }
  }
}

TEST(Passivity, ATorqueFromNowhereDrivesAHeldLeaderNoFartherThanItsDelay) {
  const arm_plants::ArmPlant::Params plant = arm_plants::openarm_class();
  for (const PassivePort port : {PassivePort::none, PassivePort::joints, PassivePort::tool}) {
    ArmLeader leader = *ArmLeader::make(
        {.method = ArmMethod::position_force, .feed_forward = {.friction_share = 0.0}, .passivity = unlimited(port)},
        {.carried = plant.chain, .induced = {.chain = plant.chain, .tool_m = plant.tool_m}}, tick);
    auto arm = *arm_plants::ArmPlant::make(plant, arm_plants::bent());
    ArmMessage follower = ArmMessage::at_rest(arm_plants::bent());
    follower.external_torque = tool_at(arm_plants::bent()).transpose() * arm::Vector3(0.0, 0.0, 4.0);
    const JointVector held = arm.read().position;
    ArmCommand sent = ArmCommand::of_torque(JointVector::Zero(joints));
    for (int k = 0; k < 100; ++k) {
      const auto output = leader.step(arm.read(), follower);
      arm.write(sent);
      sent = output.command;
      for (int i = 0; i < 10; ++i) arm.step({});
    }
    const double moved_rad = (arm.read().position - held).norm();
    if (port == PassivePort::none) {
      EXPECT_GT(moved_rad, 0.3);
    } else {
      EXPECT_LT(moved_rad, 0.1) << name_of(port);
    }
  }
}

TEST(Passivity, WithoutItNothingChangesAndNoEnergyIsTold) {
  const arm_plants::ArmPlant::Params plant = arm_plants::openarm_class();
  const ArmFollower::Arm known{.chain = plant.chain, .tool_m = plant.tool_m};
  ArmFollower::Arm at_gain_0 = known;
  at_gain_0.passivity = {.params = unlimited(PassivePort::joints), .gain = 0.0};
  ArmFollower bare = *ArmFollower::make({}, known, tick), none = *ArmFollower::make({}, at_gain_0, tick);
  ArmMessage heard = ArmMessage::at_rest(arm_plants::bent());
  const ArmReading reading = at(arm_plants::bent(), JointVector::Zero(joints));
  for (int k = 0; k < 20; ++k) {
    heard.position.array() += 1e-3;
    const auto one = bare.step(reading, JointVector::Zero(joints), heard);
    const auto other = none.step(reading, JointVector::Zero(joints), heard);
    EXPECT_EQ(one.command.position, heard.position);
    EXPECT_EQ(other.command.position, heard.position) << "without force no energy comes";
    EXPECT_EQ(one.message.energy_J, JointVector::Zero(joints));
  }
}

TEST(Passivity, MethodsThatReflectNoTorqueAreRefusedByTheKey) {
  const arm_plants::ArmPlant::Params plant = arm_plants::openarm_class();
  for (const ArmMethod method : {ArmMethod::position_position, ArmMethod::four_channel}) {
    const auto leader =
        ArmLeader::make({.method = method, .passivity = {.port = PassivePort::tool}},
                        {.carried = plant.chain, .induced = {.chain = plant.chain, .tool_m = plant.tool_m}}, tick);
    ASSERT_FALSE(leader);
    EXPECT_EQ(leader.error().parameter, "passivity.port");
    EXPECT_NE(leader.error().message.find(name_of(method)), std::string::npos);
  }
}

TEST(Passivity, ATickDoesNotAllocate) {
  signal::Random random(5);
  for (const PassivePort port : ports) {
    PassiveLeader leader({.port = port}, 1.0, joints, tick);
    PassiveFollower follower({.params = {.port = port}}, joints, tick);
    ArmMessage wanted = ArmMessage::at_rest(arm_plants::bent());
    const JointVector torque = drawn(1.0, random), velocity = drawn(1.0, random);
    const ArmReading reading = at(arm_plants::bent(), velocity);
    const ToolJacobian tool = tool_at(reading.position);
    const auto before = laws::own_allocation_count();
    leader.brake(reading, torque, follower.in_J(), tool);
    leader.brake(reading, -torque, follower.in_J(), tool);
    follower.hold_back(wanted, torque);
    follower.hold_back(wanted, -torque);
    EXPECT_EQ(laws::own_allocation_count(), before);
  }
}

}  // namespace
}  // namespace tactus::arm_control::passivity_test
