// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/mechanics/minimum_jerk.hpp>

#include <cmath>

#include <gtest/gtest.h>

namespace tactus::mechanics {
namespace minimum_jerk_test {

constexpr MinimumJerk reach{.start_m = 0.02, .end_m = -0.03, .start_time_s = 0.5, .duration_s = 0.4};
constexpr double stroke_m = -0.05;

/// The reach as a fraction of stroke and time, and its derivatives by central differences.
double fraction(double s) { return (reach.position_m(0.5 + 0.4 * s) - 0.02) / stroke_m; }
double slope(double s) { return (fraction(s + 1e-5) - fraction(s - 1e-5)) / 2e-5; }
double curvature(double s) { return (fraction(s + 1e-4) - 2.0 * fraction(s) + fraction(s - 1e-4)) / 1e-8; }

TEST(MinimumJerk, RestsAtItsStartBeforeAndAtItsEndAfter) {
  EXPECT_EQ(reach.position_m(-10.0), 0.02);
  EXPECT_EQ(reach.position_m(0.5), 0.02);
  EXPECT_DOUBLE_EQ(reach.position_m(0.9), -0.03);
  EXPECT_DOUBLE_EQ(reach.position_m(1e6), -0.03);
}

TEST(MinimumJerk, LeavesAndArrivesWithoutSpeedOrAcceleration) {
  for (const double s : {0.0, 1.0}) {
    EXPECT_NEAR(slope(s), 0.0, 1e-8);
    EXPECT_NEAR(curvature(s), 0.0, 1e-2);
  }
}

TEST(MinimumJerk, IsSymmetricAboutItsMiddle) {
  for (const double s : {0.0, 0.1, 0.25, 0.4, 0.5}) EXPECT_NEAR(fraction(s) + fraction(1.0 - s), 1.0, 1e-14);
}

TEST(MinimumJerk, PeaksHalfWayAtTheSpeedThatItsDurationWasAskedFor) {
  constexpr double peak_m_per_s = 0.15;
  const MinimumJerk timed{.end_m = 0.05, .duration_s = MinimumJerk::duration_for(0.05, peak_m_per_s)};
  const auto speed = [&](double s) {
    const double time_s = s * timed.duration_s;
    return (timed.position_m(time_s + 1e-6) - timed.position_m(time_s - 1e-6)) / 2e-6;
  };
  EXPECT_NEAR(speed(0.5), peak_m_per_s, 1e-8);
  for (const double s : {0.1, 0.3, 0.45, 0.55, 0.8}) EXPECT_LT(speed(s), 0.998 * peak_m_per_s);
}

/// ∫ (d³y/ds³)² ds of a path over [0, 1], by third differences: a trapezoid from the middle of the first difference to
/// that of the last, and the one and a half intervals beyond either, where the jerk is extrapolated.
template <class Path>
double squared_jerk(Path path) {
  constexpr int intervals = 2000;
  constexpr double ds = 1.0 / intervals;
  const auto jerk = [&](int i) {
    const double s = i * ds;
    return (path(s + 3 * ds) - 3.0 * path(s + 2 * ds) + 3.0 * path(s + ds) - path(s)) / (ds * ds * ds);
  };
  const auto square = [](double value) { return value * value; };
  constexpr int last = intervals - 3;
  double sum = -0.5 * (square(jerk(0)) + square(jerk(last)));
  for (int i = 0; i <= last; ++i) sum += square(jerk(i));
  sum += 1.5 * square(jerk(0) - 0.75 * (jerk(1) - jerk(0)));
  sum += 1.5 * square(jerk(last) + 0.75 * (jerk(last) - jerk(last - 1)));
  return sum * ds;
}

TEST(MinimumJerk, HasTheLeastSquaredJerkOfAllReachesBetweenRestAndRest) {
  // The minimum is 720 stroke² / duration⁵ (Euler-Poisson: the sixth derivative vanishes).
  const double least = squared_jerk(fraction);
  EXPECT_NEAR(least, 720.0, 0.1);
  for (const double amount : {-0.5, -0.1, 0.1, 0.5}) {
    for (const double skew : {0.0, 1.0}) {
      const auto other = [&](double s) {
        return fraction(s) + amount * std::pow(s * (1.0 - s), 3) * (1.0 - skew + skew * (s - 0.5));
      };
      EXPECT_GT(squared_jerk(other), least);
    }
  }
}

}  // namespace minimum_jerk_test
}  // namespace tactus::mechanics
