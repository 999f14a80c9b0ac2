// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/heat_map.hpp>
#include <tactus/data/report/palette.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/data/report/ticks.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <utility>

namespace tactus::report {

namespace {

constexpr double panel_width = 400.0, panel_height = 300.0, left = 62.0, top = 68.0, gap = 24.0, bottom = 46.0;
constexpr double space_of_rows = 28.0;
constexpr std::size_t panels_in_row = 3;

struct Corner {
  double x, y;
};

/// Rounded to a multiple of 1 / `parts`.
std::string rounded(double value, double parts) {
  char text[32];
  const auto [end, error] = std::to_chars(text, text + sizeof text, std::round(value * parts) / parts);
  return error == std::errc{} ? std::string(text, end) : std::string("0");
}

std::string px(double value) { return rounded(value, 10.0); }

/// An axis as coordinates: where cells begin and where values stand.
struct Scale {
  std::vector<double> edges;  ///< one more than values, as shares of the length
  double lower, upper;        ///< of the outer edges, in the axis' own scale
  bool logarithmic;

  explicit Scale(const HeatMap::Axis& axis) : lower(0.0), upper(1.0), logarithmic(axis.logarithmic) {
    std::vector<double> at;
    for (const double value : axis.values) at.push_back(own(value));
    if (at.size() < 2) at = {0.0, 1.0};
    lower = at.front() - 0.5 * (at[1] - at[0]);
    upper = at.back() + 0.5 * (at.back() - at[at.size() - 2]);
    edges.push_back(0.0);
    for (std::size_t i = 1; i < at.size(); ++i) edges.push_back((0.5 * (at[i - 1] + at[i]) - lower) / (upper - lower));
    edges.push_back(1.0);
  }
  [[nodiscard]] double own(double value) const { return logarithmic ? std::log10(value) : value; }
  [[nodiscard]] double share(double value) const { return (own(value) - lower) / (upper - lower); }
  [[nodiscard]] double value(double at) const { return logarithmic ? std::pow(10.0, at) : at; }
  [[nodiscard]] Ticks ticks() const {
    if (!logarithmic) return linear_ticks(lower, upper, 7);
    Ticks ticks = logarithmic_ticks(value(lower), value(upper), 8);
    // Two labels alone do not say where a boundary lies.
    if (ticks.major.size() > 2 || value(upper) > 1e3 || value(lower) < 1e-2) return ticks;
    ticks.major.clear();
    ticks.labels.clear();
    for (double decade = 1e-2; decade <= value(upper); decade *= 10.0) {
      for (const double times : {1.0, 2.0, 5.0}) {
        if (times * decade < value(lower) || times * decade > value(upper)) continue;
        ticks.major.push_back(times * decade);
        ticks.labels.push_back(rounded(times * decade, 100.0));
      }
    }
    return ticks;
  }
};

std::string text(double x, double y, const char* anchor, const std::string& words, const char* more = "") {
  return "<text x=\"" + px(x) + "\" y=\"" + px(y) + "\" text-anchor=\"" + anchor + "\"" + more + ">" + escape(words) +
         "</text>\n";
}

/// What cells of these two colours are called. Pictures on one page may share it.
std::string class_of(const HeatMap::Class& of) { return "cells-" + of.colour.substr(1) + "-" + of.dark.substr(1); }

std::string styles_of(const HeatMap& map) {
  std::string light, dark;
  for (const HeatMap::Class& of : map.classes) {
    light += "." + class_of(of) + "{fill:" + of.colour + "}\n";
    dark += "." + class_of(of) + "{fill:" + of.dark + "}\n";
  }
  return "<style>\n" + light + "@media screen and (prefers-color-scheme:dark){\n" + dark + "}\n</style>\n";
}

/// A colour of the page's scheme as a style, `light` where a picture stands alone without one.
std::string in_scheme(const char* property, const char* name, const char* light) {
  return std::string(" style=\"") + property + ":var(--tactus-" + name + "," + light + ")\"";
}

/// A rectangle of cells of one class that has not ended yet: columns from `from` up to `to`, rows from `row`.
struct Block {
  std::size_t from, to, row;
};

/// The cells of one class as one path of rectangles.
std::string cells_of(const HeatMap& map, const HeatMap::Panel& panel, std::size_t which, const Scale& x, const Scale& y,
                     Corner corner) {
  const std::size_t columns = map.x.values.size(), rows = map.y.values.size();
  const auto is_of = [&](std::size_t row, std::size_t column) {
    const std::size_t cell = row * columns + column;
    return cell < panel.cells.size() && panel.cells[cell] == which;
  };
  std::string path;
  const auto finish = [&](const Block& block, std::size_t end_row) {
    const std::string left_x = px(corner.x + panel_width * x.edges[block.from]);
    path.append("M").append(left_x).append(" ");
    path += px(corner.y + panel_height * (1.0 - y.edges[end_row])) + "H";
    path += px(corner.x + panel_width * x.edges[block.to]) + "V";
    path += px(corner.y + panel_height * (1.0 - y.edges[block.row])) + "H" + left_x + "z";
  };
  std::vector<Block> open;
  for (std::size_t row = 0; row <= rows; ++row) {
    std::vector<Block> now;
    for (std::size_t column = 0; row < rows && column < columns; ++column) {
      if (!is_of(row, column)) continue;
      std::size_t end = column;
      while (end < columns && is_of(row, end)) ++end;
      now.push_back({column, end, row});
      column = end;
    }
    for (const Block& block : open) {
      const auto goes_on = std::find_if(
          now.begin(), now.end(), [&](const Block& other) { return other.from == block.from && other.to == block.to; });
      if (goes_on == now.end()) {
        finish(block, row);
      } else {
        goes_on->row = block.row;
      }
    }
    open = std::move(now);
  }
  if (path.empty()) return path;
  return "<path class=\"" + class_of(map.classes[which]) + "\" shape-rendering=\"crispEdges\" d=\"" + path + "\"/>\n";
}

std::string stroke(const HeatMap::Line& line, const std::string& path) {
  // An edge keeps the line apart from cells of its own shade.
  const std::string data = " d=\"" + path + "\"/>\n";
  return "<path fill=\"none\" stroke-width=\"4.5\" stroke-opacity=\"0.7\"" +
         in_scheme("stroke", "surface", light_palette.surface) + data + "<path fill=\"none\" stroke-width=\"2.2\"" +
         (line.dashed ? " stroke-dasharray=\"7 3\"" : "") + in_scheme("stroke", "text", light_palette.text) + data;
}

std::string line_of(const HeatMap& map, const HeatMap::Line& line, const Scale& x, const Scale& y, Corner corner) {
  std::string path;
  bool drawing = false;
  for (std::size_t i = 0; i < std::min(line.y.size(), map.x.values.size()); ++i) {
    const double share = y.share(line.y[i]);
    if (!std::isfinite(share)) {
      drawing = false;
      continue;
    }
    path += drawing ? "L" : "M";
    path += px(corner.x + panel_width * x.share(map.x.values[i])) + " " +
            px(corner.y + panel_height * (1.0 - std::clamp(share, 0.0, 1.0)));
    drawing = true;
  }
  return path.empty() ? path : stroke(line, path);
}

std::string named(const HeatMap::Axis& axis, const Ticks& ticks) {
  return with_unit(axis.label, ticks.exponent == 0 ? axis.unit : power_of_ten(ticks.exponent) + " " + axis.unit);
}

struct Legend {
  std::string svg;
  double right;
};

Legend legend_of(const HeatMap& map) {
  std::string svg;
  double at = left;
  for (std::size_t kind = 0; kind < map.classes.size(); ++kind) {
    const auto shows = [kind](const HeatMap::Panel& panel) {
      return std::find(panel.cells.begin(), panel.cells.end(), kind) != panel.cells.end();
    };
    if (std::none_of(map.panels.begin(), map.panels.end(), shows)) continue;
    const HeatMap::Class& of = map.classes[kind];
    svg += "<rect x=\"" + px(at) + "\" y=\"10\" width=\"12\" height=\"12\" class=\"" + class_of(of) + "\"/>\n" +
           text(at + 17.0, 20.0, "start", of.name);
    at += 40.0 + 6.5 * static_cast<double>(display_width(of.name));
  }
  const double after_classes = at;
  at = left;
  for (const HeatMap::Line& line : map.lines) {
    if (line.panel) continue;
    std::string sample("M");
    svg += stroke(line, sample.append(px(at)).append(" 35h24")) + text(at + 30.0, 39.0, "start", line.name);
    at += 56.0 + 6.5 * static_cast<double>(display_width(line.name));
  }
  return {.svg = svg, .right = std::max(after_classes, at)};
}

std::string frame_of(const HeatMap& map, const Scale& x, const Scale& y, Corner corner, bool first_of_row) {
  const Ticks x_ticks = x.ticks(), y_ticks = y.ticks();
  const double low = corner.y + panel_height;
  const std::string edge = in_scheme("stroke", "frame", light_palette.frame);
  std::string svg = "<rect x=\"" + px(corner.x) + "\" y=\"" + px(corner.y) + "\" width=\"" + px(panel_width) +
                    "\" height=\"" + px(panel_height) + "\" fill=\"none\"" + edge + "/>\n";
  for (std::size_t t = 0; t < x_ticks.major.size(); ++t) {
    const double place = corner.x + panel_width * x.share(x_ticks.major[t]);
    svg += "<path" + edge + " d=\"M" + px(place) + " " + px(low) + "v4\"/>\n" +
           text(place, low + 16.0, "middle", x_ticks.labels[t]);
  }
  svg += text(corner.x + 0.5 * panel_width, low + 34.0, "middle", named(map.x, x_ticks));
  if (!first_of_row) return svg;
  for (std::size_t t = 0; t < y_ticks.major.size(); ++t) {
    const double place = corner.y + panel_height * (1.0 - y.share(y_ticks.major[t]));
    svg += "<path" + edge + " d=\"M" + px(corner.x) + " " + px(place) + "h-4\"/>\n" +
           text(corner.x - 7.0, place + 4.0, "end", y_ticks.labels[t]);
  }
  const double middle = corner.y + 0.5 * panel_height;
  const std::string turn = " transform=\"rotate(-90 16 " + px(middle) + ")\"";
  return svg + text(16.0, middle, "middle", named(map.y, y_ticks), turn.c_str());
}

}  // namespace

Drawing draw(const HeatMap& map) {
  const Scale x(map.x), y(map.y);
  const std::size_t columns = std::clamp(map.panels.size(), std::size_t{1}, panels_in_row);
  const std::size_t rows = std::max(std::size_t{1}, (map.panels.size() + columns - 1) / columns);
  const double row_height = panel_height + bottom + space_of_rows;
  const Legend legend = legend_of(map);
  const double width = std::max(legend.right, left + static_cast<double>(columns) * (panel_width + gap));
  const double height = top + static_cast<double>(rows) * row_height - space_of_rows;
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + px(width) + "\" height=\"" + px(height) +
                    "\" viewBox=\"0 0 " + px(width) + " " + px(height) +
                    "\" font-family=\"sans-serif\" font-size=\"12\" role=\"img\"" +
                    in_scheme("fill", "text", light_palette.text) + ">\n<title>" + escape(map.title) + "</title>\n" +
                    styles_of(map) + "<rect width=\"100%\" height=\"100%\"" +
                    in_scheme("fill", "surface", light_palette.surface) + "/>\n" + legend.svg;
  for (std::size_t i = 0; i < map.panels.size(); ++i) {
    const std::size_t row = i / columns;
    const Corner corner{left + static_cast<double>(i % columns) * (panel_width + gap),
                        top + static_cast<double>(row) * row_height};
    svg += text(corner.x + 0.5 * panel_width, corner.y - 8.0, "middle", map.panels[i].title, " font-weight=\"bold\"");
    for (std::size_t kind = 0; kind < map.classes.size(); ++kind) {
      svg += cells_of(map, map.panels[i], kind, x, y, corner);
    }
    for (const HeatMap::Line& line : map.lines) {
      if (line.panel.value_or(i) == i) svg += line_of(map, line, x, y, corner);
    }
    svg += frame_of(map, x, y, corner, i % columns == 0);
  }
  return {.svg = svg + "</svg>\n", .width_px = width, .height_px = height};
}

std::string to_svg(const HeatMap& map) {
  std::string svg = draw(map).svg;
  return svg.insert(svg.find("<style>\n") + std::string_view("<style>\n").size(), scheme_style());
}

}  // namespace tactus::report
