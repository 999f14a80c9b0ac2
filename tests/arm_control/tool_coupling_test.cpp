// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/arm_follower.hpp>
#include <tactus/kernel/arm_control/tool_coupling.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "tests/allocation_counter.hpp"
#include "tests/arm_plants/openarm.hpp"

namespace tactus::arm_control::tool_coupling_test {
namespace {

using arm::Matrix3;
using arm::Vector3;
using arm_plants::ArmPlant;

constexpr Seconds tick{1e-3};

/// A leader that slides along three directions, none square to another.
arm::Chain::Params handle() {
  arm::Chain::Params params{.joints = Joints<arm::JointParams>(3)};
  params.joints[0].axis = {.x = 1.0, .y = 0.0, .z = 0.0};
  params.joints[1].axis = {.x = 0.3, .y = 1.0, .z = 0.0};
  params.joints[2].axis = {.x = 0.0, .y = 0.2, .z = 1.0};
  for (arm::JointParams& joint : params.joints) {
    joint.kind = arm::JointKind::prismatic;
    joint.body.mass_kg = 0.1;
  }
  return params;
}

Matrix3 skewed() { return ToolCoupling::axes_of(handle()).value(); }

ToolCoupling coupling(double scale, const Matrix3& axes) {
  const ArmPlant::Params plant = arm_plants::openarm_class();
  const arm::Chain chain = *arm::Chain::make(plant.chain);
  return ToolCoupling::make(scale, axes, {plant.chain, chain, plant.tool_m}, tick).value();
}

ArmMessage at(const Vector3& position_m, const Vector3& velocity_m_per_s = Vector3::Zero()) {
  return {.position = position_m, .velocity = velocity_m_per_s, .external_torque = JointVector::Zero(3)};
}

/// Where MuJoCo, which shares no code with the coupling, puts the tool.
arm_plants::ToolState in_mujoco(const JointVector& position) {
  return ArmPlant::make(arm_plants::openarm_class(), position)->tool();
}

ArmReading resting(const JointVector& position) {
  return {.position = position,
          .velocity = JointVector::Zero(position.size()),
          .torque = JointVector::Zero(position.size())};
}

TEST(ToolCoupling, TheToolGoesWhereTheHandleGoesTimesTheScaleAndKeepsItsAttitude) {
  for (const double scale : {0.5, 1.0, 2.0}) {
    ToolCoupling leads = coupling(scale, skewed());
    const arm_plants::ToolState began = in_mujoco(arm_plants::bent());
    const Vector3 handle_began(0.02, -0.01, 0.03);
    EXPECT_EQ(leads.wanted(at(handle_began), arm_plants::bent()).position, arm_plants::bent()) << "engaged where it is";
    const Vector3 way(0.02 / scale, 0.03 / scale, -0.04 / scale);
    ArmMessage wanted;
    for (int k = 1; k <= 400; ++k) {
      const double share = std::min(1.0, k / 300.0);
      wanted = leads.wanted(at(handle_began + share * way), arm_plants::bent());
    }
    const arm_plants::ToolState now = in_mujoco(wanted.position);
    EXPECT_LT((now.position_m - began.position_m - scale * skewed() * way).norm(), 2e-5) << scale;
    EXPECT_LT((now.rotation - began.rotation).norm(), 2e-3) << scale;
  }
}

TEST(ToolCoupling, TheReferenceMovesTheToolAsFastAsTheHandle) {
  ToolCoupling leads = coupling(1.5, skewed());
  leads.wanted(at(Vector3::Zero()), arm_plants::bent());
  const Vector3 velocity(0.05, -0.1, 0.08);
  const JointVector wanted = leads.wanted(at(Vector3::Zero(), velocity), arm_plants::bent()).velocity;
  constexpr double small_s = 1e-5;
  const Vector3 moved_m = in_mujoco(arm_plants::bent() + small_s * wanted).position_m -
                          in_mujoco(arm_plants::bent() - small_s * wanted).position_m;
  const Vector3 asked = 1.5 * skewed() * velocity;
  EXPECT_LT((moved_m / (2.0 * small_s) - asked).norm(), 0.01 * asked.norm());
}

TEST(ToolCoupling, WhatComesBackDoesOnTheHandleTheWorkThatTheTorqueDoesOnTheMotionThatItCommands) {
  ToolCoupling leads = coupling(2.0, skewed());
  leads.wanted(at(Vector3::Zero()), arm_plants::bent());
  JointVector torque(7);
  torque << 1.0, -2.0, 0.5, 1.5, -0.3, 0.4, 0.2;
  for (const Vector3& velocity : {Vector3(0.1, 0.0, 0.0), Vector3(0.0, 0.1, 0.0), Vector3(-0.05, 0.02, 0.1)}) {
    const JointVector commanded = leads.wanted(at(Vector3::Zero(), velocity), arm_plants::bent()).velocity;
    const ArmMessage told = leads.told(resting(arm_plants::bent()), torque);
    EXPECT_NEAR(told.external_torque.dot(velocity), torque.dot(commanded), 1e-9);
  }
}

TEST(ToolCoupling, AForceAtTheToolArrivesAtTheHandleTimesTheScaleAndAMomentDoesNot) {
  const ArmPlant plant = *ArmPlant::make(arm_plants::openarm_class(), arm_plants::bent());
  for (const double scale : {1.0, 2.0}) {
    ToolCoupling leads = coupling(scale, Matrix3::Identity());
    leads.wanted(at(Vector3::Zero()), arm_plants::bent());
    const Vector3 force_N(1.0, -2.0, 5.0);
    const auto told = [&](const arm_plants::ToolForce& on_tool) -> Vector3 {
      return leads.told(resting(arm_plants::bent()), plant.torque_of(on_tool)).external_torque.head<3>();
    };
    EXPECT_LT((told({.force_N = force_N}) - scale * force_N).norm(), 0.02 * scale * force_N.norm());
    EXPECT_LT(told({.moment_N_m = Vector3(0.2, 0.2, 0.2)}).norm(), 0.1 * scale);
  }
}

TEST(ToolCoupling, TellsWhereTheHandleWouldBeForTheToolToBeThere) {
  ToolCoupling leads = coupling(2.0, skewed());
  const Vector3 handle_began(0.01, 0.02, 0.03);
  leads.wanted(at(handle_began), arm_plants::bent());
  JointVector other = arm_plants::bent();
  other[1] += 0.05;
  other[3] -= 0.03;
  const Vector3 moved_m = in_mujoco(other).position_m - in_mujoco(arm_plants::bent()).position_m;
  const Vector3 told = leads.told(resting(other), JointVector::Zero(7)).position;
  EXPECT_LT((2.0 * skewed() * (told - handle_began) - moved_m).norm(), 1e-7);
}

TEST(ToolCoupling, OutOfReachNoJointLeavesItsRangeOrItsSpeedAndTheToolComesBack) {
  ToolCoupling leads = coupling(1.0, Matrix3::Identity());
  const arm::Chain::Params arm = arm_plants::openarm_class().chain;
  leads.wanted(at(Vector3::Zero()), arm_plants::bent());
  JointVector before = arm_plants::bent();
  const auto go = [&](const Vector3& handle) {
    for (int k = 0; k < 3000; ++k) {
      const JointVector now = leads.wanted(at(handle), arm_plants::bent()).position;
      for (Eigen::Index i = 0; i < now.size(); ++i) {
        const arm::JointLimits& limits = arm.joints[static_cast<std::size_t>(i)].limits;
        ASSERT_TRUE(std::isfinite(now[i]));
        ASSERT_LE(std::fabs(now[i] - before[i]), limits.velocity_rad_per_s * tick.value * (1.0 + 1e-9));
        ASSERT_LE(now[i], limits.upper_rad);
        ASSERT_GE(now[i], limits.lower_rad);
      }
      before = now;
    }
  };
  go({2.0, 0.0, 0.0});
  go({0.0, 0.0, 2.0});
  go(Vector3::Zero());
  EXPECT_LT((in_mujoco(before).position_m - in_mujoco(arm_plants::bent()).position_m).norm(), 1e-3);
}

TEST(ToolCoupling, EngagedBeyondTheRangeOfAJointItDoesNotJump) {
  ArmPlant::Params plant = arm_plants::openarm_class();
  plant.chain.joints[3].limits.upper_rad = arm_plants::bent()[3] - 0.2;
  const arm::Chain chain = *arm::Chain::make(plant.chain);
  ToolCoupling leads = ToolCoupling::make(1.0, Matrix3::Identity(), {plant.chain, chain, plant.tool_m}, tick).value();
  for (int k = 0; k < 100; ++k) {
    EXPECT_EQ(leads.wanted(at(Vector3::Zero()), arm_plants::bent()).position, arm_plants::bent());
  }
}

TEST(ToolCoupling, WantsThreeJointsThatSlideAlongThreeDirections) {
  arm::Chain::Params turning = handle();
  turning.joints[1].kind = arm::JointKind::revolute;
  EXPECT_EQ(ToolCoupling::axes_of(turning).error().code, ErrorCode::inconsistent);
  EXPECT_NE(ToolCoupling::axes_of(turning).error().message.find("of which 2 slide"), std::string::npos);
  arm::Chain::Params flat = handle();
  flat.joints[2].axis = {.x = 1.0, .y = 1.0, .z = 0.0};
  EXPECT_NE(ToolCoupling::axes_of(flat).error().message.find("within a plane"), std::string::npos);
}

TEST(ToolCoupling, TheFollowersSiteHearsAndTellsThreeNumbersAndItsTickDoesNotAllocate) {
  const ArmPlant::Params plant = arm_plants::openarm_class();
  ArmFollower::Arm arm{.chain = plant.chain, .tool_m = plant.tool_m};
  const ArmFollower::Params params{.coupling = Coupling::tool, .tool_scale = 2.0, .torque = TorqueSource::sensor};
  EXPECT_EQ(ArmFollower::make(params, arm, tick).error().parameter, "coupling");
  arm.leader_axes = Matrix3::Identity();
  auto site = ArmFollower::make(params, arm, tick).value();
  const JointVector torque = ArmPlant::make(plant, arm_plants::bent())->torque_of({.force_N = Vector3(0.0, 0.0, 3.0)});
  ArmFollower::Output output;
  const std::uint64_t before = laws::own_allocation_count();
  output = site.step(resting(arm_plants::bent()), torque, at(Vector3::Zero()));
  EXPECT_EQ(laws::own_allocation_count(), before);
  EXPECT_EQ(output.command.position, arm_plants::bent());
  ASSERT_EQ(output.message.external_torque.size(), 3);
  EXPECT_NEAR(output.message.external_torque[2], 6.0, 0.1);
}

}  // namespace
}  // namespace tactus::arm_control::tool_coupling_test
