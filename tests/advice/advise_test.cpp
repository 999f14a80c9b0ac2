// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/advice/advise.hpp>
#include <tactus/analysis/advice/presentation.hpp>
#include <tactus/simulation/experiments/contest/contest.hpp>

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::advice {
namespace advise_test {

/// So little to choose from that a search takes a second.
const std::vector<std::string> narrow{"control.command_filter.kind=none", "control.force_filter.kind=none",
                                      "control.damping.damping_N_s_per_m=0", "control.hand_compensation_Hz=0",
                                      "control.operator_estimate=off"};

Bench bench_of(std::vector<std::string> set) {
  set.insert(set.begin(), narrow.begin(), narrow.end());
  auto document = configuration::Document::load(std::string(TACTUS_EXPERIMENT_FOLDER) + "/tapping.toml");
  for (const std::string& one : set) EXPECT_FALSE(document->set(one)) << one;
  return *make_bench(*document, {}, set);
}

Advice advise_on(const Bench& bench) {
  double last = 0.0;
  const auto advice = advise(bench, [&last](double done) { last = done; });
  EXPECT_TRUE(advice) << describe(advice.error());
  EXPECT_EQ(last, 1.0);
  return *advice;
}

std::string value_of(const experiments::Settings& settings, const std::string& key) {
  for (const auto& [name, value] : settings) {
    if (name == key) return value;
  }
  return "none";
}

TEST(Advise, PutsCancellationAgainstAStrongDisplayEachTimeAndItsGainHoldsOnTapsThatNoSearchSaw) {
  const Bench bench = bench_of({"control.force_limit_N=10", "task.model_error=0.05"});
  const Advice advice = advise_on(bench);
  ASSERT_TRUE(advice.start);
  EXPECT_EQ(advice.start->method.words(), "cancellation");
  // The contest, at 10 N: 1.1 without cancellation, 2.9 to 3.9 with a model that is 20 % wrong.
  EXPECT_GT(advice.start->force_gain, 2.5);
  ASSERT_FALSE(advice.alternatives.empty());
  EXPECT_LT(advice.alternatives.back().force_gain, 1.3);
  EXPECT_LE(advice.start->first_gain, advice.start->force_gain);
  EXPECT_GE(advice.expected.settled_fraction, 0.95);

  const auto settings = settings_of(bench, *advice.start);
  EXPECT_EQ(value_of(settings, "control.cancellation"), "on");
  EXPECT_EQ(value_of(settings, "control.force_limit_N"), "10");
  EXPECT_EQ(value_of(settings, "control.force_gain"), format_number(advice.start->force_gain));
  auto params = *params_of(bench, advice.start->method);
  params.task.seed = 77;
  params.task.taps = 32;
  params.task.model_error = 0.05;
  params.control.force_gain = advice.start->force_gain;
  EXPECT_TRUE(experiments::taps_settle(params));

  const experiments::Request request{.document = bench.document, .variations = {}, .name = "n", .command = "c"};
  const auto one = present(bench, advice, request), other = present(bench, advise_on(bench), request);
  EXPECT_EQ(one->json, other->json);
  EXPECT_EQ(one->text, other->text);
}

TEST(Advise, AGainThatIsGivenIsJudgedAndNotChanged) {
  const Bench fine = bench_of({"control.cancellation=off", "control.force_gain=0.5"});
  const Advice holds = advise_on(fine);
  ASSERT_TRUE(holds.start);
  EXPECT_EQ(holds.start->force_gain, 0.5);
  EXPECT_EQ(value_of(settings_of(fine, *holds.start), "control.force_gain"), "0.5");

  const Bench much = bench_of({"control.cancellation=off", "control.force_gain=20"});
  const Advice rings = advise_on(much);
  EXPECT_FALSE(rings.start);
  ASSERT_FALSE(rings.alternatives.empty());
  EXPECT_LT(rings.alternatives.front().force_gain, 2.0);
  EXPECT_NE(sentence(much, rings).find("Do not use a force gain of 20"), std::string::npos) << sentence(much, rings);
}

TEST(Advise, WhereNothingSettlesItSaysSo) {
  // A wall as hard as steel, at the end of a slave that hardly damps, in a display that may not be made smaller.
  const Bench bench = bench_of({"control.cancellation=off", "control.architecture=position-force",
                                "control.force_limit_N=10", "control.slave.derivative_N_s_per_m=0.01",
                                "environment.stiffness_N_per_m=200000", "environment.damping_N_s_per_m=0"});
  const Advice advice = advise_on(bench);
  EXPECT_FALSE(advice.start);
  EXPECT_NE(sentence(bench, advice).find("Do not close this loop"), std::string::npos) << sentence(bench, advice);
  const experiments::Request request{.document = bench.document, .variations = {}, .name = "n", .command = "c"};
  const auto outcome = present(bench, advice, request);
  ASSERT_TRUE(outcome);
  EXPECT_NE(outcome->json.find("\"force_gain\": 0.0"), std::string::npos) << outcome->json;
}

TEST(Advise, AModelOfAnotherMasterIsRefused) {
  const auto advice = advise(bench_of({"control.model.linkage.stiffness_N_per_m=8000"}), [](double) {});
  ASSERT_FALSE(advice);
  EXPECT_EQ(advice.error().parameter, "control.model.linkage.stiffness_N_per_m");
  EXPECT_EQ(advice.error().place, "--set control.model.linkage.stiffness_N_per_m=8000");
}

TEST(Advise, WhatIsInTheWayIsNamedWithWhatItsAbsenceWouldGive) {
  const Bench bench = bench_of({"control.cancellation=off", "control.force_limit_N=10"});
  const Advice advice = advise_on(bench);
  ASSERT_TRUE(advice.start);
  bool wall = false;
  for (const Obstacle& obstacle : advice.obstacles) {
    EXPECT_GE(obstacle.limit.gain, advice.start->limit.gain) << obstacle.parameter;
    wall = wall || obstacle.parameter == "environment.stiffness_N_per_m";
    // Without cancellation nothing uses the model, so that knowing it buys nothing.
    if (!obstacle.interval_95) continue;
    EXPECT_EQ(obstacle.limit.gain, advice.start->limit.gain) << obstacle.parameter;
  }
  EXPECT_TRUE(wall);
  EXPECT_EQ(worth_measuring(advice.obstacles, *advice.start), nullptr);
}

}  // namespace advise_test
}  // namespace tactus::advice
