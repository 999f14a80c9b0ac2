// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/ticks.hpp>

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace tactus::report {
namespace ticks_test {

using Labels = std::vector<std::string>;
using Values = std::vector<double>;

TEST(LinearTicks, AreTheFinestOneTwoFiveStepsThatFit) {
  EXPECT_EQ(linear_ticks(0, 200, 5).major, (Values{0, 50, 100, 150, 200}));
  EXPECT_EQ(linear_ticks(0, 200, 4).major, (Values{0, 100, 200}));
  EXPECT_EQ(linear_ticks(0, 1, 11).major.size(), 11U);
  EXPECT_EQ(linear_ticks(0, 1, 10).labels, (Labels{"0.0", "0.2", "0.4", "0.6", "0.8", "1.0"}));
  EXPECT_EQ(linear_ticks(-2.13, 1.2, 4).labels, (Labels{"−2", "−1", "0", "1"}));
}

TEST(LinearTicks, AreTheNearestNumbersToTheirLabels) {
  const Ticks ticks = linear_ticks(0, 1, 11);
  EXPECT_EQ(ticks.major[3], 0.3);
  EXPECT_EQ(ticks.major[7], 0.7);
  EXPECT_EQ(linear_ticks(-0.1, 0.1, 3).labels, (Labels{"−0.1", "0.0", "0.1"}));
}

TEST(LinearTicks, TakeACommonPowerOfTenOutOfUnwieldyLabels) {
  const Ticks small = linear_ticks(0, 2e-5, 3);
  EXPECT_EQ(small.exponent, -6);
  EXPECT_EQ(small.labels, (Labels{"0", "10", "20"}));
  const Ticks large = linear_ticks(-1e6, 3e6, 5);
  EXPECT_EQ(large.exponent, 6);
  EXPECT_EQ(large.labels, (Labels{"−1", "0", "1", "2", "3"}));
  EXPECT_EQ(linear_ticks(0, 20000, 3).exponent, 0);
}

TEST(LinearTicks, StayInsideFewAndEvenForAnyLimits) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> mantissa(-1, 1);
  std::uniform_int_distribution<int> exponent(-250, 250);
  for (int run = 0; run < 2000; ++run) {
    const double a = mantissa(random) * std::pow(10.0, exponent(random));
    const double b = a + std::abs(mantissa(random) * a) + std::abs(a) * 1e-9;
    const int most = 2 + run % 9;
    const Ticks ticks = linear_ticks(a, b, most);
    ASSERT_LE(ticks.major.size(), static_cast<std::size_t>(most)) << a << " " << b;
    // The next finer step of the 1-2-5 series is at most 2.5 times finer and did not fit.
    ASSERT_GE(2.5 * static_cast<double>(ticks.major.size() + 1), most) << a << " " << b;
    ASSERT_EQ(ticks.labels.size(), ticks.major.size());
    for (const double value : ticks.major) {
      ASSERT_GE(value, a - 1e-6 * (b - a));
      ASSERT_LE(value, b + 1e-6 * (b - a));
    }
  }
}

TEST(LogarithmicTicks, AreDecadesWithNineSubdivisions) {
  const Ticks ticks = logarithmic_ticks(1, 1000, 8);
  EXPECT_EQ(ticks.labels, (Labels{"1", "10", "100", "1000"}));
  EXPECT_EQ(ticks.minor.size(), 3U * 8U);
  EXPECT_EQ(ticks.minor[0], 2.0);
  EXPECT_EQ(ticks.minor[23], 900.0);
}

TEST(LogarithmicTicks, UsePowersWherePlainNumbersWouldBeLong) {
  EXPECT_EQ(logarithmic_ticks(1e-6, 1e-3, 8).labels, (Labels{"10⁻⁶", "10⁻⁵", "10⁻⁴", "10⁻³"}));
  EXPECT_EQ(logarithmic_ticks(0.01, 10, 8).labels, (Labels{"0.01", "0.1", "1", "10"}));
}

TEST(LogarithmicTicks, AreThinnedWhenTheyAreMany) {
  const Ticks ticks = logarithmic_ticks(1, 1e12, 5);
  EXPECT_EQ(ticks.labels, (Labels{"10⁰", "10³", "10⁶", "10⁹", "10¹²"}));
  EXPECT_EQ(ticks.minor.size(), 8U);
}

TEST(LogarithmicTicks, AreFilledUpWhereDecadesAreFew) {
  EXPECT_EQ(logarithmic_ticks(4, 60, 8).labels, (Labels{"5", "10", "20", "50"}));
  EXPECT_EQ(logarithmic_ticks(3e-6, 2e-5, 8).labels, (Labels{"5×10⁻⁶", "10⁻⁵", "2×10⁻⁵"}));
  EXPECT_EQ(logarithmic_ticks(6, 9, 4).labels, (Labels{"6", "7", "8", "9"}));
}

struct Wish {
  std::optional<Limits> data;
  std::optional<double> lower, upper;
  bool logarithmic;
};

TEST(AxisLimits, GiveTheDataAirAndYieldToWhatIsSet) {
  const Limits free = axis_limits(Limits{0, 10}, {}, {}, false, 0.1);
  EXPECT_DOUBLE_EQ(free.lower, -1);
  EXPECT_DOUBLE_EQ(free.upper, 11);
  const Limits half = axis_limits(Limits{0, 10}, 2.0, {}, false, 0.1);
  EXPECT_DOUBLE_EQ(half.lower, 2);
  EXPECT_DOUBLE_EQ(half.upper, 10.8);
  const Limits decades = axis_limits(Limits{1, 100}, {}, {}, true, 0.5);
  EXPECT_NEAR(decades.lower, 0.1, 1e-12);
  EXPECT_NEAR(decades.upper, 1000, 1e-9);
}

TEST(AxisLimits, SpreadConstantAndMissingData) {
  const Limits constant = axis_limits(Limits{3, 3}, {}, {}, false, 0.1);
  EXPECT_DOUBLE_EQ(constant.lower, 1.5);
  EXPECT_DOUBLE_EQ(constant.upper, 4.5);
  const Limits zero = axis_limits(Limits{0, 0}, {}, {}, false, 0.1);
  EXPECT_DOUBLE_EQ(zero.lower, -1);
  EXPECT_DOUBLE_EQ(zero.upper, 1);
  const Limits nothing = axis_limits({}, {}, {}, true, 0.1);
  EXPECT_DOUBLE_EQ(nothing.lower, 1);
  EXPECT_DOUBLE_EQ(nothing.upper, 10);
}

TEST(AxisLimits, AreAlwaysUsable) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double largest = std::numeric_limits<double>::max();
  const std::vector<double> values{0,       -0.0,   1,       -1,       1 + 1e-16, 5e-324,
                                   -5e-324, 1e-290, largest, -largest, infinity,  nan};
  int checked = 0;
  for (const double a : values) {
    for (const double b : values) {
      for (const bool logarithmic : {false, true}) {
        std::vector<Wish> wishes{{{}, a, b, logarithmic}, {{}, a, {}, logarithmic}, {{}, {}, b, logarithmic}};
        if (std::isfinite(a) && std::isfinite(b) && a <= b && (!logarithmic || a > 0)) {
          for (Wish wish : std::vector<Wish>(wishes)) {
            wish.data = Limits{a, b};
            wishes.push_back(wish);
          }
          wishes.push_back({Limits{a, b}, {}, {}, logarithmic});
        }
        for (const Wish& wish : wishes) {
          const Limits limits = axis_limits(wish.data, wish.lower, wish.upper, logarithmic, 0.05);
          ASSERT_TRUE(std::isfinite(limits.upper - limits.lower)) << a << " " << b << " " << logarithmic;
          ASSERT_LT(limits.lower, limits.upper) << a << " " << b << " " << logarithmic;
          ASSERT_TRUE(!logarithmic || limits.lower > 0) << a << " " << b;
          const auto ticks = logarithmic ? logarithmic_ticks : linear_ticks;
          ASSERT_FALSE(ticks(limits.lower, limits.upper, 8).major.empty()) << a << " " << b << " " << logarithmic;
          ++checked;
        }
      }
    }
  }
  EXPECT_GT(checked, 800);
}

}  // namespace ticks_test
}  // namespace tactus::report
