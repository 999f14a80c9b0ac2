// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/figure.hpp>

#include <limits>
#include <regex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::report {
namespace bars_test {

struct DrawnRectangle {
  double x, y, width, height;
};

std::vector<DrawnRectangle> rectangles(const std::string& svg, const std::string& style) {
  const std::regex pattern("<rect class=\"" + style +
                           "\" x=\"([^\"]*)\" y=\"([^\"]*)\" width=\"([^\"]*)\" height=\"([^\"]*)\"");
  std::vector<DrawnRectangle> found;
  for (std::sregex_iterator match(svg.begin(), svg.end(), pattern), end; match != end; ++match) {
    found.push_back({std::stod((*match)[1]), std::stod((*match)[2]), std::stod((*match)[3]), std::stod((*match)[4])});
  }
  return found;
}

Figure figure_of(Axis x, std::vector<Bars> bars) {
  Figure figure;
  figure.title = "Contest";
  figure.panels = {{.title = {},
                    .x = std::move(x),
                    .y = {.label = "", .categories = {"first", "second", "third"}},
                    .lines = {},
                    .rules = {},
                    .bars = std::move(bars)}};
  return figure;
}

Axis linear(double lower, double upper) { return {.label = "gain", .lower = lower, .upper = upper}; }

TEST(Bars, AreAsLongAsTheirValuesAndStandInTheOrderOfTheirNames) {
  const std::string svg = draw(figure_of(linear(0, 4), {{.name = "", .lengths = {4, 2, 1}}})).svg;
  const auto bars = rectangles(svg, "fill-0");
  const DrawnRectangle frame = rectangles(svg, "frame").front();
  ASSERT_EQ(bars.size(), 3U);
  EXPECT_NEAR(bars[0].width, frame.width, 0.1);
  EXPECT_NEAR(bars[1].width, frame.width / 2, 0.1);
  EXPECT_NEAR(bars[2].width, frame.width / 4, 0.1);
  EXPECT_LT(bars[0].y, bars[1].y);
  EXPECT_LT(bars[1].y, bars[2].y);
  for (const char* name : {">first<", ">second<", ">third<"}) EXPECT_NE(svg.find(name), std::string::npos);
}

TEST(Bars, BeginAtNoughtWhereTheAxisHasItAndAtTheLowerLimitOfALogarithm) {
  const std::string svg = draw(figure_of(linear(-2, 2), {{.name = "", .lengths = {1, -1, -2}}})).svg;
  const auto bars = rectangles(svg, "fill-0");
  const DrawnRectangle frame = rectangles(svg, "frame").front();
  const double zero = frame.x + frame.width / 2;
  EXPECT_NEAR(bars[0].x, zero, 0.1);
  EXPECT_NEAR(bars[1].x + bars[1].width, zero, 0.1);
  EXPECT_NEAR(bars[2].x, frame.x, 0.1);

  Axis decades = linear(0.1, 10);
  decades.scale = Axis::Scale::logarithmic;
  const auto logarithmic = rectangles(draw(figure_of(decades, {{.name = "", .lengths = {1, 10, 0}}})).svg, "fill-0");
  ASSERT_EQ(logarithmic.size(), 2U);
  EXPECT_NEAR(logarithmic[0].width, frame.width / 2, 0.1);
  EXPECT_NEAR(logarithmic[1].width, frame.width, 0.1);
}

TEST(Bars, OfSeveralSeriesShareTheHeightOfACategoryAndHaveALegendEach) {
  const std::string svg = draw(figure_of(linear(0, 4), {{.name = "weak", .lengths = {1, 1, 1}, .colour = 0},
                                                        {.name = "strong", .lengths = {2, 2, 2}, .colour = 1}}))
                              .svg;
  const auto weak = rectangles(svg, "fill-0");
  const auto strong = rectangles(svg, "fill-1");
  ASSERT_EQ(weak.size(), 4U);  // the legend's swatch too
  ASSERT_EQ(strong.size(), 4U);
  EXPECT_NEAR(weak[0].y + weak[0].height, strong[0].y, 0.11);
  EXPECT_NE(svg.find(">weak<"), std::string::npos);
  EXPECT_NE(svg.find("Shown: weak, strong."), std::string::npos);
}

TEST(Bars, ThatHaveNoLengthAreNotDrawnButTheirLabelIs) {
  const std::string svg = draw(figure_of(linear(0, 4), {{.name = "",
                                                         .lengths = {std::numeric_limits<double>::quiet_NaN(), 2, 3},
                                                         .labels = {"rings", "2 N", "3 N"}}}))
                              .svg;
  EXPECT_EQ(rectangles(svg, "fill-0").size(), 2U);
  for (const char* label : {">rings<", ">2 N<", ">3 N<"}) EXPECT_NE(svg.find(label), std::string::npos);
}

TEST(Bars, SetTheLimitsOfAnAxisThatHasNone) {
  const std::string svg = draw(figure_of({.label = "gain"}, {{.name = "", .lengths = {1, 2, 8}}})).svg;
  const auto bars = rectangles(svg, "fill-0");
  ASSERT_EQ(bars.size(), 3U);
  EXPECT_NEAR(bars[2].width, rectangles(svg, "frame").front().width, 0.1);
  EXPECT_NEAR(bars[0].width, bars[2].width / 8, 0.1);
}

}  // namespace bars_test
}  // namespace tactus::report
