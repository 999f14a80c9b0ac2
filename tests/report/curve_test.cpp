// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/curve.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "markup.hpp"
#include <gtest/gtest.h>

namespace tactus::report {
namespace curve_test {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr Rectangle frame{10, 20, 100, 50};

TEST(Pixels, AreTenthsWithoutSuperfluousCharacters) {
  EXPECT_EQ(pixels(12.34), "12.3");
  EXPECT_EQ(pixels(-0.26), "-.3");
  EXPECT_EQ(pixels(7.0), "7");
  EXPECT_EQ(pixels(-0.04), "0");
  EXPECT_EQ(pixels(-12.96), "-13");
}

TEST(Thin, KeepsFirstLowestHighestAndLastOfAPixelColumnInOrder) {
  const auto kept = thin({{5.0, 1}, {5.1, 2}, {5.2, 9}, {5.3, 3}, {5.4, -4}, {5.5, 0}, {5.6, 1}, {6.0, 8}});
  const std::vector<double> expected{1, 9, -4, 1, 8};
  ASSERT_EQ(kept.size(), expected.size());
  for (std::size_t i = 0; i < kept.size(); ++i) EXPECT_EQ(kept[i].y, expected[i]);
}

TEST(Thin, LosesNoPeakAndNoBreakOfALongRecording) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise;
  std::vector<Point> points;
  for (int i = 0; i < 100'000; ++i) points.push_back({i * 0.0015, noise(random)});
  points[31'415].y = 40;
  points[71'828].y = -50;
  points[50'000].y = nan;
  const auto kept = thin(points);
  EXPECT_LE(kept.size(), 151U * 4U + 5U);
  for (int column = 0; column < 150; ++column) {
    const auto extremes = [&](const std::vector<Point>& from) {
      double low = 1e9;
      double high = -1e9;
      for (const Point& point : from) {
        if (std::floor(point.x) != column || std::isnan(point.y)) continue;
        low = std::min(low, point.y);
        high = std::max(high, point.y);
      }
      return std::pair(low, high);
    };
    EXPECT_EQ(extremes(kept), extremes(points)) << column;
  }
  EXPECT_EQ(std::count_if(kept.begin(), kept.end(), [](Point p) { return std::isnan(p.y); }), 1);
}

TEST(PathData, HoldsThePointsToATenthOfAPixel) {
  EXPECT_EQ(path_data({{20, 30}, {30.04, 25.26}, {40, 60}}, frame), "M20 30l10-4.7 10 34.7");
}

TEST(PathData, JoinsStraightRunsButNotReversals) {
  EXPECT_EQ(path_data({{20, 30}, {21, 30}, {22, 30}, {25, 30}, {23, 30}}, frame), "M20 30l5 0-2 0");
}

TEST(PathData, BreaksAtWhatIsNotFiniteAndDotsALonePoint) {
  const double infinity = std::numeric_limits<double>::infinity();
  const std::string data =
      path_data({{20, 30}, {30, 40}, {35, nan}, {40, 50}, {45, infinity}, {50, 30}, {60, 40}}, frame);
  EXPECT_EQ(data, "M20 30l10 10M40 50l0 0M50 30l10 10");
  EXPECT_EQ(path_data({{nan, nan}}, frame), "");
  EXPECT_EQ(path_data({}, frame), "");
}

TEST(PathData, EndsExactlyAtTheEdgeWhereALineLeavesTheFrame) {
  // From (60, 45) up with slope −1 to the upper edge y = 20 at x = 85; back in from the right edge x = 110 at y = 45.
  EXPECT_EQ(path_data({{60, 45}, {160, -55}}, frame), "M60 45l25-25");
  EXPECT_EQ(path_data({{135, 20}, {60, 95}}, frame), "M110 45l-25 25");
  EXPECT_EQ(path_data({{0, 0}, {5, 200}}, frame), "");
}

TEST(PathData, StaysInsideForDivergingData) {
  for (const double huge : {1e5, 1e12, 1e300, std::numeric_limits<double>::max()}) {
    const auto found = strokes(path_data({{20, 30}, {21, huge}, {22, -huge}, {23, huge}, {huge, 30}}, frame));
    ASSERT_FALSE(found.empty());
    for (const auto& stroke : found) {
      for (const Position& at : stroke) {
        EXPECT_GE(at.x, 10 - 1e-9);
        EXPECT_LE(at.x, 110 + 1e-9);
        EXPECT_GE(at.y, 20 - 1e-9);
        EXPECT_LE(at.y, 70 + 1e-9);
      }
    }
  }
}

}  // namespace curve_test
}  // namespace tactus::report
