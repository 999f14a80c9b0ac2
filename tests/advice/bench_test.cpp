// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/advice/bench.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/scratch_path.hpp"
#include <gtest/gtest.h>

namespace tactus::advice {
namespace bench_test {

configuration::Document document(const std::vector<std::string>& set = {}) {
  auto parsed = configuration::Document::parse("[task]\nkind = \"tapping\"\nmodel_error = 0.2\n", "device.toml");
  for (const std::string& one : set) EXPECT_FALSE(parsed->set(one));
  return *parsed;
}

Bench bench_with(const std::vector<std::string>& set) { return *make_bench(document(set), {}, set); }

std::vector<std::string> words_of(const Dimension& dimension) {
  std::vector<std::string> words;
  for (const Choice& choice : dimension) words.push_back(choice.words);
  return words;
}

std::vector<Dimension> left(const std::vector<std::string>& set) {
  return *allowed(bench_with(set), position_force_dimensions({}));
}

TEST(AdviceBench, WithNothingGivenEveryChoiceIsLeft) { EXPECT_EQ(left({}), position_force_dimensions({})); }

TEST(AdviceBench, AGivenWordLeavesTheChoicesThatSayTheSame) {
  EXPECT_EQ(words_of(left({"control.cancellation=on"})[1]), std::vector<std::string>{"cancellation"});
  EXPECT_EQ(words_of(left({" control.cancellation = off"})[1]), std::vector<std::string>{""});
  const auto filters = left({"control.command_filter.kind=notch"})[5];
  ASSERT_EQ(filters.size(), 1U);
  EXPECT_FALSE(filters[0].tuned.empty()) << "its frequency was not given";
}

TEST(AdviceBench, AnEstimateOfTheGripThatNoChoiceHasStays) {
  const Bench bench = bench_with({"control.operator_estimate=scheduled"});
  for (const Method& method : combine(*allowed(bench, position_force_dimensions({})), 0)) {
    EXPECT_EQ(params_of(bench, method)->control.operator_estimate, control::OperatorEstimate::scheduled);
  }
}

TEST(AdviceBench, AGivenNumberThatNoChoiceHasIsTheOnlyOne) {
  const auto damping = left({"control.damping.damping_N_s_per_m=8"})[3];
  ASSERT_EQ(damping.size(), 1U);
  EXPECT_TRUE(damping[0].settings.empty());
  EXPECT_EQ(words_of(left({"control.damping.damping_N_s_per_m=5.0"})[3]),
            std::vector<std::string>{"local damping of the given N s/m"});
}

TEST(AdviceBench, AGivenFrequencyIsKeptWhereTheFilterIsChosen) {
  const auto filters = left({"control.command_filter.frequency_Hz=60"})[5];
  ASSERT_EQ(filters.size(), 3U);
  EXPECT_TRUE(filters[1].tuned.empty());
  for (const auto& [key, value] : filters[1].settings) EXPECT_NE(key, "control.command_filter.frequency_Hz");
}

TEST(AdviceBench, NoMethodChangesWhatWasGiven) {
  const std::vector<std::string> set{"control.cancellation=on", "control.hand_compensation_Hz=150",
                                     "control.force_limit_N=4"};
  const Bench bench = bench_with(set);
  for (const Method& method : combine(*allowed(bench, position_force_dimensions({})), 2)) {
    const auto params = params_of(bench, method);
    ASSERT_TRUE(params);
    EXPECT_EQ(params->control.cancellation, control::CancellationMode::on);
    EXPECT_EQ(params->control.hand_compensation_Hz, 150.0);
    EXPECT_EQ(params->control.force_limit_N, 4.0);
  }
}

TEST(AdviceBench, AStatedErrorIsDrawnOnceForEachRigAndNotAgainForEachTap) {
  const Bench bench = bench_with({});
  EXPECT_EQ(bench.knowledge.stated_error(), 0.2);
  EXPECT_EQ(params_of(bench, Method{})->task.model_error, 0.0);
}

TEST(AdviceBench, AnotherKindIsRefusedAndTheRightOneNamed) {
  const auto other = configuration::Document::parse("[task]\nkind = \"contest\"\n", "contest.toml");
  const auto bench = make_bench(*other, {}, {});
  ASSERT_FALSE(bench);
  EXPECT_EQ(bench.error().parameter, "task.kind");
  EXPECT_NE(bench.error().message.find("kinds tapping and arm-tapping, not contest"), std::string::npos)
      << bench.error().message;
  EXPECT_EQ(bench.error().place, "contest.toml:2:8");
  EXPECT_EQ(make_bench(*configuration::Document::parse("a = 1\n", "none.toml"), {}, {}).error().code,
            ErrorCode::missing);
}

TEST(AdviceBench, TheIntervalsBesideAModelAreFoundAndWithoutThemTheStatedErrorCounts) {
  const auto folder = scratch_path();
  std::filesystem::create_directory(folder);
  const std::string model = (folder / "model.toml").string();
  std::ofstream(model) << "[control.model.motor]\nmass_kg = 0.008\n";
  const auto without = make_bench(document(), {model}, {});
  ASSERT_TRUE(without);
  EXPECT_FALSE(without->knowledge.of_identification());
  EXPECT_TRUE(without->given.contains("control.model.motor.mass_kg"));
  std::ofstream(folder / "results.json")
      << R"({"parameters": [{"name": "motor.mass_kg", "value": 0.008, "unit": "kg", "interval_95": [0.007, 0.009]}]})";
  const auto with = make_bench(document(), {model}, {});
  ASSERT_TRUE(with);
  EXPECT_TRUE(with->knowledge.of_identification());
  EXPECT_EQ(with->knowledge.parameters().size(), 1U);
  const auto more = make_bench(document({"task.model_error=0.1"}), {model}, {"task.model_error=0.1"});
  EXPECT_EQ(params_of(*more, Method{})->task.model_error, 0.1) << "given, so it stays";
  std::filesystem::remove_all(folder);
}

}  // namespace bench_test
}  // namespace tactus::advice
