// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/random.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <type_traits>
#include <vector>

#include "tests/oracle_table.hpp"
#include <gtest/gtest.h>

namespace tactus::signal {
namespace random_test {

static_assert(std::is_trivially_copyable_v<Random>);

std::vector<double> draw(std::size_t count, const std::function<double()>& next) {
  std::vector<double> numbers(count);
  std::generate(numbers.begin(), numbers.end(), next);
  return numbers;
}

/// Largest distance between the empirical distribution and `cumulative`, times √n (Kolmogorov and Smirnov): beyond 1.95
/// with a probability of 0.1 % for a sound generator, and the seed is fixed.
double kolmogorov_smirnov(std::vector<double> numbers, const std::function<double(double)>& cumulative) {
  std::sort(numbers.begin(), numbers.end());
  const auto n = static_cast<double>(numbers.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const double expected = cumulative(numbers[i]);
    const auto rank = static_cast<double>(i);
    largest = std::max({largest, expected - rank / n, (rank + 1.0) / n - expected});
  }
  return largest * std::sqrt(n);
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0) / static_cast<double>(a.size());
}

TEST(Random, GivesTheBitsThatTheGeneratorWrittenInPythonGives) {
  const OracleTable table("signal_random");
  for (const auto& [seed, column] : {std::pair{0U, "bits_of_seed_0"}, {42U, "bits_of_seed_42"}}) {
    Random random(seed);
    for (const std::uint64_t expected : table.column<std::uint64_t>(column)) ASSERT_EQ(random.bits(), expected);
  }
}

TEST(Random, GivesTheNormalNumbersOfThePlainRatioOfUniformsBitForBit) {
  Random random(42);
  for (const double expected : OracleTable("signal_random").column("normal_of_seed_42")) {
    ASSERT_EQ(random.normal(), expected);
  }
}

TEST(Random, NormalNumbersAreDistributedNormally) {
  Random random(3);
  const auto numbers = draw(200000, [&] { return random.normal(); });
  EXPECT_LT(kolmogorov_smirnov(numbers, [](double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }), 1.95);
  double fourth = 0.0;
  for (const double x : numbers) fourth += x * x * x * x / 200000.0;
  EXPECT_NEAR(correlation(numbers, numbers), 1.0, 0.01);
  EXPECT_NEAR(fourth, 3.0, 0.1);
}

TEST(Random, UniformNumbersFillTheirRangeEvenly) {
  Random random(4);
  const auto numbers = draw(200000, [&] { return random.uniform(-2.0, 3.0); });
  EXPECT_LT(kolmogorov_smirnov(numbers, [](double x) { return (x + 2.0) / 5.0; }), 1.95);
}

TEST(Random, UniformNumbersNeverReachTheUpperEnd) {
  Random random(5);
  const double upper = std::nextafter(1.0, 2.0);
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(random.uniform(1.0, upper), 1.0);
}

TEST(Random, AForkDoesNotDependOnHowMuchItsParentHasGivenOut) {
  Random parent(6);
  Random before = parent.fork(3);
  for (int i = 0; i < 17; ++i) parent.normal();
  Random after = parent.fork(3);
  for (int i = 0; i < 100; ++i) ASSERT_EQ(before.bits(), after.bits());
}

TEST(Random, ForksSeedsAndForksOfForksAreUncorrelated) {
  const Random root(7);
  const Random streams[] = {root,      root.fork(0),     root.fork(1), root.fork(0).fork(0), root.fork(0).fork(1),
                            Random(8), Random(8).fork(0)};
  constexpr std::size_t count = 100000;
  std::vector<std::vector<double>> numbers;
  for (Random stream : streams) numbers.push_back(draw(count, [&] { return stream.normal(); }));
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_LT(std::fabs(correlation(numbers[i], numbers[j])), 4.0 / std::sqrt(count)) << i << " and " << j;
    }
  }
}

}  // namespace random_test
}  // namespace tactus::signal
