// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/pace_check.hpp>

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

namespace tactus::control {
namespace pace_check_test {

constexpr Seconds tick{2e-4};

/// Own ticks until the check says something about another site whose clock runs at `pace` times the own, whose packets
/// are `delay` ticks old; `most` if it says nothing.
std::int64_t ticks_until(double pace, std::int64_t delay, std::int64_t most) {
  PaceCheck check = PaceCheck::make({}, tick).value();
  for (std::int64_t i = 0; i < most; ++i) {
    // The way is longer from the second tick on.
    const auto sent = static_cast<std::int64_t>(std::floor(pace * static_cast<double>(i))) - (i > 0 ? delay : 0);
    if (check.step({.following = true, .sequence = 1'000'000 + sent})) return i;
  }
  return most;
}

TEST(PaceCheck, ClocksThatDifferAsCrystalsDoAndWaysThatGrowSayNothing) {
  constexpr std::int64_t ten_minutes = 3'000'000;
  EXPECT_EQ(ticks_until(1.0 + 1e-3, 0, ten_minutes), ten_minutes);
  EXPECT_EQ(ticks_until(1.0 - 1e-3, 1400, ten_minutes), ten_minutes);
}

TEST(PaceCheck, AClockThatIsGrosslyWrongShowsAfterTheSlackOverWhatIsNotTolerated) {
  EXPECT_NEAR(static_cast<double>(ticks_until(0.5, 0, 100'000)) * tick.value, 0.3 / (0.5 - 0.25), 0.01);
  EXPECT_NEAR(static_cast<double>(ticks_until(2.0, 0, 100'000)) * tick.value, 0.3 / (1.0 - 0.25), 0.01);
}

TEST(PaceCheck, AClockThatWasRightForAnHourShowsNoLater) {
  PaceCheck check = PaceCheck::make({}, tick).value();
  std::int64_t sequence = 1, wrong_ticks = 0;
  for (int i = 0; i < 18'000'000; ++i) check.step({.following = true, .sequence = sequence++});
  while (!check.step({.following = true, .sequence = sequence}) && wrong_ticks < 100'000) {
    if (++wrong_ticks % 2 == 0) ++sequence;
  }
  EXPECT_NEAR(static_cast<double>(wrong_ticks) * tick.value, 0.3 / (0.5 - 0.25), 0.01);
}

TEST(PaceCheck, OwnTicksThatWereMissedCount) {
  PaceCheck check = PaceCheck::make({}, tick).value();
  std::int64_t sequence = 1;
  for (int i = 0; i < 1000; ++i)
    EXPECT_FALSE(check.step({.following = true, .sequence = sequence += 40, .elapsed_ticks = 40}));
  EXPECT_FALSE(check.step({.following = false, .sequence = 7}));
  EXPECT_FALSE(check.step({.following = true, .sequence = 9'000'000})) << "what was before is over";
}

}  // namespace pace_check_test
}  // namespace tactus::control
