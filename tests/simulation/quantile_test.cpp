// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/teleoperator/quantile.hpp>

#include <gtest/gtest.h>

namespace tactus::simulation {
namespace quantile_test {

// The expected values are what numpy.quantile (1.24, method 'linear') prints for the same lists.

TEST(Quantile, InterpolatesBetweenOrderStatisticsAsNumPyDoes) {
  const std::vector<double> values{8.0, 1.0, 4.0, 2.0};
  EXPECT_DOUBLE_EQ(quantile(values, 0.5), 3.0);
  EXPECT_DOUBLE_EQ(quantile(values, 0.9), 6.8);
  EXPECT_DOUBLE_EQ(quantile(values, 0.25), 1.75);
  EXPECT_DOUBLE_EQ(quantile(values, 1.0 / 3.0), 2.0);
  EXPECT_DOUBLE_EQ(quantile({-3.5, 0.25, 7.0, 7.0, 12.0, 100.0}, 0.37), 5.9875);
}

TEST(Quantile, TheEndsAreTheExtremes) {
  EXPECT_EQ(quantile({3.0, -1.0, 2.0}, 0.0), -1.0);
  EXPECT_EQ(quantile({3.0, -1.0, 2.0}, 1.0), 3.0);
}

TEST(Quantile, OfOneValueIsThatValue) {
  for (const double q : {0.0, 0.3, 0.5, 1.0}) EXPECT_EQ(quantile({4.25}, q), 4.25);
}

}  // namespace quantile_test
}  // namespace tactus::simulation
