// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/hydraulic_chirp/hydraulic_chirp.hpp>
#include <tactus/simulation/experiments/hydraulic_rigid_contact/hydraulic_rigid_contact.hpp>

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace tactus::experiments {
namespace hydraulic_test {

TEST(HydraulicRig, TheFittedDampingIsThatOfTheOrificesAndTheOverlap) {
  simulation::HydraulicRigParams params;
  params.slave.cylinder.friction = {.coulomb_N = 0.0, .static_N = 0.0, .viscous_N_s_per_m = 0.0};
  const auto rig = simulation::IdentifiedRig::make(params, 0.05).value();
  const auto& friction = rig.fitted().model.friction;
  const double gain = params.model.actuator_gain_N_per_mA;
  // Without load: v = k √(Δp/2) opening / A, so the current grows by so much with velocity.
  const double speed_per_mA = 3.17e-4 / std::sqrt(3.5e6) * std::sqrt(0.5 * (21e6 - 1e5)) / 15.0 / 9.42e-4;
  EXPECT_NEAR(friction.linear * friction.force_N / 1e-3 / gain, 1.0 / speed_per_mA, 0.03 / speed_per_mA);
  // And the valve has to cross its overlap of 2 % of 15 mA whenever the motion turns.
  EXPECT_NEAR(0.5 * friction.force_N / gain, 0.3, 0.03);
}

TEST(HydraulicRig, TheApparentMassIsTheLagOfValveAndSensors) {
  simulation::HydraulicRigParams params;
  const double lighter = simulation::IdentifiedRig::make(params, 0.05).value().fitted().apparent_mass_kg;
  params.slave.valve.natural_frequency_Hz = 50.0;
  const double heavier = simulation::IdentifiedRig::make(params, 0.05).value().fitted().apparent_mass_kg;
  // The spool's lag is 2ζ/ω: 2.5 ms more, and a velocity per current of 0.0386 m/(s mA).
  const double expected =
      1320.0 * (2.0 * 0.8 / (2.0 * std::numbers::pi * 50.0) - 2.0 * 0.8 / (2.0 * std::numbers::pi * 100.0)) / 0.0386;
  EXPECT_NEAR(heavier - lighter, expected, 0.15 * expected);
}

TEST(HydraulicChirp, TwoBlocksLeaveAThirdLessOfTheErrorAtLeast) {
  HydraulicChirpParams params;
  params.task.duration_s = 10.0;
  const auto result = run_hydraulic_chirp(params).value();
  ASSERT_EQ(result.scores.size(), 6u);
  const CurrentScore& without = result.scores[0];
  const CurrentScore& with = result.scores[2];
  EXPECT_EQ(without.blocks, 0);
  EXPECT_EQ(with.blocks, 2);
  EXPECT_LT(with.mae_mA, 0.7 * without.mae_mA);
  for (const CurrentScore& score : result.scores) EXPECT_LT(score.mae_below_2_Hz_mA, 0.05 * 15.0) << score.name;
}

TEST(HydraulicChirp, EqualParametersGiveEqualBits) {
  HydraulicChirpParams params;
  params.task.duration_s = 3.0;
  const auto one = run_hydraulic_chirp(params).value(), other = run_hydraulic_chirp(params).value();
  EXPECT_EQ(one.scores[2].estimate_mA, other.scores[2].estimate_mA);
}

TEST(HydraulicChirp, AMotionTooSmallToTellTheTimeConstantIsRefused) {
  HydraulicChirpParams params;
  params.task.training_amplitude_m = 2e-4;
  const auto result = run_hydraulic_chirp(params);
  ASSERT_FALSE(result);
  EXPECT_TRUE(result.error().parameter.starts_with("model")) << describe(result.error());
}

TEST(HydraulicRigidContact, BothPressesSettleWithPredictionAndTheEstimateIsEarlierThanThePressure) {
  const auto runs = run_hydraulic_rigid_contact({}).value();
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0].blocks, 0);
  EXPECT_EQ(runs[1].blocks, 2);
  for (const RigidContact& contact : runs[1].contacts) {
    EXPECT_TRUE(contact.touched);
    EXPECT_TRUE(contact.settled);
    EXPECT_LT(contact.estimate_after_s, contact.pressure_after_s);
  }
  EXPECT_LT(runs[1].false_force_N, runs[0].false_force_N);
  // In contact the current is what the master is ahead of the stop, less the overlap that free motion at rest has not.
  const auto i = static_cast<std::size_t>(4.5 / 0.001);
  const double current_mA = 300.0 * (runs[0].master_m[i] - runs[0].slave_m[i]);
  EXPECT_NEAR(runs[0].fed_back_N[i], 1320.0 * current_mA / 100.0, 0.1 * runs[0].fed_back_N[i]);
}

TEST(HydraulicRigidContact, ThePressuresSayTheForceOnTheStopAndTheEstimateHowFarTheMasterIsAhead) {
  const RigidContactRun run = run_hydraulic_rigid_contact({}).value()[1];
  for (const RigidContact& contact : run.contacts) {
    EXPECT_NEAR(contact.pressure_force_N, contact.stop_force_N, 0.03 * contact.stop_force_N);
    EXPECT_GT(contact.stop_force_N, 8.0 * contact.fed_back_N);
  }
  EXPECT_GT(run.contacts[1].fed_back_N, 1.8 * run.contacts[0].fed_back_N) << "twice as far";
  EXPECT_LT(run.contacts[1].stop_force_N, 1.3 * run.contacts[0].stop_force_N) << "the supply gives no more";
}

TEST(HydraulicRigidContact, ALinkThatIsTooSlowRingsAndIsNotCalledSettled) {
  HydraulicRigidContactParams params;
  params.task.delay_s = 0.01;
  const auto runs = run_hydraulic_rigid_contact(params).value();
  for (const RigidContactRun& run : runs) {
    for (const RigidContact& contact : run.contacts) {
      EXPECT_FALSE(contact.settled);
      EXPECT_GT(contact.touches, 3);
    }
  }
}

TEST(HydraulicRigidContact, RefusesAPressureFilterAboveHalfTheServoRate) {
  HydraulicRigidContactParams params;
  params.task.pressure_filter_Hz = 600.0;
  const auto error = check(params);
  ASSERT_TRUE(error);
  EXPECT_TRUE(error->parameter.starts_with("task.pressure_filter_Hz"));
}

TEST(HydraulicRigidContact, RefusesASubstepThatIsTooLong) {
  HydraulicRigidContactParams params;
  params.plant.longest_step_s = 1e-4;
  const auto error = check(params);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->parameter, "slave.cylinder.dead_volume_m3");
}

}  // namespace hydraulic_test
}  // namespace tactus::experiments
