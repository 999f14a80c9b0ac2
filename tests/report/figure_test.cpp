// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/figure.hpp>

#include <algorithm>
#include <clocale>
#include <cmath>
#include <limits>
#include <locale>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "markup.hpp"
#include <gtest/gtest.h>

namespace tactus::report {
namespace figure_test {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double number_of(const std::string& tag, const char* name) { return std::stod(attribute(tag, name)); }

Axis axis(const char* label, const char* unit, double lower, double upper, Axis::Scale scale = Axis::Scale::linear) {
  return {.label = label, .unit = unit, .lower = lower, .upper = upper, .scale = scale};
}

Panel panel_of(Line line, Axis x, Axis y) {
  return {.title = {}, .x = x, .y = y, .lines = {std::move(line)}, .rules = {}};
}

Figure single(Panel panel) {
  Figure figure;
  figure.title = "Title";
  figure.panels = {std::move(panel)};
  return figure;
}

/// The grid of the tapping experiment: six gains, force above position, cancellation off above on.
Figure tapping(int samples) {
  Figure figure;
  figure.title = "Contact";
  figure.columns = 6;
  figure.share_x = figure.share_y = Sharing::by_quantity;
  figure.row_groups = {{"cancellation off", 2}, {"cancellation on", 2}};
  const char* const gains[] = {"1", "3", "5", "7", "10", "15"};
  for (const char* gain : gains) figure.column_titles.push_back(std::string("force gain ") + gain);
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 6; ++column) {
      const bool force = row % 2 == 0;
      Line line{.name = force ? "force" : "position", .x = {}, .y = {}, .colour = force ? 1 : 0};
      for (int i = 0; i < samples; ++i) {
        const double time_ms = 200.0 * i / samples;
        line.x.push_back(time_ms);
        line.y.push_back(std::min(1.0, (column + 1) * std::exp(-time_ms / 50) * std::sin(0.628 * time_ms)));
      }
      const Axis y = force ? axis("force on the hand", "N", -4.5, 1.5) : axis("position", "mm", -4.5, 1.5);
      Panel panel = panel_of(line, axis("time", "ms", 0, 200), y);
      panel.rules = {{.direction = Rule::Direction::vertical, .at = 20, .label = "contact"}};
      if (force) panel.rules.push_back({.direction = Rule::Direction::horizontal, .at = 1, .label = "force limit 1 N"});
      figure.panels.push_back(panel);
    }
  }
  return figure;
}

std::size_t count(const std::vector<std::string>& list, const std::string& text) {
  return static_cast<std::size_t>(std::count(list.begin(), list.end(), text));
}

TEST(Figure, MapsDataToPixelsLinearly) {
  const Line line{.name = "line", .x = {0, 50, 200}, .y = {-1, 0.5, 3}};
  const std::string svg = to_svg(single(panel_of(line, axis("t", "ms", 0, 200), axis("y", "mm", -1, 3))));
  const std::string frame = tags(svg, "rect", "frame").at(0);
  const double left = number_of(frame, "x");
  const double top = number_of(frame, "y");
  const double width = number_of(frame, "width");
  const double height = number_of(frame, "height");
  const auto found = strokes(attribute(tags(svg, "path", "colour-0").at(0), "d"));
  ASSERT_EQ(found.size(), 1U);
  ASSERT_EQ(found[0].size(), 3U);
  const double fractions[][2] = {{0, 0}, {0.25, 1.5 / 4}, {1, 1}};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(found[0][i].x, left + fractions[i][0] * width, 0.0501 + 0.05);
    EXPECT_NEAR(found[0][i].y, top + (1 - fractions[i][1]) * height, 0.0501 + 0.05);
  }
}

