// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/diagnosis/following.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::diagnosis {
namespace following_test {

/// Forty seconds of motion up to `corner_Hz`; the follower comes `delay_s` later through a servo of second order.
Signals pair_of(double delay_s, double servo_Hz, double corner_Hz, double sample_time_s) {
  constexpr double step_s = 1e-3, two_pi = 6.283185307179586;
  signal::Random random(11);
  const auto count = static_cast<std::size_t>(40.0 / step_s);
  std::vector<double> leader(count);
  double a = 0.0, b = 0.0, c = 0.0;
  const double pass = 1.0 - std::exp(-two_pi * corner_Hz * step_s);
  for (double& x : leader) {
    a += pass * (random.normal() - a), b += pass * (a - b), c += pass * (b - c);
    x = 0.2 * c;
  }
  const double turns = two_pi * servo_Hz;
  double y = 0.0, v = 0.0;
  const auto late = static_cast<std::size_t>(std::lround(delay_s / step_s));
  const auto each = static_cast<std::size_t>(std::lround(sample_time_s / step_s));
  Signals signals{.channels = {}, .sample_time = Seconds{sample_time_s}, .samples = 0, .rotary = true};
  Channel of_leader{.name = "leader", .values = {}, .step = 1e-6},
      of_follower{.name = "follower", .values = {}, .step = 1e-6};
  for (std::size_t i = 0; i < count; ++i) {
    const double asked = leader[i - std::min(i, late)];
    for (int k = 0; k < 10; ++k) {
      v += 0.1 * step_s * (turns * turns * (asked - y) - 1.6 * turns * v);
      y += 0.1 * step_s * v;
    }
    if (i % each != 0) continue;
    of_leader.values.push_back(leader[i]);
    of_follower.values.push_back(y);
  }
  signals.samples = of_leader.values.size();
  signals.channels[0] = std::move(of_leader);
  signals.channels[1] = std::move(of_follower);
  return signals;
}

TEST(Following, FastMotionSeparatesAConstantDelayFromTheServo) {
  // A servo of 5 Hz with a damping of 0.8 lags by 1.6 / (2 pi 5 Hz) = 51 ms at low frequencies and has its -3 dB at 4.4
  // Hz.
  const auto found = find_following(pair_of(0.04, 5.0, 6.0, 2e-3));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->lag_s.value, 0.09, 0.015);
  ASSERT_TRUE(found->constant_s);
  EXPECT_NEAR(found->constant_s->value, 0.04, 0.006);
  EXPECT_LE(found->constant_s->lower, found->constant_s->value);
  ASSERT_TRUE(found->bandwidth_Hz) << text_of(*found, pair_of(0.04, 5.0, 6.0, 2e-3)) << found->moves_to_Hz;
  EXPECT_NEAR(*found->bandwidth_Hz, 4.4, 0.6);
}

TEST(Following, SlowMotionShowsTheLagAndNotItsSource) {
  const Signals signals = pair_of(0.03, 8.0, 0.3, 2e-3);
  const auto found = find_following(signals);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->lag_s.value, 0.062, 0.006);
  if (!found->constant_s) {
    EXPECT_NE(text_of(*found, signals).find("Lead faster"), std::string::npos) << text_of(*found, signals);
  } else {
    EXPECT_NEAR(found->constant_s->value, 0.03, 0.013);
  }
}

TEST(Following, ARecordingAt30HzStatesWhatItsRateAddsAndCannotShow) {
  const Signals signals = pair_of(0.03, 8.0, 0.5, 0.033);
  const auto found = find_following(signals);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->lag_s.value, 0.062, 0.012);
  const std::string text = text_of(*found, signals);
  EXPECT_NE(text.find("One sample is 33 ms"), std::string::npos) << text;
  EXPECT_NE(text.find("cannot be excluded"), std::string::npos) << text;
}

TEST(Following, PositionsThatDoNotMoveTogetherHaveNoLag) {
  Signals signals = pair_of(0.0, 8.0, 2.0, 2e-3);
  signal::Random random(2);
  double other = 0.0;
  for (double& y : signals.channels[1]->values) y = other += 0.01 * (random.normal() - other);
  EXPECT_FALSE(find_following(signals));
  signals.channels[1].reset();
  EXPECT_FALSE(find_following(signals));
}

}  // namespace following_test
}  // namespace tactus::diagnosis
