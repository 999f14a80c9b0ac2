// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/curve.hpp>
#include <tactus/data/report/figure.hpp>
#include <tactus/data/report/layout.hpp>
#include <tactus/data/report/palette.hpp>
#include <tactus/data/report/text.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <set>

namespace tactus::report {
namespace {

using namespace measure;

constexpr int slots = static_cast<int>(light_palette.series.size());
constexpr int rule_dashes = 4;

int slot_of(int colour) { return (colour % slots + slots) % slots; }

std::string line_attributes(const Line& line) {
  constexpr std::array<const char*, 4> dashes{"", " dashed", " dotted", " dash-dotted"};
  return "class=\"line colour-" + std::to_string(slot_of(line.colour)) + dashes[static_cast<std::size_t>(line.dash)] +
         "\" stroke-width=\"" + pixels(line.width_px) + "\"";
}

std::string rule_attributes(int style) {
  return style < 0 ? "class=\"rule\"" : "class=\"rule rule-" + std::to_string(style % rule_dashes) + "\"";
}

std::string segment(Point from, Point to) {
  std::string data("M");
  data.append(pixels(from.x)).append(" ").append(pixels(from.y)).append("L");
  data.append(pixels(to.x)).append(" ").append(pixels(to.y));
  return data;
}

std::string path(const std::string& attributes, const std::string& data) {
  return data.empty() ? "" : "<path " + attributes + " d=\"" + data + "\"/>\n";
}

std::string rectangle(const char* style, const Rectangle& area) {
  return std::string("<rect class=\"") + style + "\" x=\"" + pixels(area.left) + "\" y=\"" + pixels(area.top) +
         "\" width=\"" + pixels(area.width) + "\" height=\"" + pixels(area.height) + "\"/>\n";
}

std::string text(const PlacedText& placed) {
  const std::string x = pixels(placed.at.x);
  const std::string y = pixels(placed.at.y);
  std::string svg = std::string("<text class=\"") + placed.style + "\" x=\"" + x + "\" y=\"" + y + "\"";
  if (std::string_view(placed.anchor) != "start") svg += std::string(" text-anchor=\"") + placed.anchor + "\"";
  if (placed.rotated) svg += " transform=\"rotate(-90 " + x + " " + y + ")\"";
  return svg + ">" + escape(placed.text) + "</text>\n";
}

/// Moves a label at the end of an axis inward, so that it cannot run into that of the next panel.
double inward(double at, double half_size, double low, double high) {
  constexpr double overhang = 5.0;
  return std::clamp(at, low + half_size - overhang, std::max(low, high - half_size) + overhang);
}

std::string grid(const PlacedPanel& panel, const std::vector<double>& x_values, const std::vector<double>& y_values) {
  std::string data;
  for (const double value : x_values) {
    const double x = panel.x(value);
    data += segment({x, panel.frame.bottom()}, {x, panel.frame.top});
  }
  for (const double value : y_values) {
    const double y = panel.y(value);
    data += segment({panel.frame.left, y}, {panel.frame.right(), y});
  }
  return data;
}

std::string tick_marks(const PlacedPanel& panel) {
  std::string data;
  for (const double value : panel.x.ticks.major) {
    const double x = panel.x(value);
    data += segment({x, panel.frame.bottom()}, {x, panel.frame.bottom() + tick_length});
  }
  for (const double value : panel.y.ticks.major) {
    const double y = panel.y(value);
    data += segment({panel.frame.left - tick_length, y}, {panel.frame.left, y});
  }
  return path("class=\"mark\"", data);
}

std::string tick_labels(const PlacedPanel& panel) {
  const Rectangle& frame = panel.frame;
  std::string svg;
  if (panel.x.labelled) {
    for (std::size_t i = 0; i < panel.x.ticks.major.size(); ++i) {
      const std::string& label = panel.x.ticks.labels[i];
      const double half = 0.5 * text_width(label, tick_font);
      const double x = inward(panel.x(panel.x.ticks.major[i]), half, frame.left, frame.right());
      svg += text({label, {x, frame.bottom() + tick_length + tick_font}, "middle", "tick"});
    }
  }
  if (panel.y.labelled) {
    for (std::size_t i = 0; i < panel.y.ticks.major.size(); ++i) {
      const double y = inward(panel.y(panel.y.ticks.major[i]), 0.5 * tick_font, frame.top, frame.bottom());
      svg += text({panel.y.ticks.labels[i], {frame.left - tick_length - 2.0, y + 0.36 * tick_font}, "end", "tick"});
    }
  }
  return svg;
}

std::string line_path(const PlacedPanel& panel, const Line& line) {
  std::vector<Point> points(std::min(line.x.size(), line.y.size()));
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = {panel.x(line.x[i]), panel.y(line.y[i])};
  constexpr double points_per_pixel = 2.0;
  if (static_cast<double>(points.size()) > points_per_pixel * panel.frame.width) points = thin(points);
  return path(line_attributes(line), path_data(points, panel.frame));
}

std::string rule_path(const PlacedPanel& panel, const Rule& rule, int style) {
  const bool horizontal = rule.direction == Rule::Direction::horizontal;
  const PlacedAxis& axis = horizontal ? panel.y : panel.x;
  if (!(rule.at >= axis.limits.lower && rule.at <= axis.limits.upper)) return "";
  const double at = axis(rule.at);
  const Rectangle& frame = panel.frame;
  return path(rule_attributes(style), horizontal ? segment({frame.left, at}, {frame.right(), at})
                                                 : segment({at, frame.top}, {at, frame.bottom()}));
}

std::string bars_of(const PlacedPanel& panel) {
  constexpr double used_share = 0.8;  // of the height of a category
  const std::vector<Bars>& series = panel.panel->bars;
  const Rectangle& frame = panel.frame;
  const double zero = panel.x(0.0);
  const double base = std::isfinite(zero) ? std::clamp(zero, frame.left, frame.right()) : frame.left;
  const double lane = used_share / static_cast<double>(series.size());
  std::string svg;
  for (std::size_t s = 0; s < series.size(); ++s) {
    const std::string style = "fill-" + std::to_string(slot_of(series[s].colour));
    for (std::size_t i = 0; i < std::min(series[s].lengths.size(), panel.panel->y.categories.size()); ++i) {
      const double top = panel.y(static_cast<double>(i) - 0.5 * used_share + lane * static_cast<double>(s));
      const double bottom = panel.y(static_cast<double>(i) - 0.5 * used_share + lane * static_cast<double>(s + 1));
      const double end = std::clamp(panel.x(series[s].lengths[i]), frame.left, frame.right());
      const double left = std::min(base, end);
      const double width = std::abs(end - base);
      if (width > 0.0) svg += rectangle(style.c_str(), {left, top, width, bottom - top});
      if (i < series[s].labels.size()) {
        const double start = std::isfinite(end) ? std::max(base, end) : base;
        svg += text({series[s].labels[i], {start + 4.0, 0.5 * (top + bottom) + 0.36 * tick_font}, "start", "tick"});
      }
    }
  }
  return svg;
}

std::string draw_panel(const PlacedPanel& panel, const std::vector<LegendEntry>& legend) {
  std::string content;
  content += bars_of(panel);
  for (const Rule& rule : panel.panel->rules) content += rule_path(panel, rule, rule_style(legend, rule));
  for (const Line& line : panel.panel->lines) content += line_path(panel, line);
  if (content.empty()) {
    const Rectangle& frame = panel.frame;
    content = text({"no data", {frame.left + 0.5 * frame.width, frame.top + 0.5 * frame.height}, "middle", "tick"});
  }
  return "<g>\n" + path("class=\"grid minor\"", grid(panel, panel.x.ticks.minor, panel.y.ticks.minor)) +
         path("class=\"grid\"", grid(panel, panel.x.ticks.major, panel.y.ticks.major)) + tick_marks(panel) +
         rectangle("frame", panel.frame) + content + tick_labels(panel) + "</g>\n";
}

std::string draw_entry(const LegendEntry& entry) {
  const Point at = entry.at;
  const Point end{at.x + swatch, at.y};
  std::string svg;
  if (entry.line != nullptr) {
    svg = path(line_attributes(*entry.line), segment(at, end));
  } else if (entry.bars != nullptr) {
    const std::string style = "fill-" + std::to_string(slot_of(entry.bars->colour));
    svg = rectangle(style.c_str(), {at.x, at.y - 4.0, swatch, 8.0});
  } else if (entry.rule->direction == Rule::Direction::horizontal) {
    svg = path(rule_attributes(entry.rule_style), segment(at, end));
  } else {
    const double middle = at.x + 0.5 * swatch;
    svg = path(rule_attributes(entry.rule_style), segment({middle, at.y - 7.0}, {middle, at.y + 7.0}));
  }
  return svg + text({text_of(entry), {end.x + 5.0, at.y + 0.36 * font}, "start", "name"});
}

std::string description(const Figure& figure) {
  std::string names;
  std::set<std::string> seen;
  for (const Panel& panel : figure.panels) {
    const auto add = [&](const std::string& name) {
      if (!name.empty() && seen.insert(name).second) names += (names.empty() ? "" : ", ") + name;
    };
    for (const Line& line : panel.lines) add(line.name);
    for (const Bars& bars : panel.bars) add(bars.name);
  }
  return figure.caption + (figure.caption.empty() ? "" : " ") + "Panels: " + std::to_string(figure.panels.size()) +
         (names.empty() ? "." : ". Shown: " + names + ".");
}

std::string opening(const std::string& attributes, const Layout& layout) {
  return "<svg" + attributes + " class=\"tactus-figure\" role=\"img\" viewBox=\"0 0 " + pixels(layout.width) + " " +
         pixels(layout.height) + "\">\n";
}

std::string content(const Figure& figure, const Layout& layout) {
  std::string svg;
  for (const Rectangle& bar : layout.group_bars) svg += rectangle("bar", bar);
  for (const PlacedPanel& panel : layout.panels) svg += draw_panel(panel, layout.legend);
  for (const PlacedText& placed : layout.texts) svg += text(placed);
  for (const LegendEntry& entry : layout.legend) svg += draw_entry(entry);
  return "<title>" + escape(figure.title) + "</title>\n<desc>" + escape(description(figure)) + "</desc>\n" + svg +
         "</svg>\n";
}

std::string custom_properties(const Palette& palette) {
  const std::string prefix = "--tactus-";
  std::string css = prefix + "surface:" + palette.surface + ";" + prefix + "text:" + palette.text + ";" + prefix +
                    "muted:" + palette.muted + ";" + prefix + "frame:" + palette.frame + ";" + prefix +
                    "grid:" + palette.grid + ";" + prefix + "accent:" + palette.accent + ";";
  for (std::size_t i = 0; i < palette.series.size(); ++i) {
    css += prefix + std::to_string(i) + ":" + palette.series[i] + ";";
  }
  return css;
}

/// A colour twice: plain for the programs that know no custom properties, then the property.
std::string coloured(const std::string& property, const char* plain, const std::string& name) {
  return property + ":" + plain + ";" + property + ":var(--tactus-" + name + ");";
}

}  // namespace

std::string scheme_style() {
  return ":root{color-scheme:light dark;" + custom_properties(light_palette) + "}\n" +
         "@media screen and (prefers-color-scheme:dark){:root{" + custom_properties(dark_palette) + "}}\n";
}

std::string figure_style() {
  const Palette& light = light_palette;
  std::string css = scheme_style();
  css += ".tactus-figure{font-family:system-ui,\"Helvetica Neue\",Arial,\"DejaVu Sans\",sans-serif;" +
         coloured("background", light.surface, "surface") + "}\n";
  css += ".tactus-figure text{font-size:" + pixels(font) + "px;" + coloured("fill", light.text, "text") + "}\n";
  css += ".tactus-figure .title{font-weight:600}\n";
  css += ".tactus-figure .tick{font-size:" + pixels(tick_font) + "px;" + coloured("fill", light.muted, "muted") + "}\n";
  css += ".tactus-figure path{fill:none;stroke-linecap:round;stroke-linejoin:round}\n";
  css +=
      ".tactus-figure .grid,.tactus-figure .mark,.tactus-figure .frame,.tactus-figure .rule{stroke-width:1;"
      "stroke-linecap:butt;shape-rendering:crispEdges}\n";
  css += ".tactus-figure .grid{" + coloured("stroke", light.grid, "grid") + "}\n";
  css += ".tactus-figure .minor{opacity:.55}\n";
  css += ".tactus-figure .frame{fill:none;" + coloured("stroke", light.frame, "frame") + "}\n";
  css += ".tactus-figure .mark{" + coloured("stroke", light.frame, "frame") + "}\n";
  css += ".tactus-figure .bar{" + coloured("fill", light.frame, "frame") + "}\n";
  css += ".tactus-figure .rule{" + coloured("stroke", light.muted, "muted") + "}\n";
  constexpr std::array<const char*, rule_dashes> patterns{"6 3", "2 2", "9 3 2 3", "4 2 1 2 1 2"};
  for (std::size_t i = 0; i < patterns.size(); ++i) {
    css += ".tactus-figure .rule-" + std::to_string(i) + "{stroke-dasharray:" + patterns[i] + "}\n";
  }
  for (std::size_t i = 0; i < light.series.size(); ++i) {
    const std::string slot = std::to_string(i);
    css += ".tactus-figure .colour-" + slot + "{" + coloured("stroke", light.series[i], slot) + "}\n";
    css += ".tactus-figure .fill-" + slot + "{" + coloured("fill", light.series[i], slot) + "}\n";
  }
  css +=
      ".tactus-figure .dashed{stroke-dasharray:5 3}\n.tactus-figure .dotted{stroke-dasharray:.1 2.6}\n"
      ".tactus-figure .dash-dotted{stroke-dasharray:6 3 .1 3}\n";
  return css;
}

Drawing draw(const Figure& figure) {
  const Layout layout = lay_out(figure);
  return {opening("", layout) + content(figure, layout), layout.width, layout.height};
}

std::string to_svg(const Figure& figure) {
  const Layout layout = lay_out(figure);
  const std::string attributes = " xmlns=\"http://www.w3.org/2000/svg\" width=\"" + pixels(layout.width) +
                                 "\" height=\"" + pixels(layout.height) + "\"";
  return opening(attributes, layout) + "<style>\n" + figure_style() + "</style>\n" + content(figure, layout);
}

}  // namespace tactus::report
