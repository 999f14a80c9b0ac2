// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/experiment.hpp>
#include <tactus/simulation/experiments/force_estimators/force_estimators.hpp>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/default_experiment.hpp"
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

// What docs/theory/force-estimators.md says of the estimators on one slave.
namespace tactus::experiments {
namespace force_estimators_test {

ForceEstimatorsParams file() { return experiment_file<ForceEstimatorsParams>("force-estimators"); }

std::size_t tick_at(const SlaveRun& run, double time_s) {
  return static_cast<std::size_t>(std::lround(time_s / run.tick_s));
}

EstimatorScore score(const ForceEstimatorsResult& result, const std::string& name) {
  return *std::find_if(result.scores.begin(), result.scores.end(),
                       [&name](const EstimatorScore& s) { return s.name == name; });
}

TEST(ForceEstimators, TheSlaveTouchesNothingBeforeThePressAndIsHeldByTheServosForceInIt) {
  const ForceEstimatorsParams params = file();
  const SlaveRun run = drive_slave(params).value();
  const ForceEstimatorsPlan plan = plan_of(params.task);
  for (std::size_t tick = 0; tick < tick_at(run, plan.press_s); ++tick) ASSERT_EQ(run.true_N[tick], 0.0) << tick;
  // The servo's spring in series with cable, linkage and wall, give or take what friction holds.
  const mechanics::CableChain::Params& chain = params.slave.mechanism;
  const double compliance_m_per_N = 1.0 / params.controller.proportional_N_per_m + 1.0 / chain.cable.stiffness_N_per_m +
                                    1.0 / chain.linkage.stiffness_N_per_m + 1.0 / params.environment.stiffness_N_per_m;
  const double held_N = run.true_N[tick_at(run, plan.release_s) - 1];
  EXPECT_NEAR(held_N, -params.task.press_depth_m / compliance_m_per_N,
              chain.motor.friction_N + chain.drum.friction_N + 0.001);
}

TEST(ForceEstimators, InAHeldPressEachErrsByNoMoreThanTheSlavesFriction) {
  const ForceEstimatorsParams params = file();
  const ForceEstimatorsResult result = compare_force_estimators(params).value();
  const ForceEstimatorsPlan plan = plan_of(params.task);
  const double friction_N = params.slave.mechanism.motor.friction_N + params.slave.mechanism.drum.friction_N;
  const std::size_t begin = tick_at(result.run, plan.release_s - 0.2);
  const std::size_t end = tick_at(result.run, plan.release_s);
  for (const EstimatorScore& score : result.scores) {
    double error_N = 0.0;
    for (std::size_t tick = begin; tick < end; ++tick) error_N += score.estimate_N[tick] - result.run.true_N[tick];
    EXPECT_LT(std::abs(error_N) / static_cast<double>(end - begin), friction_N) << score.name;
  }
}

TEST(ForceEstimators, WithoutFrictionTheEncoderMakesMostOfTheFalseForceOfAllThatDifferentiateIt) {
  ForceEstimatorsParams params = file();
  params.slave.mechanism.motor.friction_N = 0.0;
  params.slave.mechanism.drum.friction_N = 0.0;
  for (control::SlaveModel* model :
       {&params.disturbance_observer.model, &params.momentum_observer.model, &params.kalman.model}) {
    model->friction = {};
    model->mass_kg = 0.03225;
  }
  params.inverse_model.friction = {};
  params.inverse_model.mass_kg = 0.03225;
  const ForceEstimatorsResult coarse = compare_force_estimators(params).value();
  params.slave.encoder.resolution_m = 1e-8;
  const ForceEstimatorsResult fine = compare_force_estimators(params).value();
  for (std::size_t i = 1; i < coarse.scores.size(); ++i) {
    EXPECT_LT(fine.scores[i].free_residual_N, 0.2 * coarse.scores[i].free_residual_N) << coarse.scores[i].name;
  }
}

TEST(ForceEstimators, TheSensorsNoiseAtRestIsTheNoiseThatItHas) {
  const ForceEstimatorsParams params = file();
  const ForceEstimatorsResult result = compare_force_estimators(params).value();
  EXPECT_NEAR(result.scores.front().rest_noise_N, params.slave.force_sensor.noise_rms_N,
              0.1 * params.slave.force_sensor.noise_rms_N);
}

TEST(ForceEstimators, PredictionLeadsAndAmplifiesWhatTheEncoderAdds) {
  const ForceEstimatorsResult result = compare_force_estimators(file()).value();
  const EstimatorScore without = score(result, "inverse model, no prediction");
  const EstimatorScore with = score(result, "inverse model, prediction blocks");
  EXPECT_GT(with.lead_s, without.lead_s);
  EXPECT_GT(with.free_residual_N, 2.0 * without.free_residual_N);
  EXPECT_LT(with.free_residual_N, 4.0 * without.free_residual_N);  // two blocks: 2² at most
}

TEST(ForceEstimators, PolynomialAndKalmanPredictorsLeadMoreThanTheBlocksAndAmplifyTheEncodersStepsLess) {
  const ForceEstimatorsResult result = compare_force_estimators(file()).value();
  const EstimatorScore blocks = score(result, "inverse model, prediction blocks");
  for (const char* rival : {"inverse model, polynomial", "inverse model, Kalman predictor"}) {
    EXPECT_GT(score(result, rival).lead_s, blocks.lead_s) << rival;
    EXPECT_LT(score(result, rival).free_residual_N, 0.6 * blocks.free_residual_N) << rival;
  }
}

TEST(ForceEstimators, TheNarxModelLearnsFrictionFromAnotherFreeMotion) {
  const ForceEstimatorsParams params = file();
  const SlaveRun training = drive_for_narx(params).value();
  for (const double force_N : training.true_N) ASSERT_EQ(force_N, 0.0);
  const ForceEstimatorsResult result = compare_force_estimators(params).value();
  for (const EstimatorScore& other : result.scores) {
    if (other.name == "force sensor" || other.name == "NARX model") continue;
    EXPECT_LT(score(result, "NARX model").free_residual_N, other.free_residual_N) << other.name;
  }
  EXPECT_LT(result.narx.simulated_rms_N, 0.5 * result.narx.command_rms_N);
}

TEST(ForceEstimators, TheExperimentListsEveryEstimatorAndNamesWhatItRefuses) {
  auto document = configuration::Document::load(std::string(TACTUS_EXPERIMENT_FOLDER) + "/force-estimators.toml");
  const Experiment& experiment = *choose_experiment(*document).value();
  Request request{.document = *document, .variations = {}, .name = "force-estimators", .command = "tactus run"};
  const auto outcome = experiment.run(request, [](double) {});
  ASSERT_TRUE(outcome) << describe(outcome.error());
  EXPECT_EQ(nlohmann::json::parse(outcome->json)["runs"][0]["estimators"].size(), 9U);

  for (const char* setting : {"inverse_model.actuator_gain=0", "kalman.position_noise_m=-1", "slave.encoder.bits=3",
                              "momentum_observer.cutoff_Hz=5000", "narx.lag_s=1",
                              "inverse_model.prediction.polynomial.samples=2", "servo.computation_delay_s=0.001"}) {
    request.document = *document;
    ASSERT_FALSE(request.document.set(setting));
    const auto refused = experiment.run(request, [](double) {});
    ASSERT_FALSE(refused) << setting;
    EXPECT_EQ(refused.error().place, "--set " + std::string(setting));
  }
}

}  // namespace force_estimators_test
}  // namespace tactus::experiments
