// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/architectures/time_domain_passivity.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/default_experiment.hpp"
#include <gtest/gtest.h>

// The architectures that are passive over a delay, in the tapping loop: docs/theory/passivity.md.
namespace tactus::experiments {
namespace passive_architectures_test {

TappingParams delayed(const std::string& architecture, double delay_s) {
  auto params = experiment_file<TappingParams>("tapping");
  params.control.architecture = architecture;
  params.control.cancellation = control::CancellationMode::off;
  params.control.force_gain = 3.0;
  params.channel.to_slave.delay_s = params.channel.to_master.delay_s = delay_s;
  params.task.observation_s = 0.6;
  params.task.taps = 8;
  return params;
}

struct Series {
  TappingMetrics metrics;
  bool finite = true;
  double displayed_N = 0.0;  ///< largest, over all taps
};

Series run(const TappingParams& params) {
  const auto ensemble = TappingEnsemble::make(params);
  EXPECT_TRUE(ensemble) << (ensemble ? "" : describe(ensemble.error()));
  std::vector<TapResult> taps;
  Series result;
  for (std::size_t i = 0; i < ensemble->size(); ++i) {
    std::vector<simulation::Teleoperator::Record> trace;
    taps.push_back(ensemble->run(i, &trace));
    for (const auto& record : trace) {
      result.finite = result.finite && std::isfinite(record.master_position_m) &&
                      std::isfinite(record.slave_position_m) && std::isfinite(record.displayed_force_N);
      result.displayed_N = std::max(result.displayed_N, record.displayed_force_N);
    }
  }
  result.metrics = summarise(taps);
  return result;
}

class PassiveArchitecture : public ::testing::TestWithParam<std::string> {};

TEST_P(PassiveArchitecture, SettlesOnTheWallWithForceInTheHandWhateverTheDelay) {
  for (const double delay_s : {0.005, 0.02, 0.1}) {
    const Series result = run(delayed(GetParam(), delay_s));
    EXPECT_TRUE(result.finite) << delay_s;
    EXPECT_EQ(result.metrics.verdict, Verdict::settled) << delay_s;
    EXPECT_GT(result.displayed_N, 0.3) << delay_s << " s: passive because there is no force is no art";
  }
}

TEST_P(PassiveArchitecture, StaysFiniteAndOnTheWallOverALineThatReordersAndLoses) {
  TappingParams params = delayed(GetParam(), 0.02);
  for (auto* way : {&params.channel.to_slave, &params.channel.to_master}) {
    way->jitter_s = 0.005;
    way->loss_fraction = 0.3;
  }
  const Series result = run(params);
  EXPECT_TRUE(result.finite);
  EXPECT_NE(result.metrics.verdict, Verdict::diverged);
  EXPECT_GE(result.metrics.settled_fraction, 0.9);
  EXPECT_GT(result.displayed_N, 0.3);
}

INSTANTIATE_TEST_SUITE_P(Delayed, PassiveArchitecture,
                         ::testing::Values("wave-variables", "time-domain-passivity", "energy-tank"));

/// Force shown to the hand and force at the wall in N, means over the last 100 ms of all taps, at a gain of 1.
struct Press {
  double shown_N = 0.0;
  double contact_N = 0.0;
};

Press press(const std::string& architecture, double delay_s) {
  TappingParams params = delayed(architecture, delay_s);
  params.control.force_gain = 1.0;
  params.control.force_limit_N = 5.0;
  params.task.taps = 32;
  const auto ensemble = TappingEnsemble::make(params).value();
  constexpr std::size_t ticks = 500;
  Press sum;
  for (std::size_t i = 0; i < ensemble.size(); ++i) {
    std::vector<simulation::Teleoperator::Record> trace;
    ensemble.run(i, &trace);
    for (std::size_t k = trace.size() - ticks; k < trace.size(); ++k) {
      sum.shown_N += trace[k].displayed_force_N;
      sum.contact_N += trace[k].contact_force_N;
    }
  }
  const auto samples = static_cast<double>(ticks * ensemble.size());
  return {sum.shown_N / samples, sum.contact_N / samples};
}

TEST(PassiveArchitectures, ShowTheForcesOfThePageOnPassivity) {
  struct Row {
    const char* architecture;
    double delay_s, shown_N, contact_N;
  };
  for (const Row& row : {Row{"wave-variables", 0.0, 0.475, 0.454}, Row{"wave-variables", 0.02, 0.380, 0.369},
                         Row{"wave-variables", 0.1, 0.269, 0.180}, Row{"time-domain-passivity", 0.0, 0.453, 0.477},
                         Row{"time-domain-passivity", 0.02, 0.318, 0.462},
                         Row{"time-domain-passivity", 0.1, 0.064, 0.249}, Row{"energy-tank", 0.0, 0.457, 0.457},
                         Row{"energy-tank", 0.02, 0.452, 0.456}, Row{"energy-tank", 0.1, 0.471, 0.383}}) {
    const Press measured = press(row.architecture, row.delay_s);
    EXPECT_NEAR(measured.shown_N, row.shown_N, 0.02) << row.architecture << " at " << row.delay_s << " s";
    EXPECT_NEAR(measured.contact_N, row.contact_N, 0.02) << row.architecture << " at " << row.delay_s << " s";
  }
}

TEST(PositionForce, RingsOverADelayThatThePassiveArchitecturesStand) {
  EXPECT_NE(run(delayed("position-force", 0.1)).metrics.verdict, Verdict::settled);
}

TEST(TimeDomainPassivity, WithoutDelayIsOnlyAsGoodAsTheLoadThatTheLineSees) {
  // A force sensor at the tip is no passive load of the commanded motion; the servo's force is.
  TappingParams params = delayed("time-domain-passivity", 0.0);
  EXPECT_LT(run(params).metrics.settled_fraction, 0.75);
  params.control.own<control::PassivityParams>().reflected_force = control::ReflectedForce::servo;
  EXPECT_EQ(run(params).metrics.verdict, Verdict::settled);
}

}  // namespace passive_architectures_test
}  // namespace tactus::experiments
