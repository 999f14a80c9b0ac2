#include <tactus/configuration/document.hpp>
#include <tactus/experiments/arm_tapping/arm_taps.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::experiments {
namespace arm_tapping_test {

using arm_control::ArmMethod;
using arm_control::TorqueSource;

const std::filesystem::path folder = TACTUS_EXPERIMENT_FOLDER;

ArmTappingParams shipped() {
  const auto document = configuration::Document::load(folder / "arm-tapping.toml");
  return document->read<ArmTappingParams>().value();
}

/// Without what is recommended beside it.
ArmTappingParams bare(ArmMethod method) {
  auto document = *configuration::Document::load(folder / "arm-tapping.toml");
  EXPECT_EQ(document.merge(*configuration::Document::load(folder / "arms/bare.toml")), std::nullopt);
  ArmTappingParams params = document.read<ArmTappingParams>().value();
  params.control.method = method;
  return params;
}

double settled_share(ArmTappingParams params, std::int64_t taps) {
  params.task.taps = taps;
  const ArmTaps made = *ArmTaps::make(params, folder);
  std::size_t settled = 0;
  for (std::size_t tap = 0; tap < made.size(); ++tap) settled += made.run(tap).settled() ? 1U : 0U;
  return static_cast<double>(settled) / static_cast<double>(taps);
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

TEST(ArmTapping, TapsSettleAtASmallGainAndNotAtALargeOne) {
  ArmTappingParams params = bare(ArmMethod::position_force);
  params.control.force_gain = 0.5;
  EXPECT_EQ(settled_share(params, 3), 1.0);
  params.control.force_gain = 8.0;
  EXPECT_EQ(settled_share(params, 3), 0.0);
}

TEST(ArmTapping, WithExactTorqueAndAFirmHandCancellationSettlesWherePlainRings) {
  ArmTappingParams params = bare(ArmMethod::position_force);
  params.task.model_error = 0.0;
  params.control.follower.torque = TorqueSource::sensor;
  params.control.force_gain = 4.0;
  EXPECT_EQ(settled_share(params, 4), 0.0);
  params.control.method = ArmMethod::cancellation;
  EXPECT_EQ(settled_share(params, 4), 1.0);
}

TEST(ArmTapping, AsShippedTapsSettleAtAGainAtWhichTheyRingWithoutItsDampingAndSoftness) {
  ArmTappingParams params = shipped();
  params.control.force_gain = 5.66;
  EXPECT_EQ(settled_share(params, 3), 1.0);
  params = bare(ArmMethod::position_force);
  params.control.force_gain = 5.66;
  EXPECT_EQ(settled_share(params, 3), 0.0);
}

TEST(ArmTapping, AlongTheArmTapsSettleBecauseOfTheLimitsAtTheTool) {
  ArmTappingParams params = shipped();
  params.control.force_gain = 5.66;
  params.task.direction = TapDirection::along_x;
  EXPECT_EQ(settled_share(params, 3), 1.0);
  params.control.follower.tool_stiffness_limit_N_per_m = 0.0;
  params.control.follower.tool_damping_limit_N_s_per_m = 0.0;
  EXPECT_EQ(settled_share(params, 3), 0.0);
}

TEST(ArmTapping, ASoftHandReachesASurfaceAlongTheArmBecauseOfTheDeadBand) {
  ArmTappingParams params = shipped();
  params.control.force_gain = 5.66;
  params.task.direction = TapDirection::along_x;
  params.person.hand = {.mass_kg = 0.1, .stiffness_N_per_m = 60.0, .damping_N_s_per_m = 10.0, .lever_m = 0.05};
  EXPECT_EQ(settled_share(params, 3), 1.0);
  params.control.follower.observer.dead_band_share = 0.0;
  EXPECT_EQ(settled_share(params, 3), 0.0);
}

TEST(ArmTapping, OnElasticJointsTapsSettleWithAnObserverThatCountsWithThem) {
  auto document = *configuration::Document::load(folder / "arm-tapping.toml");
  ASSERT_EQ(document.merge(*configuration::Document::load(folder / "arms/elastic-joints.toml")), std::nullopt);
  ArmTappingParams params = document.read<ArmTappingParams>().value();
  params.control.force_gain = 4.0;
  EXPECT_EQ(settled_share(params, 3), 1.0);
  params.control.follower.observer.joints = arm_control::JointModel::rigid;
  EXPECT_LT(settled_share(params, 3), 0.5);
}

TEST(ArmTapping, SixJointsOfTheYamClassSettleAsRecommendedAndNotWithoutIt) {
  auto document = *configuration::Document::load(folder / "arm-tapping.toml");
  ASSERT_EQ(document.merge(*configuration::Document::load(folder / "arms/yam-pair.toml")), std::nullopt);
  ArmTappingParams params = document.read<ArmTappingParams>().value();
  params.control.force_gain = 5.66;
  EXPECT_EQ(set_up_arm_pair(params, folder)->start.size(), 6);
  EXPECT_EQ(settled_share(params, 3), 1.0);
  ASSERT_EQ(document.merge(*configuration::Document::load(folder / "arms/bare.toml")), std::nullopt);
  params = document.read<ArmTappingParams>().value();
  params.control.force_gain = 5.66;
  EXPECT_EQ(settled_share(params, 3), 0.0);
}

TEST(ArmTapping, APoseIsTheSameForTheSameNumberAndAnotherForAnother) {
  ArmTappingParams params = shipped();
  const auto start = [&](std::int64_t pose) {
    params.task.pose = pose;
    return set_up_arm_pair(params, folder)->start;
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
    std::vector<ArmRecord> trace;
    const ArmTapResult tap = ArmTaps::make(params, folder)->run(0, &trace);
    EXPECT_TRUE(tap.contact.touched);
    EXPECT_GT(tap.contact.peak_N, 1.0);
    EXPECT_LT(trace.back().leader_m, -0.005) << "inward";
    EXPECT_EQ(setup.outward.norm(), 1.0);
  }
}

TEST(ArmTapping, EqualParametersGiveEqualBits) {
  ArmTappingParams params = shipped();
  params.task.taps = 2;
  std::vector<ArmRecord> once, again;
  ArmTaps::make(params, folder)->run(1, &once);
  ArmTaps::make(params, folder)->run(1, &again);
  ASSERT_EQ(once.size(), again.size());
  for (std::size_t k = 0; k < once.size(); ++k) {
    ASSERT_EQ(once[k].contact_N, again[k].contact_N) << k;
    ASSERT_EQ(once[k].leader_m, again[k].leader_m) << k;
  }
}

TEST(ArmTapping, WithoutAPersonsMotionNothingMoves) {
  const ArmPairSetup setup = *set_up_arm_pair(shipped(), folder);
  ArmPair pair = *ArmPair::make(setup, setup.induced, setup.params.control.model.hand, -0.01);
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
