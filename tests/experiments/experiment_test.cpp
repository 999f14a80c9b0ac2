// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/experiment.hpp>

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace tactus::experiments {
namespace experiment_test {

using Json = nlohmann::ordered_json;

TEST(Variation, IsAKeyAndItsValuesAsTheyWereTyped) {
  const auto variation = parse_variation("control.force_gain=1,3.5,1e1");
  ASSERT_TRUE(variation);
  EXPECT_EQ(variation.value().key, "control.force_gain");
  EXPECT_EQ(variation.value().values, (std::vector<std::string>{"1", "3.5", "1e1"}));
  EXPECT_EQ(parse_variation("a=b").value().values, std::vector<std::string>{"b"});
  // Only the first '=' divides.
  EXPECT_EQ(parse_variation("a=b=c,d").value().values, (std::vector<std::string>{"b=c", "d"}));
}

TEST(Variation, RefusesWhatIsNoListOfValuesAndShowsHowToWriteOne) {
  for (const char* text : {"", "control.force_gain", "=1,2", "control.force_gain=", "a=1,", "a=,1", "a=1,,2", "a=,"}) {
    const auto variation = parse_variation(text);
    ASSERT_FALSE(variation) << text;
    EXPECT_EQ(variation.error().code, ErrorCode::syntax) << text;
    EXPECT_EQ(variation.error().place, "--vary " + std::string(text));
    EXPECT_NE(variation.error().message.find("control.force_gain=1,3,5"), std::string::npos) << text;
  }
}

TEST(Combinations, RunThroughAllValuesWithTheFirstKeySlowest) {
  const auto all = combinations({{"a", {"1", "2"}}, {"b", {"x", "y", "z"}}});
  ASSERT_TRUE(all);
  const std::vector<Settings> expected{{{"a", "1"}, {"b", "x"}}, {{"a", "1"}, {"b", "y"}}, {{"a", "1"}, {"b", "z"}},
                                       {{"a", "2"}, {"b", "x"}}, {{"a", "2"}, {"b", "y"}}, {{"a", "2"}, {"b", "z"}}};
  EXPECT_EQ(all.value(), expected);
}

TEST(Combinations, WithoutVariationsThereIsOneEmptyOne) {
  const auto all = combinations({});
  ASSERT_TRUE(all);
  EXPECT_EQ(all.value(), std::vector<Settings>{{}});
}

TEST(Combinations, RefuseAKeyThatIsVariedTwice) {
  const auto all = combinations({{"a", {"1"}}, {"b", {"1"}}, {"a", {"2"}}});
  ASSERT_FALSE(all);
  EXPECT_EQ(all.error().code, ErrorCode::inconsistent);
  EXPECT_EQ(all.error().parameter, "a");
}

TEST(Combinations, RefuseMoreThanAHundredThousand) {
  const std::vector<std::string> thousand(1000, "1"), hundred(100, "1");
  EXPECT_EQ(combinations({{"a", thousand}, {"b", hundred}}).value().size(), 100'000U);
  const auto all = combinations({{"a", thousand}, {"b", hundred}, {"c", {"1", "2"}}});
  ASSERT_FALSE(all);
  EXPECT_EQ(all.error().parameter, "c");
}

/// An experiment as the command line would ask for it.
Result<Outcome> outcome_of(const std::string& toml, const std::vector<std::string>& variations,
                           std::vector<double>* progress = nullptr) {
  Request request{.document = configuration::Document::parse(toml, "test.toml").value(),
                  .variations = {},
                  .name = "test",
                  .command = "tactus run test.toml"};
  for (const std::string& text : variations) request.variations.push_back(parse_variation(text).value());
  const auto experiment = choose_experiment(request.document);
  if (!experiment) return experiment.error();
  return experiment.value()->run(request, [progress](double done) {
    if (progress != nullptr) progress->push_back(done);
  });
}

const std::string two_taps = "[task]\nkind = 'tapping'\ntaps = 2\nobservation_s = 0.15\n";

std::vector<std::string> keys_of(const Json& object) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : object.items()) keys.push_back(key);
  return keys;
}

TEST(TappingExperiment, ItsJsonIsAsPromised) {
  const auto outcome = outcome_of(two_taps, {"control.force_gain=1,2.5", "control.cancellation=off,on"});
  ASSERT_TRUE(outcome) << describe(outcome.error());
  const Json json = Json::parse(outcome.value().json);
  EXPECT_EQ(keys_of(json), (std::vector<std::string>{"experiment", "runs"}));
  EXPECT_EQ(json["experiment"], "test");
  ASSERT_EQ(json["runs"].size(), 4U);
  const Json sets{{{"control.force_gain", 1}, {"control.cancellation", "off"}},
                  {{"control.force_gain", 1}, {"control.cancellation", "on"}},
                  {{"control.force_gain", 2.5}, {"control.cancellation", "off"}},
                  {{"control.force_gain", 2.5}, {"control.cancellation", "on"}}};
  std::size_t censored = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Json& run = json["runs"][i];
    EXPECT_EQ(keys_of(run), (std::vector<std::string>{"set", "metrics"}));
    EXPECT_EQ(run["set"], sets[i]);
    EXPECT_EQ(run["set"].dump(), sets[i].dump()) << "the order of the keys is that of the options";
    Json metrics = run["metrics"];
    for (const std::string name : {"settling_time_median_s", "settling_time_p90_s"}) {
      const bool cut_off = metrics[name] == 0.15;  // where the observation ends
      EXPECT_EQ(metrics.value(name + "_censored", false), cut_off) << name;
      censored += metrics.erase(name + "_censored");
    }
    EXPECT_EQ(keys_of(metrics),
              (std::vector<std::string>{"taps", "settled_fraction", "settling_time_median_s", "settling_time_p90_s",
                                        "contacts_median", "peak_force_N", "residual_rms_N", "verdict"}));
    EXPECT_EQ(metrics["taps"], 2);
    for (const auto& [key, value] : metrics.items()) {
      EXPECT_TRUE(key == "verdict" ? value.is_string() : value.is_number()) << key;
    }
  }
  EXPECT_GT(censored, 0U);
}

