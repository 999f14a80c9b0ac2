// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/simulation/experiments/arm_faults/arm_faults.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_taps.hpp>

#include <algorithm>
#include <filesystem>
#include <string>

#include "tests/experiments/arm_tapping/shipped_taps.hpp"
#include <gtest/gtest.h>

/// A handle that slides along three axes leads the tool of an arm of seven joints.
namespace tactus::experiments::handle_test {

using arm::Vector3;
using arm_control::ArmMethod;
using arm_control::Coupling;

const std::filesystem::path& folder = shipped_folder;

ArmTappingParams shipped(const char* on_top = nullptr) {
  return on_top == nullptr ? shipped_with({"arms/inverse3-arm.toml"})
                           : shipped_with({"arms/inverse3-arm.toml", on_top});
}

TEST(Handle, LeadsTheToolWhereItGoesTimesTheScaleInEveryDirectionAndPose) {
  ArmTappingParams params = shipped();
  params.control.force_gain = 0.0;
  for (const double scale : {1.0, 2.0}) {
    params.control.follower.tool_scale = scale;
    for (const TapDirection direction : {TapDirection::down, TapDirection::along_x, TapDirection::along_y}) {
      params.task.direction = direction;
      params.task.pose = direction == TapDirection::along_y ? 3 : 0;
      const ArmPairSetup setup = *set_up_arm_pair(params, folder);
      EXPECT_EQ(setup.tool_scale, scale);
      EXPECT_EQ(setup.leader.start.size(), 3);
      EXPECT_EQ(setup.follower.start.size(), 7);
      ArmPair pair = *ArmPair::make(setup, setup.exact, -1.0);
      ArmRecord record;
      for (int k = 0; k < 1500; ++k) {
        const Vector3 path_m = -0.04 * std::min(1.0, k / 500.0) * setup.outward;
        record = pair.step(path_m, path_m);
      }
      EXPECT_NEAR(record.leader_m, -0.04 / scale, 0.002 / scale);
      EXPECT_NEAR(record.follower_m, -0.04, 0.004);
      EXPECT_LT(record.tools_apart_m, 0.003) << "what the follower's friction leaves";
    }
  }
}

TEST(Handle, FeelsTheForceOnTheToolTimesScaleAndGain) {
  ArmTappingParams params = shipped();
  params.control.method = ArmMethod::position_force;
  params.control.follower.torque = arm_control::TorqueSource::sensor;
  params.control.damping_N_s_per_m = 0.0;
  params.control.force_gain = 0.4;
  for (const double scale : {1.0, 2.0}) {
    params.control.follower.tool_scale = scale;
    const ArmPairSetup setup = *set_up_arm_pair(params, folder);
    ArmPair pair = *ArmPair::make(setup, setup.exact, -0.01);
    ArmRecord record;
    for (int k = 0; k < 3000; ++k) {
      const Vector3 path_m = -0.02 * std::min(1.0, k / 1000.0) * setup.outward;
      record = pair.step(path_m, path_m);
    }
    ASSERT_GT(record.contact_N, 1.0);
    const ArmSnapshot snapshot = pair.snapshot();
    EXPECT_NEAR(snapshot.sent_N.z(), record.contact_N, 0.03 * record.contact_N) << "in newtons at the tool";
    EXPECT_NEAR(snapshot.displayed_N.z(), 0.4 * scale * record.contact_N, 0.03 * scale * record.contact_N);
  }
}

TEST(Handle, TapsSettleAsRecommendedInEitherHandWherePlainRings) {
  for (const char* hand : {"arms/inverse3-arm.toml", "arms/light-grip.toml"}) {
    EXPECT_EQ(share_that_settles(shipped(hand), 3), 1.0) << hand;
    ArmTappingParams plain = shipped(hand);
    plain.control.method = ArmMethod::position_force;
    plain.control.damping_N_s_per_m = 0.0;
    plain.control.force_gain = 2.0;
    EXPECT_EQ(share_that_settles(plain, 3), 0.0) << hand;
  }
}

TEST(Handle, WhatCouplesJointsOrHasNoHandleIsRefusedByItsKey) {
  const auto problem = [](const ArmTappingParams& params) { return set_up_arm_pair(params, folder).error(); };
  ArmTappingParams params = shipped();
  for (const ArmMethod method :
       {ArmMethod::position_position, ArmMethod::factr, ArmMethod::feedback_avoidance, ArmMethod::four_channel}) {
    params.control.method = method;
    EXPECT_EQ(problem(params).parameter, "control.method");
  }
  params = shipped();
  params.control.follower.coupling = Coupling::joints;
  EXPECT_EQ(problem(params).parameter, "arm.follower.urdf");
  EXPECT_NE(problem(params).message.find("control.follower.coupling = \"tool\""), std::string::npos);
  params = shipped();
  params.arm.urdf = params.arm.follower.urdf;
  EXPECT_EQ(problem(params).parameter, "arm.urdf");
  EXPECT_NE(problem(params).message.find("7 joints, of which 0 slide"), std::string::npos) << problem(params).message;
  params = shipped();
  params.arm.follower = {};
  EXPECT_EQ(problem(params).parameter, "arm.follower.urdf");
  params = shipped();
  params.control.follower.tool_scale = 0.0;
  EXPECT_FALSE(validate(params) == std::nullopt);

  const auto document = *configuration::Document::load(folder / "arm-tapping.toml");
  params = document.read<ArmTappingParams>().value();
  params.arm.follower.urdf = params.arm.urdf;
  params.arm.follower.joints.joint_1.start_rad = 0.3;
  EXPECT_EQ(problem(params).parameter, "arm.follower.joints") << "led joint by joint it begins where the leader does";
  EXPECT_EQ(station::refuse_tool_coupling(params, "tactus faults"), std::nullopt);
  EXPECT_EQ(make_arm_fault_bench(shipped(), folder).error().parameter, "control.follower.coupling");
}

}  // namespace tactus::experiments::handle_test
