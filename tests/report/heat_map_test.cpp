// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/heat_map.hpp>
#include <tactus/data/report/page.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>

#include "tests/report/markup.hpp"
#include <gtest/gtest.h>

namespace tactus::report {
namespace heat_map_test {

/// 3 by 4 cells, the middle row of class 1 but for its first cell, the rest of class 0.
HeatMap small_map() {
  return {.title = "Small <map>",
          .x = {.label = "stiffness", .unit = "N/m", .values = {1e3, 1e4, 1e5, 1e6}, .logarithmic = true},
          .y = {.label = "gain", .values = {1.0, 2.0, 3.0}},
          .classes = {{"calm", "#00ff00", "#003300"}, {"wild", "#ff0000", "#330000"}, {"absent", "#0000ff", "#000033"}},
          .panels = {{"one", {0, 0, 0, 0, 0, 1, 1, 1, 0, 0, 0, 0}}},
          .lines = {{.name = "boundary", .y = {3.0, 1.0, std::numeric_limits<double>::quiet_NaN(), 99.0}}}};
}

/// The area of all rectangles `M x y H x V y H x z` of a path, in square pixels.
double area_of(const std::string& data) {
  std::string numbers = data;
  int rectangles = 0;
  for (char& c : numbers) {
    rectangles += c == 'M' ? 1 : 0;
    if (std::string("MHVz").find(c) != std::string::npos) c = ' ';
  }
  std::istringstream in(numbers);
  double area = 0.0;
  for (int i = 0; i < rectangles; ++i) {
    std::array<double, 5> at{};
    for (double& value : at) in >> value;
    area += std::fabs((at[2] - at[0]) * (at[3] - at[1]));
  }
  return area;
}

TEST(HeatMap, EachClassCoversItsShareOfTheCells) {
  const std::string svg = to_svg(small_map());
  EXPECT_EQ(fault_of(svg), "");
  const double frame = 400.0 * 300.0;
  const auto cells = [&](const char* colour) {
    const auto found = tags(svg, "path", colour);
    return found.empty() ? 0.0 : area_of(attribute(found.front(), "d"));
  };
  EXPECT_NEAR(cells("cells-00ff00"), frame * 9.0 / 12.0, 30.0);
  EXPECT_NEAR(cells("cells-ff0000"), frame * 3.0 / 12.0, 30.0);
  EXPECT_EQ(cells("cells-0000ff"), 0.0);
}

TEST(HeatMap, OnADarkPageItsCellsAndItsGroundAreDark) {
  const std::string svg = to_svg(small_map());
  const std::size_t dark = svg.find("@media screen and (prefers-color-scheme:dark){\n");
  ASSERT_NE(dark, std::string::npos);
  EXPECT_NE(svg.find(".cells-00ff00-003300{fill:#003300}", dark), std::string::npos);
  EXPECT_LT(svg.find(".cells-00ff00-003300{fill:#00ff00}"), dark);
  EXPECT_EQ(svg.find("fill=\"#fff"), std::string::npos) << "a ground that stays white";
}

TEST(HeatMap, NamesAxesWithUnitsAndOnlyClassesThatThereAre) {
  const std::string svg = to_svg(small_map());
  EXPECT_NE(svg.find(">stiffness"), std::string::npos);
  EXPECT_NE(svg.find("(N/m)<"), std::string::npos);
  EXPECT_NE(svg.find(">gain<"), std::string::npos);
  EXPECT_NE(svg.find(">wild<"), std::string::npos);
  EXPECT_NE(svg.find(">boundary<"), std::string::npos);
  EXPECT_EQ(svg.find("absent"), std::string::npos);
  EXPECT_NE(svg.find("Small &lt;map&gt;"), std::string::npos);
}

TEST(HeatMap, AShortLogarithmicAxisIsLabelledInStepsOfOneTwoAndFive) {
  HeatMap map = small_map();
  map.y = {.label = "gain", .values = {0.5, 4.0, 32.0}, .logarithmic = true};
  map.lines.clear();
  const std::string svg = to_svg(map);
  for (const char* label : {">0.5<", ">1<", ">2<", ">5<", ">10<", ">20<", ">50<"}) {
    EXPECT_NE(svg.find(label), std::string::npos) << label;
  }
  EXPECT_EQ(svg.find(">100<"), std::string::npos);
}

TEST(HeatMap, ItsSizeFollowsThePatternAndNotTheNumberOfCells) {
  HeatMap map = small_map();
  map.lines.clear();
  map.x.values.clear();
  map.y.values.clear();
  for (int i = 1; i <= 400; ++i) map.x.values.push_back(i);
  for (int i = 1; i <= 300; ++i) map.y.values.push_back(i);
  map.x.logarithmic = false;
  map.panels[0].cells.assign(400 * 300, 0);
  for (std::size_t row = 100; row < 200; ++row) map.panels[0].cells[row * 400 + 7] = 1;
  EXPECT_LT(to_svg(map).size(), 6000U);
}

TEST(HeatMap, AThirdPanelStandsInTheRowAndAFourthBelow) {
  HeatMap map = small_map();
  const double one_row = draw(map).height_px;
  map.panels.resize(3, map.panels[0]);
  EXPECT_EQ(draw(map).height_px, one_row);
  map.panels.push_back(map.panels[0]);
  EXPECT_GT(draw(map).height_px, 1.5 * one_row);
  EXPECT_EQ(fault_of(to_svg(map)), "");
}

TEST(HeatMap, APageNumbersItAmongItsFigures) {
  Page page("Title");
  page.figure(small_map(), "What it shows.");
  const std::string html = page.to_html();
  EXPECT_NE(html.find("Figure 1. Small &lt;map&gt;."), std::string::npos);
  EXPECT_NE(html.find("What it shows."), std::string::npos);
}

}  // namespace heat_map_test
}  // namespace tactus::report
