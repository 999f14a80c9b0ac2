// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/experiment.hpp>
#include <tactus/simulation/experiments/sensorless/presentation.hpp>
#include <tactus/simulation/experiments/sensorless/sensorless.hpp>

#include <cmath>
#include <string>
#include <vector>

#include "tests/default_experiment.hpp"
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

// What docs/theory/sensorless-teleoperation.md says, on smaller runs.
namespace tactus::experiments {
namespace sensorless_test {

using Json = nlohmann::ordered_json;
using control::CancellationMode;
using control::SlaveForceSource;

SensorlessParams sensorless() { return experiment_file<SensorlessParams>("sensorless"); }

SensorlessParams with(SlaveForceSource source, CancellationMode mode) {
  SensorlessParams params = sensorless();
  params.control.slave_force.source = source;
  params.control.cancellation = mode;
  return params;
}

bool settles(const SensorlessParams& params, double force_gain) {
  TappingParams taps = tapping_of(params, params.task);
  taps.task.taps = 6;
  taps.control.force_gain = force_gain;
  return taps_settle(taps);
}

constexpr std::array estimators{SlaveForceSource::inverse_model, SlaveForceSource::disturbance_observer,
                                SlaveForceSource::momentum_observer, SlaveForceSource::kalman};

TEST(Sensorless, CancellationStillSettlesWhenTheForceIsAnEstimate) {
  for (const SlaveForceSource source : estimators) {
    EXPECT_FALSE(settles(with(source, CancellationMode::off), 3.0)) << name_of(source);
    EXPECT_TRUE(settles(with(source, CancellationMode::on), 3.0)) << name_of(source);
  }
}

// On average over a fifth of a second: a step of even this encoder, differentiated twice, is a spike of 10 mN. The hand
// is still, for one that trembles turns friction around.
TEST(Sensorless, InAStillContactTheEstimateDiffersFromTheTruthByLessThanFriction) {
  const mechanics::CableChain::Params body = sensorless().slave.mechanism;
  const double friction_N = body.motor.friction_N + body.drum.friction_N;
  for (const SlaveForceSource source : estimators) {
    SensorlessParams params = with(source, CancellationMode::on);
    params.slave.encoder.resolution_m = 1e-7;
    params.person.tremor_amplitude_m = 0.0;
    const double before_m = params.environment.position_m - 0.01;
    auto teleoperator = simulation::Teleoperator::make(params, before_m);
    ASSERT_TRUE(teleoperator);
    const mechanics::MinimumJerk press{
        .start_m = before_m, .end_m = before_m + 0.02, .start_time_s = 0.05, .duration_s = 0.5};
    simulation::Teleoperator::Record last;
    double error_sum_N = 0.0;
    int counted = 0;
    for (double time_s = 0.0; time_s < 1.5; time_s += teleoperator->tick_s()) {
      last = teleoperator->step(press.position_m(time_s), press.position_m(time_s + teleoperator->tick_s()));
      if (time_s < 1.3) continue;
      error_sum_N += last.sent_force_N - last.contact_force_N;
      ++counted;
    }
    EXPECT_GT(last.contact_force_N, 5.0 * friction_N);
    EXPECT_LT(std::abs(error_sum_N / counted), friction_N) << name_of(source);
  }
}

TEST(Sensorless, WithAFineEncoderTheFalseForceOfFreeMotionIsBelowFriction) {
  for (const SlaveForceSource source : estimators) {
    SensorlessParams params = with(source, CancellationMode::on);
    params.slave.encoder.resolution_m = 1e-7;
    const mechanics::CableChain::Params& body = params.slave.mechanism;
    EXPECT_LT(score_free_space(params).displayed_force_rms_N, body.motor.friction_N + body.drum.friction_N)
        << name_of(source);
  }
}

TEST(Sensorless, PredictionMultipliesTheStepsOfACoarseEncoder) {
  SensorlessParams params = with(SlaveForceSource::inverse_model, CancellationMode::on);
  const double predicted_N = score_free_space(params).displayed_force_rms_N;
  params.control.slave_force.inverse_model.prediction.blocks = 0;
  const double plain_N = score_free_space(params).displayed_force_rms_N;
  EXPECT_GT(predicted_N, 2.0 * plain_N);
  EXPECT_LT(predicted_N, 4.0 * plain_N);  // two blocks amplify noise by at most 2 each
}

Request small(const std::vector<const char*>& settings = {}) {
  auto document = configuration::Document::load(std::string(TACTUS_EXPERIMENT_FOLDER) + "/sensorless.toml");
  for (const char* setting :
       {"task.taps=1", "task.lowest_gain=1", "task.highest_gain=1.1", "task.observation_s=0.15"}) {
    EXPECT_FALSE(document->set(setting));
  }
  for (const char* setting : settings) EXPECT_FALSE(document->set(setting));
  return {.document = *std::move(document),
          .variations = {},
          .name = "sensorless",
          .command = "tactus run sensorless.toml"};
}

Result<Outcome> run(const Request& request) {
  return choose_experiment(request.document).value()->run(request, [](double) {});
}

TEST(Sensorless, GivesTheSameBitsOnOneThreadInReverseAsTheExperimentOnAll) {
  const Request request = small();
  const auto outcome = run(request);
  ASSERT_TRUE(outcome) << describe(outcome.error());
  const SensorlessParams params = request.document.read<SensorlessParams>().value();
  const auto rows = sensorless_cases(params).value();
  std::vector<SensorlessScore> scores(rows.size());
  for (std::size_t row = rows.size(); row-- > 0;) {
    for (std::size_t part = sensorless_parts.size(); part-- > 0;) {
      score_part(sensorless_parts[part], rows[row], params.task, scores[row]);
    }
  }
  EXPECT_EQ(outcome->json, sensorless_json("sensorless", rows, scores, params));
  EXPECT_EQ(Json::parse(outcome->json)["rows"].size(),
            sensorless_delays_s.size() * force_choices.size() * sensorless_cancellation.size());
  for (const ForceChoice& choice : force_choices) {
    EXPECT_NE(outcome->text.find(choice.name), std::string::npos) << choice.name;
  }
}

TEST(Sensorless, RefusesWhatItCannotCompare) {
  const auto outcome = run(small({"task.highest_gain=1"}));
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().place, "--set task.highest_gain=1");
  const auto deaf = run(small({"control.architecture=wave-variables"}));
  ASSERT_FALSE(deaf);
  EXPECT_EQ(deaf.error().parameter, "control.slave_force.source");
  Request varied = small();
  varied.variations = {{.key = "control.force_gain", .values = {"1", "2"}}};
  const auto refused = run(varied);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().place, "--vary");
}

}  // namespace sensorless_test
}  // namespace tactus::experiments
