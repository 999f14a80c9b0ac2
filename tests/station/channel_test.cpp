// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/station/channel.hpp>

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::station {
namespace channel_test {

constexpr Seconds tick{1e-3};

Channel channel(const Channel::Params& params, const control::Message& initial = {}) {
  return Channel::make(params, tick, initial).value();
}

/// What arrives when tick k sends k + 1.
std::vector<Channel::Delivery> arrivals(Channel link, int ticks) {
  std::vector<Channel::Delivery> all;
  for (int k = 0; k < ticks; ++k) all.push_back(link.step({.position_m = k + 1.0}));
  return all;
}

TEST(Channel, WithoutDelayAMessageArrivesInTheTickThatSentIt) {
  for (const auto& [message, fresh, ago] : arrivals(channel({}), 1)) {
    EXPECT_EQ(message.position_m, 1.0);
    EXPECT_TRUE(fresh);
    EXPECT_EQ(ago, 0);
  }
}

TEST(Channel, ADelayOfNTicksShiftsEveryMessageByNAndTheInitialOneStandsInUntilThen) {
  const auto all = arrivals(channel({.delay_s = 0.007}, {.position_m = -5.0}), 100);
  for (int k = 0; k < 100; ++k) {
    const auto& arrival = all[static_cast<std::size_t>(k)];
    EXPECT_EQ(arrival.fresh, k >= 7) << k;
    EXPECT_EQ(arrival.fresh ? arrival.sent_ticks_ago : 7, 7) << k;
    EXPECT_EQ(arrival.message.position_m, k >= 7 ? k - 6.0 : -5.0) << k;
  }
}

TEST(Channel, NoMessageIsEverFollowedByAnOlderOneWhateverTheJitterAndLoss) {
  const Channel::Params params{.delay_s = 0.003, .jitter_s = 0.020, .loss_fraction = 0.3, .seed = 4};
  double newest = 0.0;
  int fresh = 0;
  int k = 0;
  for (const auto& arrival : arrivals(channel(params), 20000)) {
    if (arrival.fresh) {
      EXPECT_GT(arrival.message.position_m, newest);
      newest = arrival.message.position_m;
      const double age_ticks = k + 1.0 - newest;
      EXPECT_GE(age_ticks, 3.0);
      EXPECT_LE(age_ticks, 23.0);
      ++fresh;
    } else {
      EXPECT_EQ(arrival.message.position_m, newest);
    }
    ++k;
  }
  EXPECT_GT(fresh, 1000);
}

TEST(Channel, LosesTheShareThatItWasAskedTo) {
  int fresh = 0;
  for (const auto& arrival : arrivals(channel({.loss_fraction = 0.25}), 40000)) fresh += arrival.fresh ? 1 : 0;
  // Three standard deviations of a binomial count.
  EXPECT_NEAR(fresh, 30000, 3.0 * std::sqrt(40000 * 0.25 * 0.75));
}

TEST(Channel, ThatLosesEverythingDeliversNothing) {
  for (const auto& arrival : arrivals(channel({.loss_fraction = 1.0}, {.position_m = 2.0}), 100)) {
    EXPECT_FALSE(arrival.fresh);
    EXPECT_EQ(arrival.message.position_m, 2.0);
  }
}

TEST(Channel, TheSameSeedGivesTheSameLossAndAnotherSeedAnother) {
  const auto pattern = [](std::int64_t seed) {
    std::vector<bool> fresh;
    for (const auto& arrival : arrivals(channel({.loss_fraction = 0.5, .seed = seed}), 200)) {
      fresh.push_back(arrival.fresh);
    }
    return fresh;
  };
  EXPECT_EQ(pattern(1), pattern(1));
  EXPECT_NE(pattern(1), pattern(2));
}

}  // namespace channel_test
}  // namespace tactus::station
