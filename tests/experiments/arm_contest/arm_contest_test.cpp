// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/simulation/experiments/arm_contest/arm_contest.hpp>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::experiments {
namespace arm_contest_test {

const std::filesystem::path folder = TACTUS_EXPERIMENT_FOLDER;

ArmContestParams shipped() {
  return configuration::Document::load(folder / "arm-contest.toml")->read<ArmContestParams>().value();
}

/// One pair in a firm hand, with a tap.
ArmContest glance() {
  ArmContestParams params = shipped();
  params.task.taps = 1;
  params.pairs.pair_2.name = params.pairs.pair_3.name = params.pairs.pair_4.name = params.hands.hand_2.name = "";
  return *make_arm_contest(params, folder);
}

std::size_t method_named(std::string_view name) {
  const auto methods = arm_contest_methods();
  const auto found = std::find_if(methods.begin(), methods.end(), [&](const auto& one) { return one.name == name; });
  EXPECT_NE(found, methods.end()) << name;
  return static_cast<std::size_t>(found - methods.begin());
}

TEST(ArmContest, RunsEveryMethodOnEachPairInEachHand) {
  const ArmContest contest = *make_arm_contest(shipped(), folder);
  EXPECT_EQ(contest.pairs.size(), 4U);
  EXPECT_EQ(contest.hands.size(), 2U);
  EXPECT_EQ(contest.entries.size(), 8 * arm_contest_methods().size());
  for (std::size_t i = 0; i < contest.entries.size(); ++i) {
    EXPECT_EQ(contest.entries[i].method, i % arm_contest_methods().size());
    EXPECT_EQ(contest.entries[i].taps.size(), 2U);
  }
}

TEST(ArmContest, TheRecommendedConfigurationAllowsMoreGainThanPlainAndCostsEffort) {
  const ArmContest contest = glance();
  const ArmContestScore plain = score_of(contest.entries[method_named("position-force")].taps, 0.5, 8.0);
  const ArmContestScore best = score_of(contest.entries[method_named("recommended, cancellation")].taps, 0.5, 8.0);
  EXPECT_GE(plain.limit.gain, 1.4);
  EXPECT_LE(plain.limit.gain, 4.1);
  EXPECT_TRUE(best.limit.beyond_search);
  EXPECT_GT(plain.felt_share.value(), 0.1);
  EXPECT_GT(best.felt_share_at_limit.value(), 3.0 * best.felt_share.value()) << "it displays";
  EXPECT_GT(best.reach.effort_N, 2.0 * plain.reach.effort_N);
  EXPECT_GT(plain.reach.lag_m, 0.004);
}

TEST(ArmContest, AGainThatIsTriedIsTheOneOfArmTapping) {
  const ArmContest contest = glance();
  auto document = *configuration::Document::load(folder / "arm-tapping.toml");
  ASSERT_EQ(document.merge(*configuration::Document::load(folder / "arms/bare.toml")), std::nullopt);
  ASSERT_EQ(document.set("control.command_low_pass_Hz=8"), std::nullopt);
  ASSERT_EQ(document.set("control.force_gain=1"), std::nullopt);
  ASSERT_EQ(document.set("task.taps=1"), std::nullopt);
  const ArmTaps taps = *ArmTaps::make(document.read<ArmTappingParams>().value(), folder);
  const ArmContestScore score = score_of(contest.entries[method_named("command low-pass")].taps, 0.9, 1.1);
  EXPECT_EQ(score.felt_share.value(), taps.run(0).contact.felt_share);
  EXPECT_EQ(score.reach.lag_m, taps.reach().lag_m);
}

TEST(ArmContest, TheMethodToUseLetsMostBeFeltInTheHandThatFeelsLeast) {
  ArmContestParams params = shipped();
  params.pairs.pair_2.name = params.pairs.pair_3.name = params.pairs.pair_4.name = "";
  const ArmContest contest = *make_arm_contest(params, folder);
  std::vector<ArmContestScore> scores(contest.entries.size());
  for (std::size_t i = 0; i < scores.size(); ++i) {
    const ArmContestEntry& entry = contest.entries[i];
    scores[i].felt_share_at_limit = 0.1;
    if (entry.method == 2) scores[i].felt_share_at_limit = entry.hand == 0 ? 0.9 : 0.1;  // in one hand alone
    if (entry.method == 3) scores[i].felt_share_at_limit = 0.4;
    if (entry.method == 5) scores[i].felt_share_at_limit = 0.5;
    if (entry.method == 6) scores[i].felt_share_at_limit = 0.3;
  }
  EXPECT_EQ(arm_contest_winners(contest, scores, 0), (std::vector<std::size_t>{5, 3}));
  for (ArmContestScore& score : scores) score.felt_share_at_limit = std::nullopt;
  EXPECT_TRUE(arm_contest_winners(contest, scores, 0).empty());
}

TEST(ArmContest, WhatIsWrongIsNamed) {
  ArmContestParams params = shipped();
  params.pairs.pair_2.file = "no-such.toml";
  EXPECT_EQ(make_arm_contest(params, folder).error().parameter, "pairs.pair_2.file");
  params = shipped();
  params.pairs.pair_3.with = "no-such.toml";
  EXPECT_EQ(make_arm_contest(params, folder).error().parameter, "pairs.pair_3.with");
  params = shipped();
  params.hands.hand_2.with = "no-such.toml";
  EXPECT_EQ(make_arm_contest(params, folder).error().parameter, "hands.hand_2.with");
  params = shipped();
  params.pairs.pair_1.file = "contest.toml";
  EXPECT_EQ(make_arm_contest(params, folder).error().parameter, "pairs.pair_1.file");
  params = shipped();
  params.task.bare = "no-such.toml";
  EXPECT_EQ(make_arm_contest(params, folder).error().parameter, "task.bare");
  params = shipped();
  params.task.lowest_gain = 16.0;
  EXPECT_EQ(make_arm_contest(params, folder).error().parameter, "task.highest_gain");
  params = shipped();
  params.pairs = {};
  EXPECT_EQ(make_arm_contest(params, folder).error().code, ErrorCode::missing);
  params = shipped();
  params.hands = {};
  EXPECT_EQ(make_arm_contest(params, folder).error().parameter, "hands.hand_1.name");
}

}  // namespace arm_contest_test
}  // namespace tactus::experiments
