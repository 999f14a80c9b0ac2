// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/force_gate.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace tactus::control {
namespace force_gate_test {

static_assert(Element<ForceGate>);

constexpr double tick_s = 200e-6;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

ForceGate gate(const ForceGate::Params& params) { return ForceGate::make(params, Seconds{tick_s}).value(); }

TEST(ForceGate, WhateverComesInWhatComesOutIsFiniteWithinTheLimitAndNoFasterThanTheRate) {
  constexpr double edges[] = {0.0,
                              -0.0,
                              infinity,
                              -infinity,
                              not_a_number,
                              1e308,
                              -1e308,
                              std::numeric_limits<double>::max(),
                              std::numeric_limits<double>::lowest(),
                              std::numeric_limits<double>::denorm_min(),
                              -std::numeric_limits<double>::denorm_min(),
                              std::numeric_limits<double>::min()};
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> fraction(0.0, 1.0);
  for (int run = 0; run < 300; ++run) {
    const ForceGate::Params params{.force_limit_N = 100.0 * (1.0 - fraction(engine)),
                                   .rate_limit_N_per_s = std::pow(10.0, 6.0 * (1.0 - fraction(engine)))};
    ForceGate element = gate(params);
    // In two runs of three nothing comes that would latch the fault for the rest of the run.
    const bool faults = run % 3 == 0;
    bool latched = false;
    double before = 0.0;
    for (int tick = 0; tick < 1000; ++tick) {
      double command = std::copysign(std::pow(10.0, -323.0 + 631.0 * fraction(engine)), fraction(engine) - 0.5);
      if (engine() % 3 == 0) command = 2.0 * params.force_limit_N * (2.0 * fraction(engine) - 1.0);
      if (engine() % 16 == 0) command = edges[engine() % std::size(edges)];
      if (!faults && !std::isfinite(command)) command = 0.0;
      latched = latched || !std::isfinite(command);
      const double passed = element.step(command);
      ASSERT_TRUE(std::isfinite(passed));
      ASSERT_LE(std::fabs(passed), params.force_limit_N);
      const double rate = params.rate_limit_N_per_s * tick_s;
      // After a fault it falls within the stop time, however slow the rate limit is.
      const double most = latched ? std::max(rate, params.force_limit_N / params.stop_time_s * tick_s) : rate;
      ASSERT_LE(std::fabs(passed - before), most * (1.0 + 1e-12) + 1e-14 * params.force_limit_N);
      ASSERT_EQ(element.fault(), latched ? GateFault::not_finite : GateFault::none);
      if (latched) {
        ASSERT_LE(std::fabs(passed), std::max(0.0, std::fabs(before) - 0.999999 * most));
      }
      before = passed;
    }
  }
}

TEST(ForceGate, PassesUnchangedWhatIsWithinBothLimits) {
  ForceGate element = gate({.force_limit_N = 2.0, .rate_limit_N_per_s = 1e4});
  for (int tick = 0; tick < 1000; ++tick) {
    const double command = 1.9 * std::sin(0.01 * tick);
    ASSERT_EQ(element.step(command), command);
  }
}

TEST(ForceGate, AStepBecomesARampOfTheRateLimitUpToTheForceLimit) {
  ForceGate element = gate({.force_limit_N = 1.0, .rate_limit_N_per_s = 500.0});
  for (int tick = 1; tick <= 20; ++tick) EXPECT_NEAR(element.step(50.0), std::min(1.0, 0.1 * tick), 1e-12);
  for (int tick = 1; tick <= 30; ++tick) EXPECT_NEAR(element.step(-50.0), std::max(-1.0, 1.0 - 0.1 * tick), 1e-12);
}

TEST(ForceGate, AFaultTakesTheForceToZeroAtTheRateLimitAndKeepsItThereUntilReset) {
  for (const double bad : {not_a_number, -not_a_number, infinity, -infinity}) {
    ForceGate element = gate({.force_limit_N = 1.0, .rate_limit_N_per_s = 500.0});
    for (int tick = 0; tick < 20; ++tick) element.step(0.8);
    EXPECT_NEAR(element.step(bad), 0.7, 1e-12);
    EXPECT_EQ(element.fault(), GateFault::not_finite);
    for (int tick = 2; tick <= 20; ++tick) EXPECT_NEAR(element.step(0.8), std::max(0.0, 0.8 - 0.1 * tick), 1e-12);
    EXPECT_EQ(element.step(0.8), 0.0);
    element.reset();
    EXPECT_EQ(element.fault(), GateFault::none);
    EXPECT_NEAR(element.step(0.05), 0.05, 1e-15);
  }
}

TEST(ForceGate, CannotBeConfiguredOff) {
  for (const double force_N : {100.1, 1e9, infinity, not_a_number, 0.0, -1.0}) {
    const auto made = ForceGate::make({.force_limit_N = force_N}, Seconds{tick_s});
    ASSERT_FALSE(made) << force_N;
    EXPECT_EQ(made.error().parameter, "force_limit_N");
  }
  for (const double rate : {1.1e6, infinity, not_a_number, 0.0, -1.0}) {
    const auto made = ForceGate::make({.rate_limit_N_per_s = rate}, Seconds{tick_s});
    ASSERT_FALSE(made) << rate;
    EXPECT_EQ(made.error().parameter, "rate_limit_N_per_s");
  }
  EXPECT_TRUE(ForceGate::make({.force_limit_N = 100.0, .rate_limit_N_per_s = 1e6}, Seconds{tick_s}));
}

}  // namespace force_gate_test
}  // namespace tactus::control
