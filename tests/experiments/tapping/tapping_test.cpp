// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/tapping/tapping.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tests/default_experiment.hpp"
#include <gtest/gtest.h>

namespace tactus::experiments {
namespace tapping_test {

using Trace = std::vector<simulation::Teleoperator::Record>;

TappingParams default_params() { return experiment_file<TappingParams>("tapping"); }

TappingEnsemble made(const TappingParams& params) {
  auto ensemble = TappingEnsemble::make(params);
  EXPECT_TRUE(ensemble) << (ensemble ? "" : describe(ensemble.error()));
  return *std::move(ensemble);
}

std::vector<Trace> traces(const TappingParams& params) {
  const TappingEnsemble ensemble = made(params);
  std::vector<Trace> all(ensemble.size());
  for (std::size_t i = 0; i < ensemble.size(); ++i) ensemble.run(i, &all[i]);
  return all;
}

/// The hand follows its path as well as a hand of 23 N s/m can, and nothing pushes it off.
TappingParams unforced_params() {
  TappingParams params = default_params();
  params.control.force_gain = 0.0;
  params.person.tremor_amplitude_m = 0.0;
  params.person.correction.gain_per_s = 0.0;
  params.master.encoder.resolution_m = 0.0;
  params.master.mechanism.motor.friction_N = 0.0;
  params.master.mechanism.drum.friction_N = 0.0;
  return params;
}

struct Drawn {
  double depth_m, speed_m_per_s;
};

/// What a tap drew, from the outside: the reach starts as far before the wall as it ends beyond it and is fastest at
/// the wall.
std::vector<Drawn> drawn_by(const TappingParams& params) {
  std::vector<Drawn> all;
  for (const Trace& trace : traces(params)) {
    Drawn drawn{.depth_m = -trace.front().master_position_m, .speed_m_per_s = 0.0};
    for (std::size_t i = 1; i < trace.size(); ++i) {
      const double moved_m = trace[i].master_position_m - trace[i - 1].master_position_m;
      drawn.speed_m_per_s = std::max(drawn.speed_m_per_s, moved_m / (trace[i].time_s - trace[i - 1].time_s));
    }
    all.push_back(drawn);
  }
  return all;
}

TEST(TappingEnsemble, DrawsDepthAndSpeedWithinTheirBoundsAndAllOverThem) {
  const TappingParams params = unforced_params();
  std::vector<double> depth, speed;
  for (const Drawn& drawn : drawn_by(params)) {
    depth.push_back((drawn.depth_m - params.task.shallowest_m) / (params.task.deepest_m - params.task.shallowest_m));
    speed.push_back((drawn.speed_m_per_s - params.task.slowest_m_per_s) /
                    (params.task.fastest_m_per_s - params.task.slowest_m_per_s));
  }
  ASSERT_EQ(depth.size(), 32U);
  constexpr double lag = 0.01;  // the handle's mass on the hand rounds the top of the speed off
  for (std::size_t i = 0; i < depth.size(); ++i) {
    EXPECT_GE(depth[i], 0.0);
    EXPECT_LE(depth[i], 1.0);
    EXPECT_GE(speed[i], 0.0 - 2 * lag);
    EXPECT_LE(speed[i], 1.0 + lag);
  }
  for (auto* shares : {&depth, &speed}) {
    std::sort(shares->begin(), shares->end());
    // Of 32 even draws each outer sixth misses one in 300 times; the seed is fixed.
    EXPECT_LT(shares->front(), 1.0 / 6.0);
    EXPECT_GT(shares->back(), 5.0 / 6.0);
    EXPECT_EQ(std::adjacent_find(shares->begin(), shares->end()), shares->end()) << "two taps drew the same";
  }
}

TEST(TappingEnsemble, TheSameSeedDrawsTheSameTapsInEveryCondition) {
  TappingParams params = unforced_params();
  params.task.taps = 4;
  const auto reference = drawn_by(params);
  params.control.cancellation = control::CancellationMode::off;
  params.task.taps = 6;
  const auto more = drawn_by(params);
  params.task.seed = 2;
  const auto other = drawn_by(params);
  for (std::size_t i = 0; i < reference.size(); ++i) {
    EXPECT_EQ(more[i].depth_m, reference[i].depth_m);
    EXPECT_EQ(more[i].speed_m_per_s, reference[i].speed_m_per_s);
    EXPECT_NE(other[i].depth_m, reference[i].depth_m);
  }
}

/// Taps that differ in the error of the model alone, so that only the model's estimate can tell them apart.
TappingParams params_with_equal_taps() {
  TappingParams params = default_params();
  params.task.taps = 6;
  params.task.fastest_m_per_s = params.task.slowest_m_per_s;
  params.task.deepest_m = params.task.shallowest_m;
  params.person.tremor_amplitude_m = 0.0;
  params.slave.force_sensor.noise_rms_N = 0.0;
  params.control.cancellation = control::CancellationMode::off;
  params.control.force_gain = 1.0;
  return params;
}

double largest_estimate(const Trace& trace) {
  double largest = 0.0;
  for (const auto& record : trace) largest = std::max(largest, std::fabs(record.induced_position_m));
  return largest;
}

TEST(TappingEnsemble, EveryTapDrawsItsOwnErrorOfTheModel) {
  TappingParams params = params_with_equal_taps();
  params.task.model_error = 0.0;
  std::set<double> without, with;
  for (const Trace& trace : traces(params)) without.insert(largest_estimate(trace));
  EXPECT_EQ(without.size(), 1U) << "the taps must be equal, or this test proves nothing";
  params.task.model_error = 0.2;
  std::vector<Trace> all = traces(params);
  for (const Trace& trace : all) with.insert(largest_estimate(trace));
  EXPECT_EQ(with.size(), 6U);
  for (const double estimate : with) EXPECT_NEAR(estimate / *without.begin(), 1.0, 0.35);
  // Nobody listens to the estimate, so the taps themselves are still equal.
  for (const Trace& trace : all) EXPECT_EQ(trace.back().master_position_m, all.front().back().master_position_m);
}

/// A model of which one element alone decides the estimate, the others being next to nothing or next to rigid.
TappingParams params_with_simple_model() {
  TappingParams params = params_with_equal_taps();
  params.task.taps = 16;
  params.task.model_error = 0.2;
  control::MasterModel& model = params.control.model;
  for (auto* mass : {&model.motor, &model.drum}) *mass = {.mass_kg = 1e-5, .friction_N = 0.0};
  model.handle.mass_kg = 1e-5;
  model.cable = {.stiffness_N_per_m = 1e7, .damping_N_s_per_m = 10.0};
  model.linkage.stiffness_N_per_m = 1e7;
  model.linkage.damping_N_s_per_m = 10.0;
  model.linkage.hysteretic_fraction = 0.0;
  model.hand.stiffness_N_per_m = 0.0;
  model.hand.quintic_stiffness_N_per_m5 = 0.0;
  model.hand.damping_N_s_per_m = 10.0;
  return params;
}

/// The taps feel the same force, and the estimate is that force over the element: so the element's factor in each tap,
/// from the estimates with and without an error.
void expect_even_draws(TappingParams params) {
  const auto largest = [&params] {
    std::vector<double> all;
    for (const Trace& trace : traces(params)) all.push_back(largest_estimate(trace));
    return all;
  };
  const std::vector<double> with = largest();
  params.task.model_error = 0.0;
  params.task.taps = 1;
  const double nominal = largest().front();
  std::vector<double> factors;
  for (const double estimate : with) factors.push_back(nominal / estimate);
  ASSERT_EQ(factors.size(), 16U);
  std::sort(factors.begin(), factors.end());
  EXPECT_GT(factors.front(), 0.799);
  EXPECT_LT(factors.front(), 0.9);
  EXPECT_LT(factors.back(), 1.201);
  EXPECT_GT(factors.back(), 1.1);
  EXPECT_EQ(std::adjacent_find(factors.begin(), factors.end()), factors.end()) << "two taps drew the same";
}

TEST(TappingEnsemble, DrawsTheOperatorsDampingUpToTwentyPercentEachWay) {
  expect_even_draws(params_with_simple_model());
}

TEST(TappingEnsemble, DrawsTheLinkagesStiffnessUpToTwentyPercentEachWay) {
  TappingParams params = params_with_simple_model();
  params.control.model.linkage.stiffness_N_per_m = 1000.0;
  params.control.model.hand.stiffness_N_per_m = 1e7;
  expect_even_draws(params);
}

TEST(TappingEnsemble, DrawsTheMassesUpToTwentyPercentEachWay) {
  TappingParams params = params_with_simple_model();
  params.control.model.motor.mass_kg = 0.5;
  params.control.model.hand.damping_N_s_per_m = 0.0;
  expect_even_draws(params);
}

TEST(TappingEnsemble, AFixedMismatchChangesTheEstimateWithoutAnyDraw) {
  TappingParams params = params_with_equal_taps();
  params.task.taps = 1;
  params.task.model_error = 0.0;
  const double nominal = largest_estimate(traces(params).front());
  params.task.mismatch.operator_damping = 2.0;
  // More damping of the hand: less induced motion.
  EXPECT_LT(largest_estimate(traces(params).front()), 0.9 * nominal);
}

TEST(TappingEnsemble, ASlaveThatNeverComesDoesNotSettle) {
  TappingParams params = default_params();
  params.task.taps = 1;
  params.control.slave.proportional_N_per_m = 0.0;
  params.control.slave.derivative_N_s_per_m = 0.0;
  const TapResult tap = made(params).run(0);
  EXPECT_FALSE(tap.touched);
  EXPECT_FALSE(tap.diverged);
  EXPECT_FALSE(tap.metrics.settled);
  EXPECT_EQ(tap.metrics.contacts, 0);
  EXPECT_EQ(tap.metrics.peak_force_N, 0.0);
  EXPECT_EQ(tap.metrics.settling_time_s, params.task.observation_s);
}

TEST(TappingEnsemble, ATapThatLeavesTheWorkspaceEndsThereAndHasDiverged) {
  TappingParams params = default_params();
  params.task.taps = 1;
  params.environment.position_m = 0.998;
  params.task.shallowest_m = params.task.deepest_m = 0.01;
  Trace trace;
  const TapResult tap = made(params).run(0, &trace);
  EXPECT_TRUE(tap.diverged);
  EXPECT_FALSE(tap.metrics.settled);
  EXPECT_EQ(tap.metrics.settling_time_s, params.task.observation_s);
  EXPECT_GE(trace.back().master_position_m, 1.0);
  EXPECT_LT(trace[trace.size() - 2].master_position_m, 1.0);
}

TEST(TappingEnsemble, ATapWithATraceGoesAsWithoutAndIsObservedForAsLongAsAsked) {
  TappingParams params = default_params();
  params.task.taps = 2;
  params.task.observation_s = 0.2;
  const TappingEnsemble ensemble = made(params);
  Trace trace;
  const TapResult with = ensemble.run(1, &trace);
  const TapResult without = ensemble.run(1);
  EXPECT_EQ(with.metrics.settling_time_s, without.metrics.settling_time_s);
  EXPECT_EQ(with.first_touch_s, without.first_touch_s);
  const auto first = std::find_if(trace.begin(), trace.end(), [](const auto& record) { return record.touched; });
  ASSERT_NE(first, trace.end());
  EXPECT_EQ(first->touched_at_s, with.first_touch_s);
  EXPECT_GE(with.first_touch_s, first->time_s);
  EXPECT_LE(with.first_touch_s, first->time_s + 2e-4);
  EXPECT_EQ(trace.end() - first, 1000);
  const auto contacts = std::count_if(trace.begin(), trace.end(), [](const auto& record) { return record.touched; });
  EXPECT_EQ(with.metrics.contacts, contacts);
}

TEST(TappingEnsemble, RefusesRangesThatAreTheWrongWayRound) {
  TappingParams params = default_params();
  params.task.fastest_m_per_s = 0.01;
  const auto speeds = TappingEnsemble::make(params);
  ASSERT_FALSE(speeds);
  EXPECT_EQ(describe(speeds.error()),
            "task.fastest_m_per_s: 0.01 is less than slowest_m_per_s, 0.04: raise one or lower the other");
  params = default_params();
  params.task.shallowest_m = 0.02;
  const auto depths = TappingEnsemble::make(params);
  ASSERT_FALSE(depths);
  EXPECT_EQ(depths.error().parameter, "task.deepest_m");
  EXPECT_EQ(depths.error().code, ErrorCode::inconsistent);
}

TEST(TappingEnsemble, ATremorAtTheEndOfItsBoundsIsFineHoweverItsDrawsFall) {
  for (const double frequency_Hz : {1.0, 30.0}) {
    TappingParams params = default_params();
    params.person.tremor_frequency_Hz = frequency_Hz;
    params.person.tremor_amplitude_m = 0.005;
    EXPECT_TRUE(TappingEnsemble::make(params)) << frequency_Hz;
  }
}

TapResult tap_of(std::optional<double> settling_time_s) {
  TapResult tap;
  tap.touched = true;
  tap.metrics.settled = settling_time_s.has_value();
  tap.metrics.settling_time_s = settling_time_s.value_or(0.35);
  return tap;
}

std::vector<TapResult> taps_of(std::size_t settled, std::size_t unsettled, double settling_time_s) {
  std::vector<TapResult> taps(settled, tap_of(settling_time_s));
  taps.insert(taps.end(), unsettled, tap_of(std::nullopt));
  return taps;
}

std::string verdict_of(const std::vector<TapResult>& taps) { return name_of(summarise(taps).verdict); }

TEST(TappingVerdict, IsWhatTheDefinitionsSayAtTheirEdges) {
  EXPECT_EQ(verdict_of(taps_of(20, 0, 0.05)), "settled");
  EXPECT_EQ(verdict_of(taps_of(19, 1, 0.05)), "settled");    // 95 %
  EXPECT_EQ(verdict_of(taps_of(18, 2, 0.05)), "ringing");    // 90 %
  EXPECT_EQ(verdict_of(taps_of(20, 0, 0.1)), "settled");     // within 100 ms
  EXPECT_EQ(verdict_of(taps_of(20, 0, 0.1002)), "ringing");  // later
  EXPECT_EQ(verdict_of(taps_of(10, 10, 0.05)), "ringing");   // half
  EXPECT_EQ(verdict_of(taps_of(9, 11, 0.05)), "limit-cycle");
  EXPECT_EQ(verdict_of(taps_of(0, 3, 0.05)), "limit-cycle");
}

TEST(TappingVerdict, OneDivergedTapDecides) {
  auto taps = taps_of(99, 1, 0.05);
  taps.back().diverged = true;
  EXPECT_EQ(verdict_of(taps), "diverged");
}

TEST(TappingSummary, TakesQuantilesOverTheTapsWithUnsettledOnesAtTheirWholeWindow) {
  std::vector<TapResult> taps{tap_of(0.06), tap_of(0.04), tap_of(std::nullopt), tap_of(0.05)};
  const double peak_N[] = {1.0, 4.0, 2.0, 8.0}, residual_N[] = {0.4, 0.1, 0.2, 0.3};
  const int contacts[] = {3, 6, 20, 4};
  for (std::size_t i = 0; i < 4; ++i) {
    taps[i].metrics.peak_force_N = peak_N[i];
    taps[i].metrics.residual_rms_N = residual_N[i];
    taps[i].metrics.contacts = contacts[i];
  }
  const TappingMetrics metrics = summarise(taps);
  EXPECT_EQ(metrics.taps, 4U);
  EXPECT_DOUBLE_EQ(metrics.settled_fraction, 0.75);
  EXPECT_DOUBLE_EQ(metrics.settling_time_median_s, 0.055);
  EXPECT_DOUBLE_EQ(metrics.settling_time_p90_s, 0.06 + 0.7 * 0.29);
  EXPECT_DOUBLE_EQ(metrics.contacts_median, 5.0);
  EXPECT_DOUBLE_EQ(metrics.peak_force_N, 3.0);
  EXPECT_DOUBLE_EQ(metrics.residual_rms_N, 0.25);
}

/// Taps of a hand that is nominal at rest and holds a quarter as firmly when it meets the wall.
double settled_share(control::OperatorEstimate estimate, double force_gain, double delay_s) {
  TappingParams params = default_params();
  params.task.taps = 16;
  params.control.force_gain = force_gain;
  params.channel.to_master.delay_s = delay_s;
  params.control.operator_estimate = estimate;
  params.person.grip_change.factor = 0.25;
  std::vector<TapResult> taps;
  const TappingEnsemble ensemble = made(params);
  for (std::size_t i = 0; i < ensemble.size(); ++i) taps.push_back(ensemble.run(i));
  return summarise(taps).settled_fraction;
}

TEST(Tapping, AGripThatGetsLighterFailsTheFixedModelAndNotTheOneThatFollowsIt) {
  for (const auto& [force_gain, delay_s, fixed_at_most] : {std::tuple{20.0, 0.0, 0.5}, {10.0, 0.005, 0.9}}) {
    EXPECT_LT(settled_share(control::OperatorEstimate::off, force_gain, delay_s), fixed_at_most) << force_gain;
    EXPECT_GT(settled_share(control::OperatorEstimate::online, force_gain, delay_s), 0.95) << force_gain;
    EXPECT_GT(settled_share(control::OperatorEstimate::scheduled, force_gain, delay_s), 0.95) << force_gain;
  }
}

TEST(MedianTap, IsTheOneInTheMiddleTheLowerOfTwoTheFirstOfEqualOnes) {
  EXPECT_EQ(median_tap({tap_of(0.06), tap_of(0.04), tap_of(0.05)}), 2U);
  EXPECT_EQ(median_tap({tap_of(0.06), tap_of(0.04), tap_of(std::nullopt), tap_of(0.05)}), 3U);
  EXPECT_EQ(median_tap({tap_of(0.05), tap_of(0.05), tap_of(0.05)}), 1U);
  EXPECT_EQ(median_tap({tap_of(0.05)}), 0U);
}

TappingMetrics metrics_of(const TappingParams& params) {
  const TappingEnsemble ensemble = made(params);
  std::vector<TapResult> taps;
  for (std::size_t i = 0; i < ensemble.size(); ++i) taps.push_back(ensemble.run(i));
  return summarise(taps);
}

TEST(Tapping, SupervisedSitesSettleAsBareOnesDo) {
  TappingParams params = default_params();
  const TappingMetrics bare = metrics_of(params);
  params.task.supervised = true;
  const TappingMetrics supervised = metrics_of(params);
  EXPECT_EQ(supervised.settled_fraction, bare.settled_fraction);
  EXPECT_NEAR(supervised.settling_time_median_s, bare.settling_time_median_s, 0.003);
  EXPECT_EQ(supervised.stopped, 0u);
  EXPECT_NE(supervised.peak_force_N, bare.peak_force_N) << "the sites were not supervised";
}

TEST(Tapping, ATapThatSupervisionStopsHasNotSettledAndTheSiteIsNamed) {
  TappingParams params = default_params();
  params.task.supervised = true;
  params.task.taps = 2;
  params.control.cancellation = control::CancellationMode::off;
  params.control.gate.energy = {.damp_above_J = 1e-4, .hold_above_J = 1e-3, .credit_J = 1e-4, .drain_W = 0.0};
  const TappingMetrics metrics = metrics_of(params);
  EXPECT_EQ(metrics.verdict, Verdict::stopped);
  EXPECT_EQ(metrics.stopped, 2u);
  EXPECT_EQ(metrics.settled_fraction, 0.0);
  EXPECT_EQ(metrics.stopped_by, (simulation::StoppedSite{control::SiteRole::master, control::SiteCause::energy}));
}

TEST(Tapping, WhatRunsBareRefusesSupervisedSites) {
  TappingParams params = default_params();
  EXPECT_FALSE(refuse_supervised(params, "it"));
  params.task.supervised = true;
  EXPECT_EQ(refuse_supervised(params, "it")->parameter, "task.supervised");
}

TEST(Tapping, TheSitesThatDriveADeviceComputeWithTheMismatchOfTheTask) {
  TappingParams params = default_params();
  params.servo.rate_Hz = 2500.0;
  params.channel.to_slave.delay_s = 0.02;
  params.task.mismatch = {.mass = 2.0, .linkage_stiffness = 0.5, .operator_damping = 3.0};
  const station::TeleoperatorParams sites = sites_of(params);
  EXPECT_EQ(sites.servo.rate_Hz, 2500.0);
  EXPECT_EQ(sites.channel.to_slave.delay_s, 0.02);
  const control::MasterModel &right = params.control.model, &wrong = sites.control.model;
  EXPECT_DOUBLE_EQ(wrong.motor.mass_kg, 2.0 * right.motor.mass_kg);
  EXPECT_DOUBLE_EQ(wrong.linkage.stiffness_N_per_m, 0.5 * right.linkage.stiffness_N_per_m);
  EXPECT_DOUBLE_EQ(wrong.hand.damping_N_s_per_m, 3.0 * right.hand.damping_N_s_per_m);
}

}  // namespace tapping_test
}  // namespace tactus::experiments
