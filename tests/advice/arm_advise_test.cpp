// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/advice/arm_advise.hpp>
#include <tactus/analysis/advice/arm_presentation.hpp>
#include <tactus/analysis/advice/arm_trial.hpp>
#include <tactus/analysis/advice/internal/arm_climb.hpp>
#include <tactus/data/configuration/toml_writer.hpp>

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::advice {
namespace arm_advise_test {

using Words = std::vector<std::string>;

ArmBench arm_bench(const Words& set, const Words& with = {}) {
  const std::string folder = TACTUS_EXPERIMENT_FOLDER;
  auto document = configuration::Document::load(folder + "/arm-tapping.toml");
  for (const std::string& one : with) {
    EXPECT_FALSE(document->merge(*configuration::Document::load(folder + "/" + one))) << one;
  }
  for (const std::string& one : set) EXPECT_FALSE(document->set(one)) << one;
  auto bench = make_arm_bench(*document, set);
  EXPECT_TRUE(bench) << describe(bench.error());
  return *bench;
}

/// One hand at one pose in one direction, short taps in coarse steps, and next to nothing to choose from.
const Words narrow{"task.pose=0",
                   "task.direction=down",
                   "operator.hand.lever_m=0.05",
                   "task.observation_s=0.25",
                   "servo.plant_step_s=5e-4",
                   "control.method=position-force",
                   "control.force_low_pass_Hz=0",
                   "control.command_low_pass_Hz=0",
                   "control.damping_N_s_per_m=0",
                   "control.follower.stiffness_share=1",
                   "control.follower.tool_stiffness_limit_N_per_m=0",
                   "control.follower.observer.dead_band_share=0"};

Words operator+(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

std::string value_of(const experiments::Settings& settings, const std::string& key) {
  for (const auto& [name, value] : settings) {
    if (name == key) return value;
  }
  return "none";
}

TEST(ArmAdvise, RefusesAHandleThatLeadsTheToolByItsKey) {
  const std::string folder = TACTUS_EXPERIMENT_FOLDER;
  auto document = *configuration::Document::load(folder + "/arm-tapping.toml");
  ASSERT_FALSE(document.merge(*configuration::Document::load(folder + "/arms/inverse3-arm.toml")));
  const auto bench = make_arm_bench(document, {});
  ASSERT_FALSE(bench);
  EXPECT_EQ(bench.error().parameter, "control.follower.coupling");
  EXPECT_NE(bench.error().message.find("tactus advise"), std::string::npos) << bench.error().message;
}

TEST(ArmMethods, EachChoiceOfADimensionSetsTheSameKeysAndTheFirstIsBare) {
  for (const char* with : {"arms/light-grip.toml", "arms/yam-pair.toml", "arms/elastic-joints.toml"}) {
    const ArmBench bench = arm_bench({}, {with});
    const auto dimensions = arm_dimensions(bench.as_given, bench.joints);
    for (const Dimension& dimension : dimensions) {
      const auto keys = [](const Choice& choice) {
        std::set<std::string> all;
        for (const auto& setting : choice.settings) all.insert(setting.first);
        return all;
      };
      for (const Choice& choice : dimension) EXPECT_EQ(keys(choice), keys(dimension.front())) << choice.words;
    }
    const auto bare = params_of(bench, bare_method(dimensions));
    ASSERT_TRUE(bare) << describe(bare.error());
    EXPECT_EQ(bare->control.method, arm_control::ArmMethod::position_force);
    EXPECT_EQ(bare->control.damping_N_s_per_m, 0.0);
    EXPECT_EQ(bare->control.follower.stiffness_share, 1.0);
    EXPECT_EQ(bare->control.follower.observer.dead_band_share, 0.0);
    EXPECT_EQ(bare->control.drive_damping.joint_1.damping_N_m_s_per_rad, 0.0);
    for (const Choice& choice : arm_rivals(bench.as_given)) {
      Method rival = bare_method(dimensions);
      rival.choices.front() = choice;
      EXPECT_TRUE(ArmTrial::make(bench, *params_of(bench, rival), {})) << choice.words;
    }
  }
}

TEST(ArmMethods, WhatAFileRecommendsIsNotWhereTheSearchBegins) {
  const auto begin = [](const ArmBench& bench) {
    return configuration::to_toml(*params_of(bench, bare_method(arm_dimensions(bench.as_given, bench.joints))));
  };
  EXPECT_EQ(begin(arm_bench({})), begin(arm_bench({}, {"arms/bare.toml"})));
}

TEST(ArmMethods, DampingOfTheLeadersDrivesIsAMultipleOfTheFollowersAndNoMoreThanADriveTakes) {
  const ArmBench bench = arm_bench({});
  const Dimension damping = arm_dimensions(bench.as_given, bench.joints)[1];
  EXPECT_EQ(value_of(damping[1].settings, "control.drive_damping.joint_1.damping_N_m_s_per_rad"), "3");
  EXPECT_EQ(value_of(damping[2].settings, "control.drive_damping.joint_7.damping_N_m_s_per_rad"), "0.4");
  EXPECT_EQ(value_of(damping[3].settings, "control.drive_damping.joint_1.damping_N_m_s_per_rad"), "5");
}

TEST(ArmBench, AHandIsAddedThatIsSoftUnlessOneWasGiven) {
  const ArmBench both = arm_bench({});
  ASSERT_EQ(both.hands.size(), 2U);
  EXPECT_EQ(both.hands[0].hand.stiffness_N_per_m, 400.0);
  EXPECT_EQ(both.hands[1].hand.stiffness_N_per_m, 60.0);
  EXPECT_EQ(both.directions.size(), 3U);
  EXPECT_EQ(both.poses.size(), most_poses);
  const ArmBench one = arm_bench(narrow);
  EXPECT_EQ(one.hands.size(), 1U);
  EXPECT_EQ(one.directions.size(), 1U);
  EXPECT_EQ(one.poses, std::vector<std::int64_t>{0});
  EXPECT_EQ(arm_bench({}, {"arms/light-grip.toml"}).hands.size(), 1U) << "the file's own is soft";
}

TEST(ArmBench, WhatWasGivenIsNoChoice) {
  const ArmBench bench = arm_bench({"control.damping_N_s_per_m=25", "control.method=factr",
                                    "control.drive_damping.joint_2.damping_N_m_s_per_rad=1"});
  const auto dimensions = arm_dimensions(bench.as_given, bench.joints);
  const Dimension dampers = *allowed(bench, dimensions[2]);
  ASSERT_EQ(dampers.size(), 1U);
  EXPECT_TRUE(dampers.front().settings.empty());
  const Dimension couplings = *allowed(bench, dimensions[0]);
  ASSERT_EQ(couplings.size(), 1U);
  EXPECT_EQ(couplings.front(), Choice{});
  EXPECT_EQ(allowed(bench, dimensions[1])->size(), 1U) << "no choice has 1 at joint 2";
  EXPECT_EQ(allowed(arm_bench({}), dimensions[1])->size(), dimensions[1].size());
}

TEST(ArmTrial, NoStageSeesTheTapsOfAnother) {
  const ArmBench bench = arm_bench({});
  std::set<std::int64_t> seeds;
  std::size_t taps = 0;
  for (const std::int64_t first : {0, 1000, 2000, 3000, 4000}) {
    for (const Situation& one : situations(bench, {.first_seed = first, .poses = most_poses, .own_taps = 8})) {
      seeds.insert(one.seed);
      ++taps;
    }
  }
  EXPECT_EQ(seeds.size(), taps);
  for (const Situation& one : situations(bench, {.poses = seen_poses})) EXPECT_LE(one.pose, bench.poses[seen_poses]);
  EXPECT_GT(bench.poses.size(), 1 + seen_poses);
}

TEST(ArmTrial, ATapFailsWithThoseAlikeWhereTheyRingTooAndNotWhereItSettles) {
  const ArmBench bench = arm_bench(narrow, {"arms/bare.toml"});
  const auto params = *params_of(bench, {});
  const Situation tap = situations(bench, {}).front();
  EXPECT_FALSE(fails_with_those_alike(bench, params, tap, 0.5, {}));
  EXPECT_TRUE(fails_with_those_alike(bench, params, tap, 16.0, {}));
}

TEST(ArmTrial, TapsAtTheOwnPoseAreInEachDirectionAndHand) {
  const ArmBench bench = arm_bench({});
  std::set<std::pair<std::size_t, experiments::TapDirection>> seen;
  const auto taps = situations(bench, {.own_pose = false, .own_taps = 3});
  for (const Situation& one : taps) {
    EXPECT_EQ(one.pose, bench.poses.front());
    seen.emplace(one.hand, one.direction);
  }
  EXPECT_EQ(taps.size(), 6U);
  EXPECT_EQ(seen.size(), 6U);
}

TEST(ArmTrial, FreeReachesAreInEachHandAlongEachDirectionTheOwnOneFirst) {
  const ArmBench bench = arm_bench({});
  const auto params = *params_of(bench, {});
  const auto all = reaches(bench, params);
  ASSERT_TRUE(all) << describe(all.error());
  ASSERT_EQ(all->size(), 6U);
  std::size_t i = 0;
  using enum experiments::TapDirection;
  for (const auto direction : {down, along_x, along_y}) {
    for (const arm::HandImpedance& hand : {params.person.hand, light_grip}) {
      experiments::ArmTappingParams one = params;
      one.person.hand = hand;
      one.task.direction = direction;
      EXPECT_EQ((*all)[i++].lag_m, experiments::ArmTaps::make(one, bench.folder)->reach().lag_m) << name_of(direction);
    }
  }
}

TEST(ArmAdvise, DampingIsFoundForABarePairAndItsGainHoldsOnTapsThatNoSearchSaw) {
  const ArmBench bench = arm_bench(narrow, {"arms/bare.toml"});
  double last = 0.0;
  const auto advice = advise(bench, [&last](double done) { last = done; });
  ASSERT_TRUE(advice) << describe(advice.error());
  EXPECT_EQ(last, 1.0);
  ASSERT_TRUE(advice->start);
  EXPECT_GE(advice->start->settled_fraction, 0.95);
  // Plain settles up to about 2.8 in a firm hand (docs/theory/arm-methods.md), damping in the drives lifts that.
  EXPECT_NE(advice->start->method.words().find("in the leader's drives"), std::string::npos)
      << advice->start->method.words();
  EXPECT_GT(advice->start->force_gain, 2.0);

  auto params = *params_of(bench, advice->start->method);
  params.task.taps = 20;
  params.task.seed = 77;
  params.control.force_gain = advice->start->force_gain;
  const auto taps = *experiments::ArmTaps::make(params, bench.folder);
  std::size_t settled = 0;
  for (std::size_t i = 0; i < taps.size(); ++i) settled += taps.run(i).settled() ? 1U : 0U;
  EXPECT_GE(settled, 19U);

  const experiments::Request request{.document = bench.document, .variations = {}, .name = "n", .command = "c"};
  const auto outcome = present(bench, *advice, request);
  ASSERT_TRUE(outcome) << describe(outcome.error());
  EXPECT_TRUE(outcome->text.starts_with(sentence(bench, *advice) + "\n"));
  EXPECT_EQ(value_of(settings_of(bench, *advice->start), "control.force_gain"),
            format_number(advice->start->force_gain));
}

/// Along x, where some poses bear a third of what others do, and the climb sees two of them.
ArmBench along_x() {
  Words set = narrow + Words{"control.drive_damping_limit_N_s_per_m=20"};
  std::erase(set, "task.pose=0");
  std::replace(set.begin(), set.end(), std::string("task.direction=down"), std::string("task.direction=along-x"));
  return arm_bench(set, {"arms/bare.toml"});
}

TEST(ArmClimb, WhatItEndsAtIsMendedInThePosesThatItDidNotClimbIn) {
  const ArmBench bench = along_x();
  std::vector<Dimension> dimensions;
  for (const Dimension& one : arm_dimensions(bench.as_given, bench.joints)) {
    dimensions.push_back(*allowed(bench, one));
  }
  const auto costs = *ArmCosts::make(bench, bare_method(dimensions));
  const experiments::Progress silent = [](double) {};
  ArmClimb climb(bench, costs, dimensions, silent);
  ASSERT_FALSE(climb.run());
  const auto settles_everywhere = [&bench](const ArmStep& step) {
    const auto params = *params_of(bench, step.method);
    const auto taps = situations(bench, {.first_seed = 4000, .poses = seen_poses});
    return std::none_of(taps.begin(), taps.end(), [&](const Situation& tap) {
      return fails_with_those_alike(bench, params, tap, step.gain, {.brief = true});
    });
  };
  double highest = 0.0;
  for (const ArmStep& step : climb.steps()) highest = std::max(highest, step.gain);
  EXPECT_FALSE(settles_everywhere({climb.steps().back().method, highest}));
  EXPECT_TRUE(settles_everywhere(climb.steps().back()));
  EXPECT_LT(climb.steps().back().gain, highest);
}

TEST(ArmAdvise, WhatIsAdvisedSettlesInEveryPose) {
  const ArmBench bench = along_x();
  ASSERT_EQ(bench.poses.size(), most_poses);
  const auto advice = advise(bench, [](double) {});
  ASSERT_TRUE(advice) << describe(advice.error());
  ASSERT_TRUE(advice->start);
  auto params = *params_of(bench, advice->start->method);
  params.task.taps = 8;
  params.task.seed = 78;
  params.control.force_gain = advice->start->force_gain;
  for (const std::int64_t pose : bench.poses) {
    params.task.pose = pose;
    const auto taps = *experiments::ArmTaps::make(params, bench.folder);
    std::size_t settled = 0;
    for (std::size_t i = 0; i < taps.size(); ++i) settled += taps.run(i).settled() ? 1U : 0U;
    EXPECT_GE(settled, 6U) << "pose " << pose;
  }
}

TEST(ArmAdvise, AGainThatIsGivenIsJudgedAndNotChanged) {
  const Words fixed{"control.drive_damping_limit_N_s_per_m=0", "control.drive_damping.joint_1.damping_N_m_s_per_rad=0"};
  const ArmBench fine = arm_bench(narrow + fixed + Words{"control.force_gain=0.5"}, {"arms/bare.toml"});
  const auto holds = advise(fine, [](double) {});
  ASSERT_TRUE(holds);
  ASSERT_TRUE(holds->start);
  EXPECT_EQ(holds->start->force_gain, 0.5);
  EXPECT_EQ(value_of(settings_of(fine, *holds->start), "control.force_gain"), "0.5");

  const ArmBench much = arm_bench(narrow + fixed + Words{"control.force_gain=30"}, {"arms/bare.toml"});
  const auto rings = advise(much, [](double) {});
  ASSERT_TRUE(rings);
  EXPECT_FALSE(rings->start);
  EXPECT_NE(sentence(much, *rings).find("Do not use a force gain of 30"), std::string::npos) << sentence(much, *rings);
}

}  // namespace arm_advise_test
}  // namespace tactus::advice
