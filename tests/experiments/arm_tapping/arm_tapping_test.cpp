// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_taps.hpp>
#include <tactus/simulation/experiments/arm_tapping/contact_figure.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "tests/experiments/arm_tapping/shipped_taps.hpp"
#include <gtest/gtest.h>

namespace tactus::experiments {
namespace arm_tapping_test {

using arm_control::ArmMethod;
using arm_control::TorqueSource;

const std::filesystem::path& folder = shipped_folder;

ArmTappingParams shipped() { return shipped_with({}); }

/// Without what is recommended beside it.
ArmTappingParams bare(ArmMethod method) {
  ArmTappingParams params = shipped_with({"arms/bare.toml"});
  params.control.method = method;
  return params;
}

/// A push of 10 N that rings at 40 Hz, by so much of it, from 0.3 s on.
std::vector<ArmRecord> push(double ringing) {
  std::vector<ArmRecord> records;
  for (int k = 0; k < 900; ++k) {
    const double t = 1e-3 * k;
    const double rise = std::clamp((t - 0.1) / 0.2, 0.0, 1.0);
    const double swing = t > 0.3 ? ringing * std::sin(2.0 * std::numbers::pi * 40.0 * t) : 0.0;
    const double force_N = 10.0 * (rise * rise * (3.0 - 2.0 * rise) + swing);
    records.push_back({.contact_N = force_N, .hand_N = 0.3 * force_N});
  }
  return records;
}

TEST(ArmTapping, AContactRingsWhereASineOfMoreThanATenthOfItsPeakStays) {
  EXPECT_FALSE(judge_arm_contact(push(0.0), 100, 1e-3).rings);
  EXPECT_FALSE(judge_arm_contact(push(0.095), 100, 1e-3).rings);
  const ArmContact ringing = judge_arm_contact(push(0.13), 100, 1e-3);
  EXPECT_TRUE(ringing.rings);
  EXPECT_NEAR(ringing.peak_N, 11.3, 0.05);
  EXPECT_NEAR(ringing.steady_N, 10.0, 0.02);
  EXPECT_NEAR(ringing.residual_N, 1.3 / std::numbers::sqrt2, 0.02);
  EXPECT_NEAR(ringing.felt_share, 0.3, 1e-9);
}

TEST(ArmTapping, AContactIsLostForAsLongAsNothingTouchesAfter150Milliseconds) {
  std::vector<ArmRecord> records = push(0.0);
  const auto leave = [&records](int from, int to) {
    for (int k = from; k < to; ++k) records[static_cast<std::size_t>(k)].contact_N = 0.0;
  };
  leave(150, 240);  // before
  EXPECT_EQ(judge_arm_contact(records, 100, 1e-3).lost_s, 0.0);
  leave(400, 430);
  leave(500, 570);
  EXPECT_NEAR(judge_arm_contact(records, 100, 1e-3).lost_s, 0.070, 1e-9);
}

TEST(ArmTapping, TapsSettleAtASmallGainAndNotAtALargeOne) {
  ArmTappingParams params = bare(ArmMethod::position_force);
  params.control.force_gain = 0.5;
  EXPECT_EQ(share_that_settles(params, 3), 1.0);
  params.control.force_gain = 8.0;
  EXPECT_EQ(share_that_settles(params, 3), 0.0);
}

TEST(ArmTapping, WithExactTorqueAndAFirmHandCancellationSettlesWherePlainRings) {
  ArmTappingParams params = bare(ArmMethod::position_force);
  params.task.model_error = 0.0;
  params.control.follower.torque = TorqueSource::sensor;
  params.control.force_gain = 4.0;
  EXPECT_EQ(share_that_settles(params, 4), 0.0);
  params.control.method = ArmMethod::cancellation;
  EXPECT_EQ(share_that_settles(params, 4), 1.0);
}

TEST(ArmTapping, AsShippedTapsSettleAtAGainAtWhichTheyRingWithoutItsDampingAndSoftness) {
  ArmTappingParams params = shipped();
  params.control.force_gain = 5.66;
  EXPECT_EQ(share_that_settles(params, 3), 1.0);
  params = bare(ArmMethod::position_force);
  params.control.force_gain = 5.66;
  EXPECT_EQ(share_that_settles(params, 3), 0.0);
}

TEST(ArmTapping, OnASurfaceOfHuntAndCrossleyAsShippedTapsSettleAndItIsTheStifferTheHarder) {
  ArmTappingParams params = shipped();
  params.control.force_gain = 5.66;
  params.wall.law = SurfaceLaw::hunt_crossley;
  EXPECT_EQ(share_that_settles(params, 2), 1.0);
  // As deep as the follower's tool goes is as the closed form of its force says.
  params.task.taps = 1;
  const ArmTaps taps = *ArmTaps::make(params, folder);
  ArmTrace trace;
  taps.run(0, &trace);
  const double depth_m = taps.tap(0).wall_m - trace.records.back().follower_m;
  const double force_N = trace.records.back().contact_N;
  ASSERT_GT(depth_m, 0.0);
  EXPECT_NEAR(20000.0 * depth_m * std::sqrt(depth_m / 1e-4), force_N, 0.05 * force_N);
}

TEST(ArmTapping, AlongTheArmTapsSettleBecauseOfTheLimitsAtTheTool) {
  ArmTappingParams params = shipped();
  params.control.force_gain = 5.66;
  params.task.direction = TapDirection::along_x;
  EXPECT_EQ(share_that_settles(params, 3), 1.0);
  params.control.follower.tool_stiffness_limit_N_per_m = 0.0;
  params.control.follower.tool_damping_limit_N_s_per_m = 0.0;
  EXPECT_EQ(share_that_settles(params, 3), 0.0);
}

TEST(ArmTapping, AlongTheArmTheFollowerLagsNoMoreThanPlainAllowsBecauseOfTheWantedMotion) {
  const auto lag_m = [](ArmTappingParams params) {
    params.task.direction = TapDirection::along_x;
    return ArmTaps::make(params, folder)->reach().lag_m;
  };
  const double plain_m = lag_m(bare(ArmMethod::position_force));
  for (ArmTappingParams params : {shipped(), shipped_with({"arms/elastic-joints.toml"})}) {
    EXPECT_LT(lag_m(params), plain_m + 0.007);
    params.control.follower.wanted_motion.cutoff_Hz = 0.0;
    EXPECT_GT(lag_m(params), plain_m + 0.010);
  }
}

TEST(ArmTapping, ASoftHandReachesASurfaceAlongTheArmBecauseOfTheDeadBand) {
  ArmTappingParams params = shipped();
  params.control.force_gain = 5.66;
  params.task.direction = TapDirection::along_x;
  params.person.hand = {.mass_kg = 0.1, .stiffness_N_per_m = 60.0, .damping_N_s_per_m = 10.0, .lever_m = 0.05};
  EXPECT_EQ(share_that_settles(params, 3), 1.0);
  params.control.follower.observer.dead_band_share = 0.0;
  EXPECT_EQ(share_that_settles(params, 3), 0.0);
}

TEST(ArmTapping, OnElasticJointsTapsSettleWithAnObserverThatCountsWithThem) {
  auto document = *configuration::Document::load(folder / "arm-tapping.toml");
  ASSERT_EQ(document.merge(*configuration::Document::load(folder / "arms/elastic-joints.toml")), std::nullopt);
  ArmTappingParams params = document.read<ArmTappingParams>().value();
  params.control.force_gain = 4.0;
  EXPECT_EQ(share_that_settles(params, 3), 1.0);
  params.control.method = arm_control::ArmMethod::position_force;
  EXPECT_EQ(share_that_settles(params, 3), 1.0);
  params.control.follower.observer.joints = arm_control::JointModel::rigid;
  EXPECT_LT(share_that_settles(params, 3), 0.5);
}

TEST(ArmTapping, OnElasticJointsCancellationSettlesAcrossWherePositionForceRings) {
  auto document = *configuration::Document::load(folder / "arm-tapping.toml");
  ASSERT_EQ(document.merge(*configuration::Document::load(folder / "arms/elastic-joints.toml")), std::nullopt);
  ArmTappingParams params = document.read<ArmTappingParams>().value();
  params.control.force_gain = 2.83;
  params.task.pose = 3;
  params.task.direction = TapDirection::along_y;
  EXPECT_EQ(share_that_settles(params, 4), 1.0);
  params.control.method = arm_control::ArmMethod::position_force;
  EXPECT_LT(share_that_settles(params, 4), 0.5);
}

TEST(ArmTapping, SixJointsOfTheYamClassSettleAsRecommendedAndNotWithoutIt) {
  auto document = *configuration::Document::load(folder / "arm-tapping.toml");
  ASSERT_EQ(document.merge(*configuration::Document::load(folder / "arms/yam-pair.toml")), std::nullopt);
  ArmTappingParams params = document.read<ArmTappingParams>().value();
  params.control.force_gain = 5.66;
  EXPECT_EQ(set_up_arm_pair(params, folder)->leader.start.size(), 6);
  EXPECT_EQ(share_that_settles(params, 3), 1.0);
  ASSERT_EQ(document.merge(*configuration::Document::load(folder / "arms/bare.toml")), std::nullopt);
  params = document.read<ArmTappingParams>().value();
  params.control.force_gain = 5.66;
  EXPECT_EQ(share_that_settles(params, 3), 0.0);
}

/// The shipped pair with the follower written out as another arm, which is the same.
ArmTappingParams with_equal_follower() {
  ArmTappingParams params = shipped();
  ArmParams& follower = params.arm.follower;
  follower.urdf = params.arm.urdf;
  follower.tool = params.arm.tool;
  follower.joints = {
      params.arm.joints.joint_1, params.arm.joints.joint_2, params.arm.joints.joint_3, params.arm.joints.joint_4,
      params.arm.joints.joint_5, params.arm.joints.joint_6, params.arm.joints.joint_7, {}};
  return params;
}

/// The geared pair as recommended, or with a file on top.
ArmTappingParams geared(const char* on_top = nullptr) {
  return on_top == nullptr ? shipped_with({"arms/geared-pair.toml"}) : shipped_with({"arms/geared-pair.toml", on_top});
}

TEST(ArmTapping, WhatIsFalseInFreeMotionIsTheObserversAndWhatDriftsIsCancellations) {
  const auto reach = [](const ArmTappingParams& params) { return ArmTaps::make(params, folder)->reach(); };
  ArmTappingParams plain = bare(ArmMethod::position_force);
  const ArmReach observed = reach(plain);
  EXPECT_GT(observed.false_force_N, 0.5) << "friction that the observer takes for a push";
  EXPECT_EQ(observed.drift_m, 0.0);
  plain.control.follower.torque = arm_control::TorqueSource::sensor;
  const ArmReach sensed = reach(plain);
  EXPECT_LT(sensed.false_force_N, 1e-9) << "nothing is there";
  EXPECT_LT(sensed.effort_N, observed.effort_N);
  EXPECT_GT(reach(bare(ArmMethod::cancellation)).drift_m, 1e-4) << "a false force moves what is modelled, too";
  ArmTappingParams sure = bare(ArmMethod::cancellation);
  sure.control.follower.torque = arm_control::TorqueSource::sensor;
  EXPECT_LT(reach(sure).drift_m, 1e-9);
}

TEST(ArmTapping, AFollowerThatIsWrittenOutIsTreatedAsOneThatIsLikeTheLeader) {
  const ArmPairSetup setup = *set_up_arm_pair(with_equal_follower(), folder);
  EXPECT_NEAR(setup.tool_scale, 1.0, 1e-3);
  ArmTrace alike, written;
  ArmTaps::make(shipped(), folder)->run(0, &alike);
  const ArmTaps taps = *ArmTaps::make(with_equal_follower(), folder);
  taps.run(0, &written);
  ASSERT_EQ(alike.records.size(), written.records.size());
  for (std::size_t k = 0; k < alike.records.size(); ++k) {
    ASSERT_NEAR(alike.records[k].follower_m, written.records[k].follower_m, 1e-4) << k;
  }
  EXPECT_NEAR(taps.reach().lag_m, ArmTaps::make(shipped(), folder)->reach().lag_m, 1e-4);
}

TEST(ArmTapping, ALeaderOfHalfTheSizeMovesTheFollowersToolTwiceAsFar) {
  ArmTappingParams params = geared();
  params.control.force_gain = 0.0;
  for (const std::int64_t pose : {0, 3}) {
    params.task.pose = pose;
    const ArmPairSetup setup = *set_up_arm_pair(params, folder);
    EXPECT_NEAR(setup.tool_scale, 2.0, 0.01);
    EXPECT_EQ(setup.leader.start, setup.follower.start);
    ArmPair pair = *ArmPair::make(setup, setup.exact, -1.0);
    ArmRecord record;
    for (int k = 0; k < 1000; ++k) {
      const double share = std::min(1.0, k / 500.0);
      record = pair.step(-0.05 * share * setup.outward, -0.05 * share * setup.outward);
    }
    EXPECT_NEAR(record.leader_m, -0.025, 0.002);
    EXPECT_NEAR(record.follower_m, -0.05, 0.004);
    EXPECT_LT(record.tools_apart_m, 0.002) << "at rest the follower is where the leader's joints have it";
  }
}

TEST(ArmTapping, TheGearedPairSettlesAsRecommendedInEitherHandAndPlainHardly) {
  for (const char* hand : {"arms/geared-pair.toml", "arms/light-grip.toml"}) {
    EXPECT_EQ(share_that_settles(geared(hand), 3), 1.0) << hand;
  }
  ArmTappingParams plain = geared("arms/bare.toml");
  EXPECT_EQ(share_that_settles(plain, 3), 0.0);
}

TEST(ArmTapping, AFollowerThatCannotBeCommandedJointByJointIsRefused) {
  const auto problem = [](const ArmTappingParams& params) { return set_up_arm_pair(params, folder).error(); };
  ArmTappingParams params = shipped();
  params.arm.follower.urdf = "arms/yam-class.urdf";
  EXPECT_EQ(problem(params).parameter, "arm.follower.urdf");
  EXPECT_NE(problem(params).message.find("the leader has 7 (joint_1"), std::string::npos) << problem(params).message;
  EXPECT_NE(problem(params).message.find("and the follower 6 ("), std::string::npos) << problem(params).message;
  params.arm.follower.urdf = "arms/no-such.urdf";
  EXPECT_EQ(problem(params).parameter, "arm.follower.urdf");
  params = shipped();
  params.arm.follower.joint_stiffness_N_m_per_rad = 3000.0;
  EXPECT_EQ(problem(params).parameter, "arm.follower.urdf");
  EXPECT_NE(problem(params).message.find("yet it has keys"), std::string::npos);
  params = shipped();  // whose tool this pose moves elsewhere
  params.arm.follower.urdf = "arms/franka-class-follower.urdf";
  EXPECT_NE(problem(params).message.find("outside its range"), std::string::npos) << problem(params).message;
  params.arm.joints.joint_2.start_rad = -1.7;  // within their range
  params.arm.joints.joint_4.start_rad = -1.0;
  EXPECT_EQ(problem(params).code, ErrorCode::inconsistent);
  EXPECT_NE(problem(params).message.find("degrees from there"), std::string::npos) << problem(params).message;
}

TEST(ArmTapping, APoseIsTheSameForTheSameNumberAndAnotherForAnother) {
  ArmTappingParams params = shipped();
  const auto start = [&](std::int64_t pose) {
    params.task.pose = pose;
    return set_up_arm_pair(params, folder)->leader.start;
  };
  const arm::JointVector shipped_start = start(0);
  EXPECT_EQ(shipped_start[3], 1.4);
  EXPECT_EQ(start(3), start(3));
  EXPECT_GT((start(3) - start(4)).cwiseAbs().maxCoeff(), 0.1);
  EXPECT_LE((start(3) - shipped_start).cwiseAbs().maxCoeff(), 0.6);
}

TEST(ArmTapping, ASurfaceStandsInTheDirectionOfTheTap) {
  ArmTappingParams params = shipped();
  params.control.force_gain = 0.0;
  for (const TapDirection direction : {TapDirection::down, TapDirection::along_x, TapDirection::along_y}) {
    params.task.direction = direction;
    const ArmPairSetup setup = *set_up_arm_pair(params, folder);
    ArmTrace trace;
    const ArmTapResult tap = ArmTaps::make(params, folder)->run(0, &trace);
    EXPECT_TRUE(tap.contact.touched);
    EXPECT_GT(tap.contact.peak_N, 1.0);
    EXPECT_LT(trace.records.back().leader_m, -0.005) << "inward";
    EXPECT_EQ(setup.outward.norm(), 1.0);
  }
}

TEST(ArmTapping, APictureShowsBothArmsOnTheSurface) {
  for (const TapDirection direction : {TapDirection::down, TapDirection::along_x}) {
    ArmTappingParams params = shipped();
    params.task.direction = direction;
    const ArmTaps taps = *ArmTaps::make(params, folder);
    ArmTrace trace;
    taps.run(0, &trace);
    ASSERT_TRUE(trace.pressing);
    const report::Figure figure = contact_figure(taps.setup(), *trace.pressing, "");
    ASSERT_EQ(figure.panels.size(), 2U);
    const report::Line& links = figure.panels[1].lines[1];
    const report::Line& contact = figure.panels[1].lines[2];
    ASSERT_EQ(links.x.size(), 9U) << "base, seven joints and tool";
    EXPECT_EQ(contact.x[0], links.x[8]);
    EXPECT_EQ(contact.y[0], links.y[8]);
    const bool down = direction == TapDirection::down;
    EXPECT_GT(down ? contact.y[1] - contact.y[0] : contact.x[1] - contact.x[0], 50.0) << "out of the surface";
    EXPECT_NEAR(down ? contact.x[1] - contact.x[0] : contact.y[1] - contact.y[0], 0.0, 1e-9);
    // A link is as long in space as in its picture, or longer.
    const arm::Vector3 tool = trace.pressing->snapshot.follower_m;
    EXPECT_LE(std::hypot(links.x[8], links.y[8]), 1e3 * tool.norm() + 1e-9);
    EXPECT_NEAR(links.y[8], 1e3 * tool.z(), 1e-9);
    const report::Line& induced = figure.panels[0].lines[2];
    EXPECT_TRUE(induced.name.starts_with("induced motion × 10")) << induced.name;
    const double drawn = std::hypot(induced.x[1] - induced.x[0], induced.y[1] - induced.y[0]);
    EXPECT_GT(drawn, 1.0) << "can be seen";
    EXPECT_LE(drawn, 300.0);
  }
}

TEST(ArmTapping, EqualParametersGiveEqualBits) {
  ArmTappingParams params = shipped();
  params.task.taps = 2;
  ArmTrace once, again;
  ArmTaps::make(params, folder)->run(1, &once);
  ArmTaps::make(params, folder)->run(1, &again);
  ASSERT_EQ(once.records.size(), again.records.size());
  for (std::size_t k = 0; k < once.records.size(); ++k) {
    ASSERT_EQ(once.records[k].contact_N, again.records[k].contact_N) << k;
    ASSERT_EQ(once.records[k].leader_m, again.records[k].leader_m) << k;
  }
}

TEST(ArmTapping, WithoutAPersonsMotionNothingMoves) {
  const ArmPairSetup setup = *set_up_arm_pair(shipped(), folder);
  ArmPair pair = *ArmPair::make(setup, setup.exact, -0.01);
  ArmRecord record;
  for (int k = 0; k < 1000; ++k) record = pair.step(arm::Vector3::Zero(), arm::Vector3::Zero());
  EXPECT_LT(std::fabs(record.leader_m), 5e-4);
  EXPECT_LT(std::fabs(record.follower_m), 5e-4);
  EXPECT_EQ(record.contact_N, 0.0);
}

TEST(ArmTapping, WhatIsWrongIsNamed) {
  ArmTappingParams params = shipped();
  params.arm.urdf = "arms/no-such.urdf";
  EXPECT_EQ(ArmTaps::make(params, folder).error().parameter, "arm.urdf");
  params.arm.urdf.clear();
  EXPECT_EQ(ArmTaps::make(params, folder).error().code, ErrorCode::missing);
  params = shipped();
  params.task.deepest_m = 0.001;
  EXPECT_EQ(ArmTaps::make(params, folder).error().parameter, "task.deepest_m");
  params = shipped();
  params.control.command_low_pass_Hz = 300.0;
  params.servo.rate_Hz = 500.0;
  EXPECT_EQ(ArmTaps::make(params, folder).error().parameter, "control.command_low_pass_Hz");
}

}  // namespace arm_tapping_test
}  // namespace tactus::experiments