TEST(Figure, DrawsAUnitAsLongOnBothAxesWhereThatIsAskedFor) {
  const Line square{.name = "square", .x = {0, 10, 10}, .y = {5, 5, 15}};
  Panel panel = panel_of(square, {.label = "x", .unit = "mm"}, {.label = "z", .unit = "mm"});
  panel.equal_scales = true;
  const auto found = strokes(attribute(tags(to_svg(single(panel)), "path", "colour-0").at(0), "d"));
  ASSERT_EQ(found[0].size(), 3U);
  EXPECT_GT(found[0][1].x - found[0][0].x, 50.0);
  EXPECT_NEAR(found[0][1].x - found[0][0].x, found[0][1].y - found[0][2].y, 0.21);
}

TEST(Figure, MapsLogarithmicDataByDecadesAndBreaksWhereThereIsNoLogarithm) {
  const Line line{.name = "line", .x = {1, 10, 100, 300, 1000, 1000}, .y = {1, 1e-2, 1, 0, 1e-4, 1}};
  const std::string svg = to_svg(single(panel_of(line, axis("f", "Hz", 1, 1000, Axis::Scale::logarithmic),
                                                 axis("|x/F|", "m/N", 1e-4, 1, Axis::Scale::logarithmic))));
  const std::string frame = tags(svg, "rect", "frame").at(0);
  const auto found = strokes(attribute(tags(svg, "path", "colour-0").at(0), "d"));
  ASSERT_EQ(found.size(), 2U);
  EXPECT_NEAR(found[0][1].x, number_of(frame, "x") + number_of(frame, "width") / 3, 0.11);
  EXPECT_NEAR(found[0][1].y, number_of(frame, "y") + number_of(frame, "height") / 2, 0.11);
  EXPECT_NEAR(found[1][0].y, number_of(frame, "y") + number_of(frame, "height"), 0.11);
  const auto labels = texts(svg, "tick");
  for (const char* label : {"1", "10", "100", "1000"})
    EXPECT_EQ(count(labels, label), label[1] == '\0' ? 2U : 1U) << label;
}

TEST(Figure, BreaksALineAtNaN) {
  const Line line{.name = "line", .x = {0, 1, 2, 3, 4}, .y = {0, 1, nan, 1, 0}};
  const std::string svg = to_svg(single(panel_of(line, {.label = "t"}, {.label = "y"})));
  EXPECT_EQ(strokes(attribute(tags(svg, "path", "colour-0").at(0), "d")).size(), 2U);
}

