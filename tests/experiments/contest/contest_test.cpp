// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>
#include <tactus/simulation/experiments/contest/contest.hpp>
#include <tactus/simulation/experiments/contest/presentation.hpp>
#include <tactus/simulation/experiments/experiment.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/default_experiment.hpp"
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

// What docs/theory/contest.md says of the methods, and the experiment that compares them.
namespace tactus::experiments {
namespace contest_test {

using Json = nlohmann::ordered_json;

ContestParams contest() { return experiment_file<ContestParams>("contest"); }

TappingParams taps_at(double force_gain, double force_limit_N, int taps) {
  const ContestParams params = contest();
  TappingParams tapping;
  static_cast<simulation::Teleoperator::Params&>(tapping) = params;
  static_cast<TapSeries&>(tapping.task) = params.task;
  tapping.task.taps = taps;
  tapping.task.supervised = false;
  tapping.control.force_gain = force_gain;
  tapping.control.force_limit_N = force_limit_N;
  return tapping;
}

FreeSpaceScore free_space(double damping_N_s_per_m, control::Shaping command_filter) {
  simulation::Teleoperator::Params params = contest();
  params.control.cancellation = control::CancellationMode::off;
  params.control.damping.damping_N_s_per_m = damping_N_s_per_m;
  params.control.command_filter = {.kind = command_filter, .frequency_Hz = 30.0};
  return score_free_space(params);
}

TEST(Contest, ALowPassOfTheCommandCostsTheLagOfItsPhase) {
  const double plain_s = free_space(0.0, control::Shaping::none).lag_s.value();
  const double filtered_s = free_space(0.0, control::Shaping::low_pass).lag_s.value();
  EXPECT_NEAR(filtered_s - plain_s, std::numbers::sqrt2 / (2.0 * std::numbers::pi * 30.0), 4e-4);
}

TEST(Contest, LocalDampingCostsTheHandDampingTimesVelocity) {
  const double plain_N = free_space(0.0, control::Shaping::none).hand_force_rms_N;
  const double damped_N = free_space(2.0, control::Shaping::none).hand_force_rms_N;
  // A minimum-jerk reach of 60 mm in 0.5 s has √(10/7) of its mean speed as RMS. Friction acts along with the damper.
  const double damper_N = 2.0 * 0.06 / 0.5 * std::sqrt(10.0 / 7.0);
  EXPECT_GT(damped_N, damper_N);
  EXPECT_LT(damped_N, damper_N + plain_N);
}

TEST(Contest, CancellationSettlesAtFiveTimesTheGainOfPlainPositionForceAndDullsNothing) {
  const auto limit_of = [](control::CancellationMode mode) {
    TappingParams params = taps_at(1.0, 1.0, 8);
    params.control.cancellation = mode;
    return find_gain_limit(0.25, 12.0, [&params](double gain) {
      params.control.force_gain = gain;
      return taps_settle(params);
    });
  };
  const GainLimit plain = limit_of(control::CancellationMode::off);
  EXPECT_GE(plain.gain, 1.0);
  EXPECT_GE(limit_of(control::CancellationMode::on).gain, 5.0 * plain.gain);

  TappingParams plain_at_1 = taps_at(1.0, 1.0, 8);
  plain_at_1.control.cancellation = control::CancellationMode::off;
  const double allowed = 1.1 * score_taps(plain_at_1).spectral_error.value();
  for (const double gain : {1.0, 3.0, 10.0}) {
    EXPECT_LE(score_taps(taps_at(gain, 1.0, 8)).spectral_error.value(), allowed) << gain;
  }
}

TEST(Contest, CompensationOfTheWayToTheHandBringsMoreOfTheTouchAndAllowsMoreGain) {
  TappingParams params = taps_at(10.0, 10.0, 32);
  const double without = score_taps(params).metrics.settled_fraction;
  params.control.hand_compensation_Hz = 200.0;
  EXPECT_LT(without, 0.7);
  EXPECT_GE(score_taps(params).metrics.settled_fraction, 0.9);

  params = taps_at(1.0, 10.0, 6);
  const double before = score_taps(params).spectral_error.value();
  params.control.hand_compensation_Hz = 200.0;
  EXPECT_LT(score_taps(params).spectral_error.value(), 0.5 * before);
}

TEST(Contest, EndsASearchAtTheFirstTapThatDecides) {
  EXPECT_TRUE(taps_settle(taps_at(3.0, 1.0, 4)));
  TappingParams ringing = taps_at(3.0, 1.0, 4);
  ringing.control.cancellation = control::CancellationMode::off;
  EXPECT_FALSE(taps_settle(ringing));
}

Request small_contest(const std::vector<const char*>& settings = {}) {
  auto document = configuration::Document::load(std::string(TACTUS_EXPERIMENT_FOLDER) + "/contest.toml");
  for (const char* setting :
       {"task.taps=1", "task.lowest_gain=1", "task.highest_gain=1.1", "task.observation_s=0.15"}) {
    EXPECT_FALSE(document->set(setting));
  }
  for (const char* setting : settings) EXPECT_FALSE(document->set(setting));
  return {.document = *std::move(document), .variations = {}, .name = "contest", .command = "tactus run contest.toml"};
}

Result<Outcome> run(const Request& request) {
  return choose_experiment(request.document).value()->run(request, [](double) {});
}

TEST(Contest, ScoresEveryMethodInWordsPictureAndJson) {
  report::set_text_width(400);
  const auto outcome = run(small_contest());
  report::set_text_width(80);
  ASSERT_TRUE(outcome) << describe(outcome.error());
  const Json document = Json::parse(outcome->json);
  ASSERT_EQ(document["methods"].size(), contest_methods().size());
  std::set<std::string> names;
  for (const Json& method : document["methods"]) {
    const std::string name = method["name"];
    EXPECT_TRUE(names.insert(name).second) << name;
    EXPECT_NE(outcome->text.find(name), std::string::npos) << name;
    EXPECT_NE(outcome->figures.front().panels.front().y.categories.end(),
              std::find(outcome->figures.front().panels.front().y.categories.begin(),
                        outcome->figures.front().panels.front().y.categories.end(), name));
    const double limit = method["gain_limit"];
    EXPECT_TRUE(limit == 0.0 || (limit >= 1.0 && limit <= 1.1)) << name;
    EXPECT_EQ(method["metrics"]["delays"].size(), contest_delays_s.size());
    EXPECT_EQ(method["metrics"]["grips"].size(), contest_grips.size());
    EXPECT_EQ(method["metrics"]["gains"].size(), 2 * contest_gains.size());
    EXPECT_GT(method["metrics"]["free_space_hand_force_rms_N"], 0.0);
  }
}

/// The parameters of each method in a small contest.
std::vector<ContestParams> small_contest_params() {
  std::vector<ContestParams> all;
  for (const ContestMethod& method : contest_methods()) {
    configuration::Document document = small_contest().document;
    for (const std::string_view setting : method.settings) EXPECT_FALSE(document.set(setting));
    all.push_back(document.read<ContestParams>().value());
  }
  return all;
}

TEST(Contest, GivesTheSameBitsInWhateverOrderItsPiecesAreComputed) {
  const std::vector<ContestParams> all = small_contest_params();
  const auto json = [&all](bool reversed) {
    std::vector<ContestJob> jobs;
    for (std::size_t method = 0; method < all.size(); ++method) {
      auto own = contest_jobs(method, all[method]);
      for (ContestJob& job : *own) jobs.push_back(std::move(job));
    }
    if (reversed) std::reverse(jobs.begin(), jobs.end());
    std::vector<MethodScore> scores(all.size());
    for (const ContestJob& job : jobs) EXPECT_TRUE(job.take(job.run(), scores[job.method])) << job.name;
    return contest_json("contest", scores, all.front());
  };
  EXPECT_EQ(json(false), json(true));
}

TEST(Contest, EveryMethodReachesTheWallAndStaysThereOverALineThatReordersAndLoses) {
  const std::vector<ContestParams> all = small_contest_params();
  for (std::size_t method = 0; method < all.size(); ++method) {
    TappingParams params;
    static_cast<simulation::Teleoperator::Params&>(params) = all[method];
    params.task.taps = 2;
    params.task.supervised = false;
    for (station::Channel::Params* way : {&params.channel.to_slave, &params.channel.to_master}) {
      way->delay_s = 0.02;
      way->jitter_s = 0.01;
      way->loss_fraction = 0.1;
    }
    const auto ensemble = TappingEnsemble::make(params);
    ASSERT_TRUE(ensemble) << describe(ensemble.error());
    for (std::size_t tap = 0; tap < ensemble->size(); ++tap) {
      const TapResult result = ensemble->run(tap);
      EXPECT_TRUE(result.touched) << contest_methods()[method].name;
      EXPECT_FALSE(result.diverged) << contest_methods()[method].name;
    }
  }
}

TEST(Contest, RefusesASearchThatEndsWhereItBeginsAndAVariation) {
  const auto outcome = run(small_contest({"task.highest_gain=1"}));
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().parameter, "task.highest_gain");
  EXPECT_EQ(outcome.error().place, "--set task.highest_gain=1");

  Request varied = small_contest();
  varied.variations = {{.key = "control.force_gain", .values = {"1", "2"}}};
  const auto refused = run(varied);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().place, "--vary");
}

}  // namespace contest_test
}  // namespace tactus::experiments
