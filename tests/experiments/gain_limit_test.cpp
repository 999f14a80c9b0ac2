// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/gain_limit.hpp>

#include <vector>

#include <gtest/gtest.h>

namespace tactus::experiments {
namespace gain_limit_test {

GainLimit limit_at(double threshold) {
  return find_gain_limit(0.25, 32.0, [threshold](double gain) { return gain <= threshold; });
}

TEST(GainLimit, IsWithinTwoPercentBelowTheThresholdWhereverThatLies) {
  for (double threshold = 0.26; threshold < 31.0; threshold *= 1.07) {
    const GainLimit limit = limit_at(threshold);
    EXPECT_LE(limit.gain, threshold);
    EXPECT_GE(limit.gain * 1.02, threshold);
    EXPECT_FALSE(limit.beyond_search);
  }
}

TEST(GainLimit, SaysSoWhenTheSearchEndsFirst) {
  EXPECT_EQ(limit_at(1e9).gain, 32.0);
  EXPECT_TRUE(limit_at(1e9).beyond_search);
  EXPECT_EQ(limit_at(0.1).gain, 0.0);
  EXPECT_FALSE(limit_at(0.1).beyond_search);
}

TEST(GainLimit, LiesBelowTheFirstGainThatFailsAlthoughHigherOnesSettleAgain) {
  const GainLimit limit = find_gain_limit(0.25, 32.0, [](double gain) { return gain < 2.0 || gain > 4.0; });
  EXPECT_LT(limit.gain, 2.0);
  EXPECT_GT(limit.gain, 2.0 / 1.02);
}

TEST(GainLimit, GainsTooLowToSettleDoNotHideWhatSettlesAboveThem) {
  EXPECT_NEAR(find_gain_limit(0.25, 32.0, [](double gain) { return gain > 0.5 && gain < 8.0; }).gain, 8.0, 0.16);
}

TEST(GainLimit, TriesOnlyGainsOfTheSearch) {
  std::vector<double> tried;
  find_gain_limit(2.0, 3.0, [&tried](double gain) {
    tried.push_back(gain);
    return true;
  });
  EXPECT_EQ(tried, (std::vector<double>{2.0, 2.0 * 1.4142135623730951, 3.0}));
}

}  // namespace gain_limit_test
}  // namespace tactus::experiments
