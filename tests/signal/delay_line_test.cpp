// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/delay_line.hpp>

#include <vector>

#include <gtest/gtest.h>

namespace tactus::signal {
namespace delay_line_test {

struct Message {
  double position_m = 0.0;
  double force_N = 0.0;
};

static_assert(Element<DelayLine<double, 8>>);
static_assert(Element<DelayLine<Message, 8>>);

constexpr Seconds tick{200e-6};

TEST(DelayLine, GivesOutWhatCameInThatManyTicksAgoAndTheInitialValueBefore) {
  for (const int delay : {0, 1, 2, 7, 8}) {
    auto line = DelayLine<double, 8>::make({.delay_s = delay * tick.value}, tick, -1.0).value();
    EXPECT_EQ(line.delay_ticks(), static_cast<std::size_t>(delay));
    for (int n = 0; n < 50; ++n) {
      ASSERT_EQ(line.step(100.0 + n), n < delay ? -1.0 : 100.0 + n - delay) << "delay " << delay << ", tick " << n;
    }
  }
}

TEST(DelayLine, ResetForgetsWhatIsUnderWay) {
  auto line = DelayLine<double, 8>::make({.delay_s = 3 * tick.value}, tick, 0.5).value();
  for (int n = 0; n < 5; ++n) line.step(9.0);
  line.reset();
  for (int n = 0; n < 3; ++n) EXPECT_EQ(line.step(7.0), 0.5);
  EXPECT_EQ(line.step(7.0), 7.0);
}

TEST(DelayLine, CarriesWholeMessages) {
  auto line = DelayLine<Message, 4>::make({.delay_s = tick.value}, tick, {.position_m = 0.1, .force_N = 0.0}).value();
  EXPECT_EQ(line.step({.position_m = 1.0, .force_N = 2.0}).position_m, 0.1);
  EXPECT_EQ(line.step({}).force_N, 2.0);
}

TEST(DelayLine, RoundsToTheNearestTick) {
  using Line = DelayLine<double, 8>;
  EXPECT_EQ(Line::make({.delay_s = 0.49e-3}, tick)->delay_ticks(), 2U);
  EXPECT_EQ(Line::make({.delay_s = 0.51e-3}, tick)->delay_ticks(), 3U);
  EXPECT_EQ(Line::make({.delay_s = 0.0006}, tick)->delay_ticks(), 3U);
}

TEST(DelayLine, ADelayBeyondItsCapacityIsRefusedWithTheRemedy) {
  const auto refused = DelayLine<double, 8>::make({.delay_s = 0.01}, tick);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(describe(refused.error()),
            "delay_s: 0.01 s is 50 control cycles, and this delay line holds at most 8 (0.0016 s): shorten the delay "
            "or lengthen "
            "the control cycle");
  EXPECT_FALSE((DelayLine<double, 8>::make({.delay_s = 1e300}, tick).ok()));
}

}  // namespace delay_line_test
}  // namespace tactus::signal
