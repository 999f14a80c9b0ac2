// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/urdf/urdf.hpp>
#include <tactus/kernel/station/supervised_arms.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_taps.hpp>
#include <tactus/simulation/experiments/arm_tapping/presentation.hpp>

#include <cmath>
#include <cstddef>
#include <string>

#include "tests/experiments/arm_tapping/shipped_taps.hpp"
#include <gtest/gtest.h>

namespace tactus::experiments {
namespace {

TEST(RealArms, TheVerdictNamesTheFirstThatFails) {
  const auto verdict = [](const ArmTappingMetrics& m) { return arm_verdict({{.settings = {}, .metrics = m}}); };
  ArmTappingMetrics m{.taps = 20, .settled_fraction = 1.0};
  EXPECT_EQ(verdict(m), "Settled: 20 of 20 taps settled.");
  m.hold = {.force_N = 0.9, .drift_m = 0.0046};
  EXPECT_EQ(verdict(m), "Settled: 20 of 20 taps settled; at rest a tool drifts by 4.6 mm (at most 3.0).");
  m.hold.force_N = 4.4;
  EXPECT_NE(verdict(m).find("the hand bears 4.4 N"), std::string::npos) << verdict(m);
  m.lost_fraction = 0.5;
  m.longest_lost_s = 0.33;
  EXPECT_NE(verdict(m).find("contact is lost for up to 330 ms"), std::string::npos) << verdict(m);
  m.settled_fraction = 0.1;
  m.rings_fraction = 0.9;
  EXPECT_EQ(verdict(m), "Not settled: 2 of 20 taps settled; 18 of 20 taps ring.");
  m.rings_at_gain_0_fraction = 0.4;
  EXPECT_NE(verdict(m).find("8 of 20 taps already ring at gain 0"), std::string::npos) << verdict(m);
  m.never_touched_fraction = 0.9;
  EXPECT_NE(verdict(m).find("18 of 20 taps never touched the surface"), std::string::npos) << verdict(m);
}

TEST(RealArms, ATareHoldsDownWhatModelsWithErrorsDoToAHandAtRest) {
  ArmTappingParams params = shipped_with({});
  params.task.taps = 1;
  params.task.hold_s = 3.0;
  const ArmHold exact = ArmTaps::make(params, shipped_folder)->hold(0);
  EXPECT_LT(exact.force_N, 0.2);
  params.task.errors = {.mass = 0.2, .torque_constant = 0.1, .payload_kg = 0.3};
  params.control.force_gain = 2.83;
  const ArmHold without = ArmTaps::make(params, shipped_folder)->hold(0);
  EXPECT_GT(without.force_N, 1.0);
  params.control.tare.cycles = 1;
  const ArmHold with = ArmTaps::make(params, shipped_folder)->hold(0);
  EXPECT_LT(with.force_N, 0.3 * without.force_N);
  EXPECT_LT(with.drift_m, 0.5 * without.drift_m);
}

TEST(RealArms, WithDampingWashedOutAFreeReachTakesHalfTheEffort) {
  ArmTappingParams params = shipped_with({});
  params.task.taps = 1;
  const double effort_N = ArmTaps::make(params, shipped_folder)->reach().effort_N;
  params.control.damping_washout_Hz = 3.0;
  EXPECT_LT(ArmTaps::make(params, shipped_folder)->reach().effort_N, 0.6 * effort_N);
}

TEST(RealArms, ErrorsAreDrawnForEachTapAndLeaveTheOtherDrawsAsTheyWere) {
  ArmTappingParams params = shipped_with({});
  params.task.taps = 2;
  const ArmTaps exact = *ArmTaps::make(params, shipped_folder);
  params.task.errors = {.mass = 0.1, .centre_m = 0.003, .friction = 0.3, .torque_constant = 0.05, .payload_kg = 0.1};
  const ArmTaps drawn = *ArmTaps::make(params, shipped_folder);
  for (const std::size_t tap : {0U, 1U}) {
    EXPECT_EQ(drawn.tap(tap).wall_m, exact.tap(tap).wall_m);
    EXPECT_EQ(drawn.tap(tap).model_params.hand.mass_kg, exact.tap(tap).model_params.hand.mass_kg);
    const auto& believed = drawn.tap(tap).model_params.follower.joints[1].body;
    const auto& true_body = drawn.setup().follower.arm.chain.joints[1].body;
    EXPECT_NE(believed.mass_kg, true_body.mass_kg);
    EXPECT_NEAR(believed.mass_kg, true_body.mass_kg, 0.1 * true_body.mass_kg);
    EXPECT_NE(drawn.tap(tap).plant_errors.leader_torque_scale, drawn.tap(tap).plant_errors.follower_torque_scale);
  }
  EXPECT_NE(drawn.tap(0).model_params.leader.joints[0].body.mass_kg,
            drawn.tap(1).model_params.leader.joints[0].body.mass_kg);
}

TEST(RealArms, BacklashOfAJointReachesTheSimulatedArmAndNeedsAnElasticJoint) {
  ArmTappingParams params = shipped_with({});
  params.arm.joints.joint_2.play_rad = 0.004;
  EXPECT_EQ(set_up_arm_pair(params, shipped_folder).error().parameter, "arm.joints.joint_2.play_rad");
  params.arm.joint_stiffness_N_m_per_rad = 10000.0;
  const ArmPairSetup setup = *set_up_arm_pair(params, shipped_folder);
  EXPECT_EQ(setup.leader.arm.motors[1].play_rad, 0.004);
  EXPECT_EQ(setup.follower.arm.motors[1].play_rad, 0.004);
  EXPECT_EQ(setup.leader.arm.motors[0].play_rad, 0.0);
  // The link rests on a flank, half of the play from where its motor is, and the spring is bent by little more.
  auto plant = *arm_plants::ArmPlant::make(setup.follower.arm, setup.follower.start);
  const arm::JointVector sag_rad = plant.link_position() - plant.read().position;
  EXPECT_NEAR(std::fabs(sag_rad[1]), 0.002, 0.0008);
  EXPECT_LT(std::fabs(sag_rad[0]), 0.001);
}

TEST(RealArms, ModelsTakeElasticJointsForWhatTheFileAssumesAndPlantsForWhatTheyAre) {
  ArmTappingParams params = shipped_with({});
  params.arm.joint_stiffness_N_m_per_rad = 10000.0;
  const ArmPairSetup known = *set_up_arm_pair(params, shipped_folder);
  params.arm.assumed_joint_stiffness_N_m_per_rad = 3000.0;
  const ArmPairSetup assumed = *set_up_arm_pair(params, shipped_folder);
  const auto shares = params.arm.joints.of(7);
  for (std::size_t i = 0; i < 7; ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const double share = shares[i].stiffness_share;
    EXPECT_EQ(known.exact.induced.joint_stiffness_N_m_per_rad[at], share * 10000.0);
    EXPECT_EQ(assumed.exact.induced.joint_stiffness_N_m_per_rad[at], share * 3000.0);
    EXPECT_EQ(assumed.exact.follower_joint_stiffness_N_m_per_rad[at], share * 3000.0);
    EXPECT_EQ(assumed.leader.arm.motors[i].joint_stiffness_N_m_per_rad, share * 10000.0);
    EXPECT_EQ(assumed.follower.arm.motors[i].joint_stiffness_N_m_per_rad, share * 10000.0);
  }
}

TEST(RealArms, AFurtherDelayOfTheDrivesIsThatOfASlowerBus) {
  // A torque over the bus acts so many cycles later, and nothing else differs.
  const ArmPairSetup setup = *set_up_arm_pair(shipped_with({}), shipped_folder);
  const auto moves_at = [&](std::size_t delay) {
    const std::size_t joints = setup.leader.joints.size();
    arm_plants::ArmPlant::Params floating = setup.leader.arm;
    floating.chain.gravity = {0.0, 0.0, 0.0};
    for (arm::JointParams& joint : floating.chain.joints) joint.friction = {};
    arm_plants::ArmDevice device(*arm_plants::ArmPlant::make(floating, setup.leader.start),
                                 Joints<station::DeviceLimits>(joints), delay);
    Joints<station::DeviceCommand> pushes(joints);
    for (std::size_t i = 0; i < joints; ++i) {
      pushes[i].enabled = true;
      pushes[i].force_N = 1.0;
    }
    for (int cycle = 0; cycle < 20; ++cycle) {
      device.write(pushes);
      for (int i = 0; i < 10; ++i) device.step({});
      if (device.plant().link_position() != setup.leader.start) return cycle;
    }
    return -1;
  };
  EXPECT_EQ(moves_at(0), 1);
  EXPECT_EQ(moves_at(3), 4);
}

TEST(RealArms, ATareIsRefusedForFaultsAndForFourChannelControl) {
  ArmTappingParams params = shipped_with({});
  EXPECT_EQ(station::refuse_tare(params), std::nullopt);
  params.control.tare.cycles = 2;
  EXPECT_EQ(station::refuse_tare(params)->parameter, "control.tare.cycles");
  const ArmPairSetup setup = *set_up_arm_pair(params, shipped_folder);
  const Joints<station::DeviceLimits> limits(setup.leader.joints.size());
  const auto supervised = station::supervise_arms(params, setup, limits, limits, {});
  ASSERT_FALSE(supervised) << "the file has no limits for motors";
  EXPECT_NE(supervised.error().parameter, "control.tare.cycles") << "on a rig an operator asks for a tare";
  params.control.method = arm_control::ArmMethod::four_channel;
  EXPECT_EQ(set_up_arm_pair(params, shipped_folder).error().parameter, "control.tare.cycles");
}

TEST(RealArms, AnArmEndsAtTheLinkThatIsNamedAsItsTip) {
  ArmTappingParams params = shipped_with({});
  const ArmPairSetup whole = *set_up_arm_pair(params, shipped_folder);
  params.arm.tip = "no_such_link";
  EXPECT_EQ(set_up_arm_pair(params, shipped_folder).error().parameter, "arm.urdf");
  EXPECT_NE(set_up_arm_pair(params, shipped_folder).error().message.find("no_such_link"), std::string::npos);
  const urdf::Arm read = *urdf::read(shipped_folder / params.arm.urdf);
  params.arm.tip = read.links[4];
  EXPECT_EQ(set_up_arm_pair(params, shipped_folder)->leader.joints.size(), 5U);
  params.arm.tip = read.links.back();
  EXPECT_EQ(set_up_arm_pair(params, shipped_folder)->leader.joints, whole.leader.joints);
}

TEST(RealArms, AnArmThatCannotBearItsOwnWeightIsRefusedByTheJointsName) {
  const auto urdfs = [](const std::string& name) -> Result<urdf::UrdfText> {
    auto text = *urdf::text_of(shipped_folder / name);
    for (std::size_t at = 0; (at = text.find("effort=\"", at)) != std::string::npos; ++at) {
      text.replace(at, text.find('"', at + 8) - at, "effort=\"0.5");
    }
    return urdf::UrdfText{text, shipped_folder / name};
  };
  const auto setup = set_up_arm_pair(shipped_with({}), urdfs);
  ASSERT_FALSE(setup);
  EXPECT_EQ(setup.error().parameter, "arm.urdf");
  EXPECT_NE(setup.error().message.find("of the arm's own weight"), std::string::npos) << setup.error().message;
  EXPECT_NE(setup.error().message.find("0.5 N m"), std::string::npos) << setup.error().message;
}

}  // namespace
}  // namespace tactus::experiments
