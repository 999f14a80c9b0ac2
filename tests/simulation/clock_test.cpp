// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/teleoperator/clock.hpp>

#include <gtest/gtest.h>

namespace tactus::simulation {
namespace clock_test {

Clock made(double rate_Hz, double delay_s, double longest_step_s) {
  const auto clock =
      Clock::make({.rate_Hz = rate_Hz, .computation_delay_s = delay_s}, {.longest_step_s = longest_step_s});
  EXPECT_TRUE(clock) << (clock ? "" : describe(clock.error()));
  return *clock;
}

TEST(Clock, CutsATickThatIsAMultipleOfTheStepWithoutALeftover) {
  const Clock clock = made(5000.0, 20e-6, 10e-6);
  EXPECT_DOUBLE_EQ(clock.tick_s, 2e-4);
  EXPECT_EQ(clock.substeps, 20);
  EXPECT_DOUBLE_EQ(clock.substep_s, 1e-5);
  EXPECT_EQ(clock.late_substeps, 2);
  EXPECT_EQ(made(1000.0, 0.0, 1e-7).substeps, 10000);
  EXPECT_EQ(made(3000.0, 0.0, 1.0 / 30000.0).substeps, 10);
}

TEST(Clock, TakesEqualStepsNoLongerThanTheLongest) {
  const Clock clock = made(5000.0, 60e-6, 30e-6);
  EXPECT_EQ(clock.substeps, 7);  // 6.67 steps of 30 us
  EXPECT_DOUBLE_EQ(clock.substep_s * clock.substeps, clock.tick_s);
  EXPECT_EQ(clock.late_substeps, 2);  // 60 us is 2.1 of 28.6 us
}

TEST(Clock, AStepLongerThanATickIsOneStep) {
  const Clock clock = made(20000.0, 0.0, 100e-6);
  EXPECT_EQ(clock.substeps, 1);
  EXPECT_DOUBLE_EQ(clock.substep_s, 5e-5);
}

TEST(Clock, RoundsTheComputationDelayToTheNearestStep) {
  EXPECT_EQ(made(5000.0, 0.0, 10e-6).late_substeps, 0);
  EXPECT_EQ(made(5000.0, 4e-6, 10e-6).late_substeps, 0);
  EXPECT_EQ(made(5000.0, 16e-6, 10e-6).late_substeps, 2);
  EXPECT_EQ(made(5000.0, 190e-6, 10e-6).late_substeps, 19);
}

TEST(Clock, RefusesAComputationDelayOfATickOrMore) {
  // 196 us is less than a tick, but not once rounded to steps of 10 us.
  for (const double delay_s : {196e-6, 200e-6, 1e-3}) {
    const auto clock = Clock::make({.rate_Hz = 5000.0, .computation_delay_s = delay_s}, {.longest_step_s = 10e-6});
    ASSERT_FALSE(clock) << delay_s;
    EXPECT_EQ(clock.error().code, ErrorCode::inconsistent);
    EXPECT_EQ(clock.error().parameter, "servo.computation_delay_s");
    EXPECT_NE(clock.error().message.find("lower the rate"), std::string::npos);
  }
}

}  // namespace clock_test
}  // namespace tactus::simulation
