// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/report/figure.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace tactus::report {

/// A grid of cells, each of one class: where on a plane of two parameters what happens. Several panels over the same
/// axes, up to three in a row, and lines that are drawn in each of them.
struct HeatMap {
  struct Axis {
    std::string label;
    std::string unit = {};
    std::vector<double> values;  ///< at the middle of the cells, ascending, at least two; positive if logarithmic
    bool logarithmic = false;
  };
  struct Class {
    std::string name;
    std::string colour;  ///< as `#rrggbb`, on a light page
    std::string dark;    ///< on a dark one
  };
  struct Panel {
    std::string title;
    std::vector<std::size_t> cells;  ///< class of each, y slow, x fast; one that does not exist stays blank
  };
  struct Line {
    std::string name;
    std::vector<double> y;  ///< one for each value of x; not finite breaks the line
    bool dashed = false;
    std::optional<std::size_t> panel = {};  ///< the only one that it is drawn in; else in all, and named in the legend
  };
  std::string title;  ///< the accessible name
  Axis x, y;
  std::vector<Class> classes;
  std::vector<Panel> panels;
  std::vector<Line> lines;
};

/// The picture, in the light or dark scheme of the reader; its page has `figure_style()`. Neighbouring cells of one
/// class are drawn as one rectangle, so the size follows the pattern and not the number of cells. A line beyond the y
/// axis runs along its edge. Equal maps give equal bytes.
Drawing draw(const HeatMap& map);
/// The same as an SVG file, with the styles that it needs.
std::string to_svg(const HeatMap& map);

}  // namespace tactus::report