TEST(TappingExperiment, WithoutVariationsThereIsOneRunWithAnEmptySet) {
  const auto outcome = outcome_of(two_taps, {});
  ASSERT_TRUE(outcome);
  const Json json = Json::parse(outcome.value().json);
  ASSERT_EQ(json["runs"].size(), 1U);
  EXPECT_EQ(json["runs"][0]["set"].dump(), "{}");
  EXPECT_FALSE(outcome.value().figures.empty());
}

TEST(TappingExperiment, ReportsProgressThatRisesToTheWhole) {
  std::vector<double> progress;
  ASSERT_TRUE(outcome_of(two_taps, {"control.force_gain=1,2"}, &progress));
  EXPECT_TRUE(std::is_sorted(progress.begin(), progress.end()));
  EXPECT_GT(progress.front(), 0.0);
  EXPECT_EQ(progress.back(), 1.0);
}

TEST(TappingExperiment, ChecksEveryCombinationBeforeTheFirstIsRun) {
  std::vector<double> progress;
  const auto outcome = outcome_of(two_taps, {"control.force_gain=1,2,-3"}, &progress);
  ASSERT_FALSE(outcome);
  EXPECT_TRUE(progress.empty());
  EXPECT_EQ(outcome.error().place, "--vary control.force_gain=-3");
  EXPECT_EQ(outcome.error().parameter, "control.force_gain");
  EXPECT_EQ(outcome.error().code, ErrorCode::out_of_bounds);
}

TEST(TappingExperiment, BlamesTheVariedValueForWhatItMakesImpossible) {
  const auto outcome = outcome_of(two_taps, {"operator.grip.stiffness_N_per_m=40,1e12"});
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().place, "--vary operator.grip.stiffness_N_per_m=1e12");
  const auto unknown = outcome_of(two_taps, {"control.force_gian=1,2"});
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().place, "--vary control.force_gian=1");
  EXPECT_NE(unknown.error().message.find("force_gain"), std::string::npos);
  // What the file says stays the file's.
  const auto in_file = outcome_of("[task]\nkind = 'tapping'\ntaps = 0\n", {"control.force_gain=1,2"});
  ASSERT_FALSE(in_file);
  EXPECT_EQ(in_file.error().place, "test.toml:3:8");
}

TEST(ForceDisplayExperiment, ItsJsonHoldsEveryCaseOfEveryRun) {
  const auto outcome = outcome_of("[task]\nkind = 'force-display'\nrepeats = 1\n", {"profile.frequency_Hz=60,120"});
  ASSERT_TRUE(outcome) << describe(outcome.error());
  const Json json = Json::parse(outcome.value().json);
  ASSERT_EQ(json["runs"].size(), 2U);
  EXPECT_EQ(json["runs"][1]["set"]["profile.frequency_Hz"], 120);
  const Json& cases = json["runs"][1]["metrics"]["cases"];
  ASSERT_EQ(cases.size(), 12U);
  EXPECT_EQ(keys_of(cases[0]), (std::vector<std::string>{"scale", "friction", "model", "induced_rms_m", "kept_fraction",
                                                         "encoder_fraction"}));
  EXPECT_EQ(outcome.value().figures.size(), 2U);
}

TEST(ChooseExperiment, KnowsItsKindsAndListsThemForAnother) {
  const auto chosen = [](const std::string& toml) {
    return choose_experiment(configuration::Document::parse(toml, "test.toml").value());
  };
  EXPECT_EQ(chosen("task.kind = 'tapping'").value()->kind(), "tapping");
  EXPECT_EQ(chosen("task.kind = 'force-display'").value()->kind(), "force-display");
  EXPECT_EQ(chosen("task.kind = 'contest'").value()->kind(), "contest");
  const auto unknown = chosen("[task]\nkind = 'grasping'");
  ASSERT_FALSE(unknown);
  // What a program registered stands behind those of the library.
  EXPECT_TRUE(describe(unknown.error())
                  .starts_with("test.toml:2:8: task.kind: 'grasping' is no kind of experiment: write one of "
                               "tapping, force-display, contest, inverse-model-chirp, prediction-block, "
                               "force-estimators, hydraulic-chirp, hydraulic-rigid-contact, sensorless, faults"))
      << describe(unknown.error());
  const auto missing = chosen("[control]\nforce_gain = 1.0");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::missing);
}

}  // namespace experiment_test
}  // namespace tactus::experiments
