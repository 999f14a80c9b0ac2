// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/arm/external_torque.hpp>
#include <tactus/identification/arm/fit.hpp>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "tests/arm_identification/exact_arm.hpp"
#include <gtest/gtest.h>

namespace tactus::arm_identification {
namespace {

TEST(ArmIntervals, HoldAsOftenAsTheySayOverArmsMotionsAndNoise) {
  struct Count {
    int all = 0;
    int held = 0;
    [[nodiscard]] double share() const { return static_cast<double>(held) / all; }
  };
  Count all;
  Count friction;  // the numbers that a recording tells best, and a fixed law of turning round misses
  for (std::uint64_t seed = 301; seed <= 320; ++seed) {
    const IntervalCase made = interval_case(seed);
    const auto found = identify_arm(std::array{made.recording}, made.names, made.urdf);
    ASSERT_TRUE(found) << seed << ": " << describe(found.error());
    for (std::size_t j = 0; j < made.names.size(); ++j) {
      const std::vector<double> values = true_parameters(made.truth.joints[j]);
      for (std::size_t k = 0; k < values.size(); ++k) {
        const ArmParameter& p = found->joints[j].parameters[k];
        const bool holds = values[k] >= p.lower && values[k] <= p.upper;
        ++all.all;
        all.held += holds ? 1 : 0;
        if (p.name != "coulomb" && p.name != "viscous" && p.name != "offset") continue;
        EXPECT_TRUE(p.determined) << seed << " " << made.names[j] << " " << p.name;
        ++friction.all;
        friction.held += holds ? 1 : 0;
      }
    }
  }
  RecordProperty("pairs", all.all);
  RecordProperty("held", std::to_string(all.share()));
  RecordProperty("friction_pairs", friction.all);
  RecordProperty("friction_held", std::to_string(friction.share()));
  EXPECT_GE(all.all, 1500);
  EXPECT_GE(all.share(), 0.93);
  EXPECT_LE(all.share(), 0.98);
  EXPECT_GE(friction.share(), 0.92);
  EXPECT_LE(friction.share(), 0.98);
}

TEST(ArmIntervals, TheVelocityWithinWhichFrictionTurnsRoundIsFoundBetweenTheStepsOfTheFirstGuess) {
  for (const double factor : {1.0, 1.7}) {
    arm::Chain::Params truth = open_arm();
    for (arm::JointParams& joint : truth.joints) joint.friction.velocity_scale_rad_per_s = 0.04 * factor;
    IntervalCase made = interval_case(4);
    const Samples samples = exact_motion(truth, {.seed = 4, .noise_N_m = 0.005});
    made.recording.sample_time = Seconds{samples.time_s[1]};
    made.recording.position = samples.position;
    made.recording.velocity = samples.velocity;
    made.recording.effort = samples.torque;
    const auto found = identify_arm(std::array{made.recording}, made.names, made.urdf);
    ASSERT_TRUE(found) << describe(found.error());
    for (const ArmJointModel& joint : found->model.joints) {
      EXPECT_NEAR(joint.arm.friction.velocity_scale_rad_per_s, 0.04 * factor, 0.2 * 0.04 * factor) << joint.name;
    }
    // What is estimated treats the recording as the identification did: it leaves the same in free motion.
    const auto again = estimate_external_torque(found->model, made.recording);
    ASSERT_TRUE(again) << describe(again.error());
    EXPECT_TRUE(again->contacts.empty());
    for (std::size_t j = 0; j < again->joints.size(); ++j) {
      EXPECT_NEAR(again->joints[j].residual_rms, found->joints[j].residual_rms, 0.02 * found->joints[j].residual_rms);
    }
  }
}

}  // namespace
}  // namespace tactus::arm_identification
