// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/second_order_filter.hpp>
#include <tactus/simulation/experiments/tapping/figures.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "tests/default_experiment.hpp"
#include <gtest/gtest.h>

// What the rivals of cancellation do to a contact: the statements and the numbers of docs/theory/rivals.md.
namespace tactus::experiments {
namespace rivals_test {

using control::Shaping;
using Change = std::function<void(TappingParams&)>;

TappingParams tapping(double force_gain, const std::vector<Change>& changes) {
  TappingParams params = experiment_file<TappingParams>("tapping");
  params.control.cancellation = control::CancellationMode::off;
  params.control.force_gain = force_gain;
  for (const Change& change : changes) change(params);
  return params;
}

void cancellation(TappingParams& p) { p.control.cancellation = control::CancellationMode::on; }
Change damping(double damping_N_s_per_m) {
  return [=](TappingParams& p) { p.control.damping.damping_N_s_per_m = damping_N_s_per_m; };
}
Change command_filter(Shaping kind, double frequency_Hz) {
  return [=](TappingParams& p) { p.control.command_filter = {.kind = kind, .frequency_Hz = frequency_Hz}; };
}
Change force_filter(Shaping kind, double frequency_Hz) {
  return [=](TappingParams& p) { p.control.force_filter = {.kind = kind, .frequency_Hz = frequency_Hz}; };
}
Change crossover(double frequency_Hz) {
  return [=](TappingParams& p) { p.control.crossover.frequency_Hz = frequency_Hz; };
}
/// As if what the handle does never reached the motor.
void isolated(TappingParams& p) { p.master.handle_actuator.gain = 0.0; }
void no_near_limit(TappingParams& p) { p.control.force_limit_N = 10.0; }

Verdict verdict(double force_gain, const std::vector<Change>& changes) {
  const auto ensemble = TappingEnsemble::make(tapping(force_gain, changes)).value();
  std::vector<TapResult> taps;
  for (std::size_t tap = 0; tap < ensemble.size(); ++tap) taps.push_back(ensemble.run(tap));
  return summarise(taps).verdict;
}

TEST(Rivals, EachAloneSettlesAtTwiceTheGainAtWhichPlainContactDoes) {
  EXPECT_EQ(verdict(1.0, {}), Verdict::settled);
  EXPECT_EQ(verdict(2.0, {}), Verdict::limit_cycle);
  for (const auto& [name, rival] : {std::pair{"damping", damping(10.0)},
                                    {"command low-pass", command_filter(Shaping::low_pass, 30.0)},
                                    {"command notch", command_filter(Shaping::notch, 75.0)},
                                    {"force low-pass", force_filter(Shaping::low_pass, 30.0)},
                                    {"force notch", force_filter(Shaping::notch, 75.0)},
                                    {"crossover", crossover(30.0)}}) {
    EXPECT_EQ(verdict(2.0, {rival}), Verdict::settled) << name;
    EXPECT_EQ(verdict(2.0, {rival, no_near_limit}), Verdict::settled) << name;
  }
}

TEST(Rivals, WhatTheHandleLeaksThroughTheLinkageCostsTheCrossoverItsGainUntilTheCommandIsFilteredToo) {
  EXPECT_EQ(verdict(5.0, {crossover(30.0)}), Verdict::limit_cycle);
  EXPECT_EQ(verdict(5.0, {crossover(30.0), isolated}), Verdict::settled);
  EXPECT_EQ(verdict(5.0, {crossover(30.0), command_filter(Shaping::low_pass, 30.0)}), Verdict::settled);
  EXPECT_EQ(verdict(5.0, {crossover(30.0), cancellation}), Verdict::limit_cycle) << "no part of the model";
}

TEST(Rivals, CancellationWithASecondRemedySettlesWhereNeitherAloneDoes) {
  EXPECT_NE(verdict(15.0, {cancellation, no_near_limit}), Verdict::settled);
  for (const auto& [name, rival] :
       {std::pair{"damping", damping(5.0)}, {"command notch", command_filter(Shaping::notch, 75.0)}}) {
    EXPECT_NE(verdict(15.0, {rival, no_near_limit}), Verdict::settled) << name;
    EXPECT_EQ(verdict(15.0, {cancellation, rival, no_near_limit}), Verdict::settled) << name;
  }
}

/// How much of the contact transient, above 20 Hz and in the first 50 ms, the two actuators command.
struct Shown {
  double share = 0.0;          ///< RMS of what they command over RMS of force gain times contact force
  double error = 0.0;          ///< RMS of the difference, over the same
  double free_motion_N = 0.0;  ///< largest force of the motor before first touch
};

Shown shown(const std::vector<Change>& changes) {
  // At this gain nothing saturates and everything settles.
  const TappingParams params = tapping(0.5, changes);
  const auto ensemble = TappingEnsemble::make(params).value();
  const double tick_s = 1.0 / params.servo.rate_Hz;
  const auto above_20_Hz =
      signal::SecondOrderFilter::make({.kind = signal::FilterKind::high_pass, .frequency_Hz = 20.0}, Seconds{tick_s})
          .value();
  Shown result;
  double felt = 0.0, meant = 0.0, wrong = 0.0;
  for (std::size_t tap = 0; tap < ensemble.size(); ++tap) {
    std::vector<simulation::Teleoperator::Record> trace;
    const double touch_s = ensemble.run(tap, &trace).first_touch_s;
    auto felt_filter = above_20_Hz, meant_filter = above_20_Hz;
    // The contact between ticks i and i + 1 is measured at i + 1 and displayed at i + 2.
    for (std::size_t i = 0; i + 2 < trace.size(); ++i) {
      const double felt_N = felt_filter.step(trace[i + 2].displayed_force_N - trace[i + 2].handle_force_N);
      const double meant_N = meant_filter.step(params.control.force_gain * trace[i].contact_force_N);
      const double since_touch_s = trace[i].time_s - touch_s;
      if (since_touch_s < 0.0) {
        result.free_motion_N = std::max(result.free_motion_N, std::fabs(trace[i].displayed_force_N));
      } else if (since_touch_s < 0.05) {
        felt += felt_N * felt_N;
        meant += meant_N * meant_N;
        wrong += (felt_N - meant_N) * (felt_N - meant_N);
      }
    }
  }
  result.share = std::sqrt(felt / meant);
  result.error = std::sqrt(wrong / meant);
  return result;
}

void expect_shown(const char* name, double share, double error, double free_motion_N,
                  const std::vector<Change>& changes) {
  const Shown measured = shown(changes);
  EXPECT_NEAR(measured.share, share, 0.01) << name;
  EXPECT_NEAR(measured.error, error, 0.01) << name;
  EXPECT_NEAR(measured.free_motion_N, free_motion_N, 0.01) << name;
}

TEST(Rivals, TheForceFilterDullsTheTransientTheCrossoverSavesItAndDampingPushesInFreeMotion) {
  expect_shown("plain", 1.00, 0.21, 0.00, {});
  expect_shown("cancellation", 1.00, 0.21, 0.00, {cancellation});
  expect_shown("damping 2 N s/m", 0.95, 0.24, 0.16, {damping(2.0)});
  expect_shown("damping 5 N s/m", 0.95, 0.36, 0.38, {damping(5.0)});
  expect_shown("damping 10 N s/m", 1.03, 0.62, 0.69, {damping(10.0)});
  expect_shown("command low-pass 30 Hz", 1.00, 0.21, 0.00, {command_filter(Shaping::low_pass, 30.0)});
  expect_shown("command notch 75 Hz", 1.00, 0.21, 0.00, {command_filter(Shaping::notch, 75.0)});
  expect_shown("force low-pass 30 Hz", 0.24, 1.08, 0.00, {force_filter(Shaping::low_pass, 30.0)});
  expect_shown("force low-pass 100 Hz", 0.56, 1.06, 0.00, {force_filter(Shaping::low_pass, 100.0)});
  expect_shown("force notch 75 Hz", 0.85, 0.49, 0.00, {force_filter(Shaping::notch, 75.0)});
  expect_shown("crossover 30 Hz", 1.00, 0.21, 0.00, {crossover(30.0)});
}

/// One tap, tick by tick.
std::vector<simulation::Teleoperator::Record> trace_of(const std::vector<Change>& changes) {
  std::vector<simulation::Teleoperator::Record> trace;
  TappingEnsemble::make(tapping(0.5, changes)).value().run(0, &trace);
  return trace;
}

TEST(Teleoperator, TheHandlesActuatorMovesTheMasterFromItsFirstForceOn) {
  const auto quiet = [](TappingParams& p) {
    p.slave.force_sensor.noise_rms_N = 0.0;
    p.master.encoder.resolution_m = 0.0;
  };
  const auto moved = trace_of({crossover(30.0), quiet}), still = trace_of({crossover(30.0), quiet, isolated});
  const auto first = std::find_if(moved.begin(), moved.end(), [](const auto& r) { return r.handle_force_N != 0.0; });
  ASSERT_NE(first, moved.end());
  const auto tick = static_cast<std::size_t>(first - moved.begin());
  for (std::size_t i = 0; i <= tick; ++i) ASSERT_EQ(moved[i].master_position_m, still[i].master_position_m);
  EXPECT_LT(moved[tick].handle_force_N, 0.0) << "the wall pushes the hand back";
  EXPECT_LT(moved[tick + 10].master_position_m, still[tick + 10].master_position_m);
}

TEST(TappingFigures, TheForceOfTheHandlesActuatorIsShownWhereThereIsOne) {
  const auto force_lines = [](const std::vector<Change>& changes) {
    TappingRun run;
    run.trace = trace_of(changes);
    return tapping_figures({run}).front().panels.front().lines;
  };
  EXPECT_EQ(force_lines({}).size(), 1U);
  EXPECT_EQ(force_lines({crossover(30.0), isolated}).size(), 2U);
}

}  // namespace rivals_test
}  // namespace tactus::experiments
