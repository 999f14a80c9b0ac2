// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/report/curve.hpp>
#include <tactus/data/report/figure.hpp>
#include <tactus/data/report/ticks.hpp>

#include <optional>
#include <string>
#include <vector>

/// Where everything in a figure is, before anything is drawn. Lengths in px.
namespace tactus::report {

/// Sizes of type and spacing that layout and drawing agree on.
namespace measure {
inline constexpr double font = 11.0;
inline constexpr double tick_font = 10.0;
inline constexpr double line_height = 14.0;
inline constexpr double tick_length = 4.0;
inline constexpr double swatch = 26.0;
}  // namespace measure

/// Upper estimate of the width of `text`: fonts differ between machines, and a label must fit with all of them.
double text_width(const std::string& text, double font_px);

/// `text` broken at blanks into lines that fit `width`, where words allow it.
std::vector<std::string> wrap(const std::string& text, double width, double font_px);

/// An axis with its limits decided, and its place in the picture.
struct PlacedAxis {
  Limits limits;
  Ticks ticks;
  bool logarithmic;
  double begin, end;  ///< coordinates of the lower and the upper limit
  bool labelled;      ///< whether tick labels and the name are at this panel
  std::string name;   ///< with the unit, and the power of ten taken out of the tick labels

  /// The coordinate of a value. NaN where a logarithmic axis has no place for it.
  [[nodiscard]] double operator()(double value) const;
};

struct PlacedPanel {
  const Panel* panel;
  int row, column;
  Rectangle frame;
  PlacedAxis x, y;
};

/// A text at a place. The anchor is that of SVG: start, middle or end of the text is at the place.
struct PlacedText {
  std::string text;
  Point at;
  const char* anchor;
  const char* style;
  bool rotated = false;  ///< reads upward
};

/// An entry of the legend: a line, a series of bars or a rule that stands for all of its name and look. The others are
/// null.
struct LegendEntry {
  const Line* line;
  const Bars* bars;
  const Rule* rule;
  int rule_style;  ///< counts the labels of rules
  Point at;        ///< left end of the swatch, middle of the line of text
};

struct Layout {
  double width, height;
  std::vector<PlacedPanel> panels;
  std::vector<PlacedText> texts;  ///< titles and names of axes
  std::vector<Rectangle> group_bars;
  std::vector<LegendEntry> legend;
};

/// The name that the entry shows.
const std::string& text_of(const LegendEntry& entry);

Layout lay_out(const Figure& figure);

/// The legend's number of the rule: rules of equal direction and label look alike.
int rule_style(const std::vector<LegendEntry>& legend, const Rule& rule);

}  // namespace tactus::report