TEST(Figure, ShowsASpikeOfOneSampleAmongAMillion) {
  Line line{.name = "line", .x = {}, .y = {}};
  for (int i = 0; i < 1'000'000; ++i) {
    line.x.push_back(i * 1e-6);
    line.y.push_back(i == 654'321 ? 1.0 : 0.0);
  }
  const std::string svg = to_svg(single(panel_of(line, axis("t", "s", 0, 1), axis("F", "N", 0, 1))));
  const double top = number_of(tags(svg, "rect", "frame").at(0), "y");
  double highest = 1e9;
  const auto found = strokes(attribute(tags(svg, "path", "colour-0").at(0), "d"));
  for (const Position& at : found.at(0)) highest = std::min(highest, at.y);
  EXPECT_NEAR(highest, top, 0.11);
  EXPECT_LT(svg.size(), 20'000U);
}

TEST(Figure, LabelsSharedAxesOnlyAtTheOuterPanels) {
  const std::string svg = to_svg(tapping(500));
  const auto labels = texts(svg, "tick");
  EXPECT_EQ(count(labels, "200"), 6U);  // the lowest row
  EXPECT_EQ(count(labels, "−2"), 4U);   // the first column
  const auto names = texts(svg, "name");
  EXPECT_EQ(count(names, "time\u00A0(ms)"), 1U);
  EXPECT_EQ(count(names, "position\u00A0(mm)"), 2U);
  EXPECT_EQ(count(names, "force on the"), 2U);  // broken to fit beside a low panel
  EXPECT_EQ(count(names, "hand\u00A0(N)"), 2U);
}

TEST(Figure, LabelsEveryPanelWhenNothingIsShared) {
  Figure figure = tapping(500);
  figure.share_x = figure.share_y = Sharing::none;
  const std::string svg = to_svg(figure);
  EXPECT_EQ(count(texts(svg, "tick"), "200"), 24U);
  EXPECT_EQ(count(texts(svg, "name"), "time\u00A0(ms)"), 24U);
}

TEST(Figure, GivesTheLinesOfARowOrColumnEqualLimits) {
  Figure figure;
  figure.columns = 2;
  figure.share_y = Sharing::in_line;
  const auto panel = [](double high) {
    return panel_of({.name = "", .x = {0, 1}, .y = {0, high}}, axis("t", "s", 0, 1), {.label = "y", .unit = "m"});
  };
  figure.panels = {panel(1), panel(4), panel(100), panel(1)};
  const std::string svg = to_svg(figure);
  const auto frames = tags(svg, "rect", "frame");
  const auto lines = tags(svg, "path", "colour-0");
  const auto rise = [&](std::size_t i) {
    const auto points = strokes(attribute(lines.at(i), "d")).at(0);
    return (points[0].y - points[1].y) / number_of(frames.at(i), "height");
  };
  EXPECT_NEAR(rise(1) / rise(0), 4, 0.02);
  EXPECT_NEAR(rise(2) / rise(3), 100, 10);  // one pixel high: rounding to a tenth shows
}

TEST(Figure, HasOneLegendEntryForEachNameAndRule) {
  const std::string svg = to_svg(tapping(500));
  const auto names = texts(svg, "name");
  for (const char* entry : {"force", "position", "contact", "force limit 1 N"})
    EXPECT_EQ(count(names, entry), 1U) << entry;
  EXPECT_EQ(tags(svg, "path", "rule-0").size(), 24U + 1U);
  EXPECT_EQ(tags(svg, "path", "rule-1").size(), 12U + 1U);
}

TEST(Figure, KeepsLegendTitlesAndPanelsWithinThePictureAndApart) {
  for (const auto place : {Figure::Legend::above, Figure::Legend::below}) {
    Figure figure = tapping(300);
    figure.legend = place;
    const std::string svg = to_svg(figure);
    std::istringstream box(attribute(tags(svg, "svg").at(0), "viewBox"));
    double x = 0;
    double y = 0;
    double width = 0;
    double height = 0;
    box >> x >> y >> width >> height;
    const auto frames = tags(svg, "rect", "frame");
    ASSERT_EQ(frames.size(), 24U);
    for (const std::string& text : tags(svg, "text")) {
      EXPECT_GT(number_of(text, "x"), 0);
      EXPECT_LT(number_of(text, "x"), width);
      EXPECT_GT(number_of(text, "y"), 0);
      EXPECT_LT(number_of(text, "y"), height);
      for (const std::string& frame : frames) {
        const double right = number_of(text, "x") - number_of(frame, "x");
        const double down = number_of(text, "y") - number_of(frame, "y");
        EXPECT_FALSE(right > 0 && right < number_of(frame, "width") && down > 0 && down < number_of(frame, "height"))
            << text;
      }
    }
    for (std::size_t i = 0; i < frames.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const double apart_x = std::abs(number_of(frames[i], "x") - number_of(frames[j], "x"));
        const double apart_y = std::abs(number_of(frames[i], "y") - number_of(frames[j], "y"));
        EXPECT_TRUE(apart_x > number_of(frames[i], "width") || apart_y > number_of(frames[i], "height"));
      }
    }
  }
}

TEST(Figure, SaysSoWhenThereIsNothingToDraw) {
  const std::string svg = to_svg(single(panel_of({.name = "line", .x = {}, .y = {}}, {.label = "t"}, {.label = "y"})));
  EXPECT_EQ(count(texts(svg, "tick"), "no data"), 1U);
  EXPECT_EQ(fault_of(svg), "");
  EXPECT_EQ(fault_of(to_svg(Figure{})), "");
}

TEST(Figure, DrawsConstantDataInTheMiddle) {
  const std::string svg =
      to_svg(single(panel_of({.name = "line", .x = {0, 1}, .y = {3, 3}}, {.label = "t"}, {.label = "y"})));
  const std::string frame = tags(svg, "rect", "frame").at(0);
  const auto points = strokes(attribute(tags(svg, "path", "colour-0").at(0), "d")).at(0);
  EXPECT_NEAR(points[0].y, number_of(frame, "y") + number_of(frame, "height") / 2, 0.11);
}

TEST(Figure, StaysReadableForDivergingData) {
  Line line{.name = "line", .x = {}, .y = {}};
  for (int i = 0; i < 2000; ++i) {
    line.x.push_back(i);
    line.y.push_back(std::pow(-2.0, i));
  }
  const std::string svg = to_svg(single(panel_of(line, {.label = "t"}, {.label = "y", .unit = "m"})));
  EXPECT_EQ(fault_of(svg), "");
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
  EXPECT_EQ(count(texts(svg, "name"), "y\u00A0(10³⁰⁰\u00A0m)"), 1U);
}

TEST(Figure, ShowsMarkupLiterallyEverywhere) {
  const std::string evil = "<script>\"&'</script>";
  Figure figure = single(
      panel_of({.name = evil, .x = {0, 1}, .y = {0, 1}}, {.label = evil, .unit = evil}, {.label = evil, .unit = evil}));
  figure.title = figure.caption = evil;
  figure.column_titles = {evil};
  figure.row_groups = {{evil, 1}};
  figure.panels[0].title = evil;
  figure.panels[0].rules = {{.direction = Rule::Direction::horizontal, .at = 0.5, .label = evil}};
  const std::string svg = to_svg(figure);
  EXPECT_EQ(fault_of(svg), "");
  EXPECT_EQ(svg.find("<script"), std::string::npos);
}

TEST(Figure, IsAccessibleAndStandsAlone) {
  Figure figure = tapping(300);
  figure.caption = "One tap for each gain.";
  const std::string svg = to_svg(figure);
  EXPECT_EQ(fault_of(svg), "");
  EXPECT_EQ(attribute(tags(svg, "svg").at(0), "role"), "img");
  EXPECT_NE(svg.find("<title>Contact</title>"), std::string::npos);
  EXPECT_NE(svg.find("<desc>One tap for each gain. Panels: 24. Shown: force, position.</desc>"), std::string::npos);
  EXPECT_NE(svg.find("prefers-color-scheme:dark"), std::string::npos);
  EXPECT_EQ(svg.find("href"), std::string::npos);
  EXPECT_EQ(svg.find("url("), std::string::npos);
}

TEST(Figure, DefinesEveryClassThatItUses) {
  Figure figure = tapping(300);
  for (int i = -1; i < 9; ++i) {
    figure.panels[0].lines.push_back({.name = "slot", .x = {0, 1}, .y = {0, 1}, .colour = i, .dash = Dash(i & 3)});
  }
  const std::string svg = to_svg(figure);
  const std::string style = figure_style();
  std::set<std::string> unknown;
  const std::regex classes("class=\"([^\"]*)\"");
  for (std::sregex_iterator match(svg.begin(), svg.end(), classes), end; match != end; ++match) {
    std::istringstream names((*match)[1].str());
    for (std::string name; names >> name;) {
      if (name != "line" && name != "name" && style.find("." + name) == std::string::npos) unknown.insert(name);
    }
  }
  EXPECT_TRUE(unknown.empty()) << *unknown.begin();
}

/// Writes 1234.5 as 1.234,5, on any machine.
struct DecimalComma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(Figure, IsTheSameBytesEachTimeAndInEachLocale) {
  const Figure figure = tapping(3000);
  const std::string svg = to_svg(figure);
  EXPECT_EQ(to_svg(figure), svg);
  const std::locale before = std::locale::global(std::locale(std::locale(), new DecimalComma));
  std::setlocale(LC_ALL, "de_DE.UTF-8");  // changes what C functions do, where it is installed
  const std::string other = to_svg(figure);
  std::setlocale(LC_ALL, "C");
  std::locale::global(before);
  EXPECT_EQ(other, svg);
}

}  // namespace figure_test
}  // namespace tactus::report
