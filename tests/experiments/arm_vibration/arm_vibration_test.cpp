// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/simulation/experiments/arm_vibration/coupled_arms.hpp>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::experiments {
namespace arm_vibration_test {

const std::filesystem::path folder = TACTUS_EXPERIMENT_FOLDER;

ArmVibrationParams shipped() {
  return configuration::Document::load(folder / "arm-vibration.toml")->read<ArmVibrationParams>().value();
}

CoupledArmsResult run(const ArmVibrationParams& params) {
  return *run_coupled_arms(*set_up_coupled_arms(params, folder));
}

TEST(ArmVibration, ASineIsToldByItsFrequencySpeedAndAmplitudeWhateverDriftsBesideIt) {
  std::vector<double> position, velocity;
  for (int k = 0; k < 1000; ++k) {
    const double t = 1e-3 * k, w = 2.0 * std::numbers::pi * 27.3;
    position.push_back(0.3 + 0.05 * t + 4e-3 * std::sin(w * t));
    velocity.push_back(0.05 + 4e-3 * w * std::cos(w * t));
  }
  const Shaking shaking = shaking_of(position, velocity, 1000.0);
  EXPECT_NEAR(shaking.frequency_Hz, 27.25, 0.25);
  const double off = 1.3 / 27.3;  // as the moving mean lets it be
  EXPECT_NEAR(shaking.amplitude_rad, 4e-3, off * 4e-3);
  const double rms = 4e-3 * 2.0 * std::numbers::pi * 27.3 / std::numbers::sqrt2;
  EXPECT_NEAR(shaking.rms_rad_per_s, rms, off * rms);
  EXPECT_EQ(shaking_rms_of(velocity, 1000.0), shaking.rms_rad_per_s);
  const Shaking rest = shaking_of(std::vector(500, 0.2), std::vector(500, 0.0), 1000.0);
  EXPECT_EQ(rest.rms_rad_per_s, 0.0);
  EXPECT_EQ(rest.frequency_Hz, 0.0);
}

TEST(ArmVibration, TheReleasedLawIsThatOfItsSource) {
  const auto setup = set_up_coupled_arms(shipped(), folder);
  ASSERT_TRUE(setup) << describe(setup.error());
  const auto law = ReleasedLaw::make(setup->params.control, setup->believed);
  arm::ArmReading own{
      .position = setup->start, .velocity = arm::JointVector::Constant(7, 0.2), .torque = arm::JointVector::Zero(7)};
  const arm::JointVector other = setup->start * 0.9, speed = arm::JointVector::Constant(7, -0.3);
  const arm::ArmCommand told = law->command(own, other, speed);
  const double gravity = arm::Chain::make(setup->believed)->gravity_torque(own.position)[1];
  EXPECT_NEAR(told.torque[1], gravity + 0.306 * std::tanh(0.1 * 28.4 * 0.2) + 0.063 * 0.2 + 0.088, 1e-12);
  EXPECT_EQ(told.stiffness[1], 240.0);
  EXPECT_EQ(told.damping[1], 3.0);
  EXPECT_EQ(told.position, other);
  EXPECT_EQ(told.velocity, speed);
}

TEST(ArmVibration, ThePairAsReleasedDoesNotVibrateAtEitherRateHeldOrNot) {
  for (const double rate_Hz : {1000.0, 500.0}) {
    for (const HeldBy held_by : {HeldBy::hand, HeldBy::nobody}) {
      ArmVibrationParams params = shipped();
      params.host.rate_Hz = rate_Hz;
      params.task.held_by = held_by;
      const CoupledArmsResult found = run(params);
      EXPECT_FALSE(found.vibrates()) << rate_Hz;
      // The leader's reading is taken over after 2 ticks, exchanged after 2.7, and acts on the follower from 3.4
      // to 4.4; the follower's, of 0.4, is taken over at 2.4, exchanged at 2.7, and acts on the leader from 3 to 4.
      EXPECT_NEAR(found.delay_s * rate_Hz, 0.5 * ((3.4 + 4.4) + (3.0 + 4.0 - 2.0 * 0.4)) / 2.0, 0.1);
      EXPECT_GT(theory_of(*set_up_coupled_arms(params, folder))->arms->delay_s, 1.5 * found.delay_s);
    }
  }
}

TEST(ArmVibration, AWrongVelocityScaleShakesItsJointWhateverItsStiffnessAndTheMoreTheLargerItsDamping) {
  ArmVibrationParams params = shipped();
  params.cause.velocity_scale = 3.0;
  const CoupledArmsResult found = run(params);
  EXPECT_TRUE(found.moving.vibrates());
  EXPECT_EQ(found.moving.worst_joint, 1U);
  ReleasedJoint& shoulder = params.control.joints.joint_2;
  const ReleasedJoint as_released = shoulder;
  shoulder.stiffness_N_m_per_rad = 60.0;
  EXPECT_TRUE(run(params).moving.vibrates()) << "less stiffness does not help";
  shoulder = as_released;
  shoulder.damping_N_m_s_per_rad = 5.0;
  EXPECT_GT(run(params).moving.joint.rms_rad_per_s, found.moving.joint.rms_rad_per_s) << "more damping harms";
  shoulder.damping_N_m_s_per_rad = 1.0;
  EXPECT_FALSE(run(params).vibrates()) << "less helps";
}

TEST(ArmVibration, ASmallerShareOfTheOthersVelocityCuresAWrongScale) {
  for (const double scale : {3.0, 4.5}) {
    ArmVibrationParams params = shipped();
    params.cause.velocity_scale = scale;
    EXPECT_TRUE(run(params).vibrates()) << scale;
    const double most = 2.0 / (scale + 1.0 / scale);  // of two alike joints
    params.control.velocity_share = 0.9 * most;
    EXPECT_FALSE(run(params).vibrates()) << scale;
  }
}

TEST(ArmVibration, AWrongScaleShakesABentArmAndNotAStretchedOne) {
  ArmVibrationParams params = shipped();
  params.cause.velocity_scale = 2.5;
  params.arm.joints.joint_4.start_rad = 2.0;
  EXPECT_TRUE(run(params).vibrates());
  params.arm.joints.joint_4.start_rad = 0.5;
  EXPECT_FALSE(run(params).vibrates());
}

TEST(ArmVibration, AHostThatReadsAVelocityTooLargeDoesNotMakeAnArmShakeMore) {
  ArmVibrationParams params = shipped();
  params.control.velocity_share = params.control.friction_share = 0.0;  // so the host makes no use of it
  const double right = run(params).moving.joint.rms_rad_per_s;
  params.cause.velocity_scale = 3.0;
  EXPECT_GT(right, 1e-4);
  EXPECT_NEAR(run(params).moving.joint.rms_rad_per_s, right, 1e-9);
}

TEST(ArmVibration, OldReadingsShakeTheWristAndNotTheShoulder) {
  ArmVibrationParams params = shipped();
  params.host.answer_ticks = 30;
  const CoupledArmsResult found = run(params);
  EXPECT_TRUE(found.vibrates());
  EXPECT_GE(found.moving.worst_joint, 4U);
  EXPECT_FALSE(found.moving.joint.rms_rad_per_s > 0.2) << "the shoulder is carried along";
  const auto theory = theory_of(*set_up_coupled_arms(params, folder));
  EXPECT_GE(theory->arms->joint, 4);
  EXPECT_LT(theory->arms->delay_s, found.delay_s);
}

TEST(ArmVibration, PlayAndLostFramesOfTheShoulderDoNotShakeIt) {
  ArmVibrationParams params = shipped();
  params.cause.play_rad = 0.01;
  EXPECT_FALSE(run(params).vibrates());
  params.host.rate_Hz = 500.0;
  params.cause.lost_share = 0.9;
  EXPECT_FALSE(run(params).vibrates());
}

TEST(ArmVibration, IsTheSameEveryTimeAndRefusesAJointThatIsNotThere) {
  ArmVibrationParams params = shipped();
  params.cause.lost_share = 0.5;
  params.host.late_s = 0.002;
  const CoupledArmsResult once = run(params), again = run(params);
  EXPECT_EQ(once.moving.worst.rms_rad_per_s, again.moving.worst.rms_rad_per_s);
  EXPECT_EQ(once.records.back().leader_N_m, again.records.back().leader_N_m);
  params.task.joint = 8;
  EXPECT_EQ(set_up_coupled_arms(params, folder).error().parameter, "task.joint");
}

}  // namespace arm_vibration_test
}  // namespace tactus::experiments
