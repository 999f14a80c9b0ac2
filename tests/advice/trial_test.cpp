// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/advice/trial.hpp>
#include <tactus/simulation/experiments/contest/contest.hpp>

#include "tests/default_experiment.hpp"
#include <gtest/gtest.h>

namespace tactus::advice {
namespace trial_test {

using experiments::TappingParams;

TappingParams plain() {
  auto params = experiment_file<TappingParams>("tapping");
  params.control.cancellation = control::CancellationMode::off;
  params.task.model_error = 0.0;
  return params;
}

/// Half of the draws have a linkage four times as damped as they should, the others a light one that rings sooner.
Knowledge uncertain_hand() {
  const std::vector<identification::FoundParameter> hand{
      {.name = "operator.damping_N_s_per_m", .unit = "", .value = 23.0, .interval_95 = {23.0 / 2.5, 23.0 * 2.5}}};
  return Knowledge::identified(hand, {}, {});
}

TEST(Trial, AGainSettlesWhereItSettlesOnEachRigAlone) {
  auto trial = Trial::make(uncertain_hand(), plain(), {.first = 1, .rigs = 5, .taps = 2});
  ASSERT_TRUE(trial);
  ASSERT_EQ(trial->rigs().size(), 5U);
  for (const double gain : {0.3, 0.6, 0.9, 1.3, 2.0}) {
    bool each = true;
    for (TappingParams rig : trial->rigs()) {
      rig.control.force_gain = gain;
      each = each && experiments::taps_settle(rig);
    }
    EXPECT_EQ(trial->settles(gain), each) << gain;
  }
}

TEST(Trial, WhatIsUncertainNeverRaisesTheLimitOfWhatIsBelieved) {
  const Draws draws{.first = 0, .rigs = 6, .taps = 2};
  Draws known = draws;
  known.known.all = true;
  // Taps of the same seeds, so that the rigs alone differ.
  auto uncertain = Trial::make(uncertain_hand(), plain(), draws),
       certain = Trial::make(uncertain_hand(), plain(), known);
  EXPECT_LT(uncertain->limit(0.05, 4.0).gain, certain->limit(0.05, 4.0).gain);
}

TEST(Trial, EveryGripIsARig) {
  const auto trial = Trial::make({}, plain(), {.first = 3, .rigs = 2, .taps = 1}, any_grip);
  ASSERT_EQ(trial->rigs().size(), 6U);
  EXPECT_EQ(trial->rigs()[0].person.grip_change.factor, 1.0);
  EXPECT_EQ(trial->rigs()[1].person.grip_change.factor, 0.25);
  EXPECT_EQ(trial->rigs()[2].person.grip_change.factor, 4.0);
  EXPECT_EQ(trial->rigs()[0].task.seed, trial->rigs()[2].task.seed) << "the same hand otherwise";
}

TEST(Trial, TheGripOnWhichTheSearchEndedIsTold) {
  // A firm hand takes the damper away (docs/validation.md): four times the grip rings first.
  auto trial = Trial::make({}, plain(), {.first = 0, .rigs = 1, .taps = 2}, std::array{1.0, 4.0});
  const auto limit = trial->limit(0.05, 4.0);
  ASSERT_FALSE(limit.beyond_search);
  EXPECT_EQ(trial->failed_last().person.grip_change.factor, 4.0);
}

TEST(Trial, MetricsAreOfAllTapsOfAllRigs) {
  const auto trial = Trial::make({}, plain(), {.first = 0, .rigs = 3, .taps = 2});
  const auto metrics = trial->metrics(0.5);
  EXPECT_EQ(metrics.taps, 6U);
  EXPECT_EQ(metrics.settled_fraction, 1.0);
}

TEST(Trial, PlantsAreCoarserForASearchWhereTheyCanBeAndNeverFiner) {
  TappingParams fine = plain();
  fine.plant.longest_step_s = 1e-5;
  EXPECT_EQ(Trial::make({}, fine, {.rigs = 1, .taps = 1})->rigs()[0].plant.longest_step_s, 2e-5);
  EXPECT_EQ(Trial::make({}, fine, {.rigs = 1, .taps = 1, .coarse = false})->rigs()[0].plant.longest_step_s, 1e-5);
  fine.plant.longest_step_s = 4e-5;
  EXPECT_EQ(Trial::make({}, fine, {.rigs = 1, .taps = 1})->rigs()[0].plant.longest_step_s, 4e-5);
}

TEST(Trial, ARigThatCanNotBeIsPassedOverUnlessItIsTheOneThatIsBelieved) {
  // Half of these cables are too stiff for steps of 100 µs.
  const auto cable = [](double stiffness) {
    return Knowledge::identified(
        std::vector<identification::FoundParameter>{{.name = "cable.stiffness_N_per_m",
                                                     .unit = "",
                                                     .value = stiffness,
                                                     .interval_95 = {stiffness / 10.0, stiffness * 10.0}}},
        {}, {});
  };
  TappingParams params = plain();
  params.plant.longest_step_s = 1e-4;
  const auto some = Trial::make(cable(1e6), params, {.first = 0, .rigs = 8, .taps = 1});
  ASSERT_TRUE(some) << describe(some.error());
  EXPECT_EQ(some->rigs().size(), 8U);
  const auto none = Trial::make(cable(1e8), params, {.first = 0, .rigs = 8, .taps = 1});
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().parameter.find("cable"), std::string::npos) << describe(none.error());
}

}  // namespace trial_test
}  // namespace tactus::advice
