// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/servo/duration_histogram.hpp>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::runtime {
namespace {

TEST(DurationHistogram, EveryDurationLiesWithinItsBucketWhichIsAtMostASixtyFourthWide) {
  std::mt19937_64 draw(1);
  for (int i = 0; i < 100'000; ++i) {
    const std::uint64_t value = draw() >> (24 + draw() % 40);
    const std::size_t bucket = DurationHistogram::bucket_of(value);
    ASSERT_LT(bucket, DurationHistogram::buckets);
    const std::uint64_t lower = DurationHistogram::lower_ns(bucket);
    const std::uint64_t upper = DurationHistogram::lower_ns(bucket + 1);
    ASSERT_LE(lower, value);
    ASSERT_GT(upper, value);
    ASSERT_LE(64 * (upper - lower), std::max<std::uint64_t>(lower, 64)) << value;
  }
}

TEST(DurationHistogram, QuantilesAgreeWithSortingToTheWidthOfABucket) {
  std::mt19937_64 draw(2);
  std::lognormal_distribution<double> duration_ns(9.0, 1.5);
  DurationHistogram histogram;
  std::vector<double> sorted;
  for (int i = 0; i < 50'000; ++i) {
    const auto value = static_cast<std::int64_t>(duration_ns(draw));
    histogram.add(value);
    sorted.push_back(static_cast<double>(value));
  }
  std::sort(sorted.begin(), sorted.end());
  for (const double q : {0.001, 0.1, 0.5, 0.9, 0.99, 0.999}) {
    const double expected = sorted[static_cast<std::size_t>(q * 50'000.0)];
    EXPECT_NEAR(histogram.quantile_ns(q), expected, expected / 50.0 + 1.0) << q;
  }
  EXPECT_EQ(static_cast<double>(histogram.least_ns()), sorted.front());
  EXPECT_EQ(static_cast<double>(histogram.largest_ns()), sorted.back());
  EXPECT_EQ(histogram.quantile_ns(1.0), sorted.back());
}

TEST(DurationHistogram, TwoAddedTogetherAreTheOneOfAllValues) {
  DurationHistogram left;
  DurationHistogram right;
  DurationHistogram both;
  for (std::int64_t value = 1; value < 1'000'000'000'000'000; value *= 3) {
    (value % 2 == 0 ? left : right).add(value);
    both.add(value);
  }
  left.add(right);
  EXPECT_EQ(left.count(), both.count());
  for (const double q : {0.0, 0.3, 0.9, 1.0}) EXPECT_EQ(left.quantile_ns(q), both.quantile_ns(q));
}

TEST(DurationHistogram, WithoutAValueEverythingIsZero) {
  const DurationHistogram empty;
  EXPECT_EQ(empty.count(), 0);
  EXPECT_EQ(empty.least_ns(), 0);
  EXPECT_EQ(empty.quantile_ns(0.5), 0.0);
}

TEST(DurationHistogram, ANegativeOrEndlessDurationIsKeptWithinTheBuckets) {
  DurationHistogram histogram;
  histogram.add(-5);
  histogram.add(INT64_MAX);
  EXPECT_EQ(histogram.count(), 2);
  EXPECT_EQ(histogram.least_ns(), 0);
  EXPECT_EQ(histogram.largest_ns(), INT64_MAX);
}

}  // namespace
}  // namespace tactus::runtime
