// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace tactus::report {

/// One axis of a panel. The limits come from the data (and the rules) unless they are set.
struct Axis {
  enum class Scale { linear, logarithmic };
  std::string label;
  std::string unit = {};
  std::optional<double> lower = {};  ///< in `unit`
  std::optional<double> upper = {};  ///< in `unit`
  Scale scale = Scale::linear;
  /// Only for y: names instead of numbers, from the top. Category i is at the value i, and the limits, set or from
  /// data, do not count.
  std::vector<std::string> categories = {};
};

enum class Dash { solid, dashed, dotted, dash_dotted };

/// A line through points. A point that is not finite (or not positive on a logarithmic axis) breaks it.
struct Line {
  std::string name;       ///< entry of the legend; none for a line without a name
  std::vector<double> x;  ///< in the unit of the panel's x axis; what exceeds the length of `y` is not drawn
  std::vector<double> y;  ///< in the unit of the panel's y axis; what exceeds the length of `x` is not drawn
  int colour = 0;         ///< slot 0 to 7 of the palette, taken modulo 8
  Dash dash = Dash::solid;
  double width_px = 1.2;
};

/// Horizontal bars over the categories of the y axis, from 0, on a logarithmic axis from its lower limit; several
/// series share the height of a category, the first on top.
struct Bars {
  std::string name;                      ///< entry of the legend; none for bars without a name
  std::vector<double> lengths;           ///< one for each category, in the unit of the x axis; not finite: no bar
  std::vector<std::string> labels = {};  ///< written behind the bar of the same index
  int colour = 0;                        ///< slot 0 to 7 of the palette, taken modulo 8
};

/// A straight reference across a panel: a limit, an event.
struct Rule {
  enum class Direction { horizontal, vertical };
  Direction direction = Direction::horizontal;
  double at = 0.0;         ///< in the unit of the axis that it crosses
  std::string label = {};  ///< entry of the legend, where equal labels share one
};

/// One pair of axes with what is drawn on them. A panel without anything to draw states `no data`.
struct Panel {
  std::string title;
  Axis x;
  Axis y;
  std::vector<Line> lines;
  std::vector<Rule> rules;
  std::vector<Bars> bars = {};
  /// A unit is as long on both axes, which have one unit then and are linear: limits that are too narrow are widened.
  bool equal_scales = false;
};

/// Which panels have equal limits. Neighbours with equal limits are labelled only at the outer edge.
enum class Sharing {
  none,
  in_line,      ///< x: the panels of one column; y: the panels of one row
  by_quantity,  ///< all panels whose axes have the same label, unit and scale
};

/// A band of adjacent rows under one name, written at its left.
struct RowGroup {
  std::string label;
  int rows = 1;
};

/// Small multiples: panels in a grid, filled row by row, with one legend.
struct Figure {
  enum class Legend { above, below };
  std::string title;    ///< the accessible name; a page shows it in front of the caption
  std::string caption;  ///< the accessible description; a page shows it below the picture
  int columns = 1;      ///< at least 1; less is taken as 1
  std::vector<Panel> panels;
  std::vector<std::string> column_titles = {};
  std::vector<RowGroup> row_groups = {};  ///< from the top
  Sharing share_x = Sharing::none;
  Sharing share_y = Sharing::none;
  Legend legend = Legend::above;
};

/// A picture and its natural size. `svg` is one `<svg>` element that scales through its viewBox.
struct Drawing {
  std::string svg;
  double width_px;
  double height_px;
};

/// The picture without styles, for a document that holds `figure_style()` once. Never fails: whatever the figure lacks
/// is left out. Lines with more points than pixels are thinned so that extremes survive. Equal figures give equal
/// bytes.
Drawing draw(const Figure& figure);

/// The styles of figures: CSS custom properties `--tactus-…` for a light and a dark scheme (a printer gets the light
/// one), and the classes that use them.
std::string figure_style();
/// Of that, the colours of the light and the dark scheme as custom properties.
std::string scheme_style();

/// The picture as a file of its own: as `draw`, with its styles, the size and the XML namespace.
std::string to_svg(const Figure& figure);

}  // namespace tactus::report
