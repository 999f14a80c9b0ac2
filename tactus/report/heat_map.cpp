#include <tactus/report/heat_map.hpp>
#include <tactus/report/text.hpp>
#include <tactus/report/ticks.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>

namespace tactus::report {

namespace {

constexpr double panel_width = 400.0, panel_height = 300.0, left = 62.0, top = 64.0, gap = 24.0, bottom = 46.0;

std::string px(double value) {
  char text[32];
  const auto [end, error] =
      std::to_chars(text, text + sizeof text, std::round(value * 100.0) / 100.0, std::chars_format::fixed, 2);
  return error == std::errc{} ? std::string(text, end) : std::string("0");
}

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
    return logarithmic ? logarithmic_ticks(value(lower), value(upper), 8) : linear_ticks(lower, upper, 7);
  }
};

std::string text(double x, double y, const char* anchor, const std::string& words, const char* more = "") {
  return "<text x=\"" + px(x) + "\" y=\"" + px(y) + "\" text-anchor=\"" + anchor + "\"" + more + ">" + escape(words) +
         "</text>\n";
}

/// The cells of one class as one path of strips.
std::string cells_of(const HeatMap& map, const HeatMap::Panel& panel, std::size_t which, const Scale& x, const Scale& y,
                     double from) {
  std::string path;
  const std::size_t columns = map.x.values.size();
  for (std::size_t row = 0; row < map.y.values.size(); ++row) {
    const double low = top + panel_height * (1.0 - y.edges[row]), high = top + panel_height * (1.0 - y.edges[row + 1]);
    for (std::size_t column = 0; column < columns;) {
      const auto is_of = [&](std::size_t c) {
        const std::size_t cell = row * columns + c;
        return cell < panel.cells.size() && panel.cells[cell] == which;
      };
      std::size_t end = column;
      while (end < columns && is_of(end)) ++end;
      if (end == column) {
        ++column;
        continue;
      }
      path += "M";
      path += px(from + panel_width * x.edges[column]) + " " + px(high) + "H" + px(from + panel_width * x.edges[end]) +
              "V" + px(low) + "H" + px(from + panel_width * x.edges[column]) + "z";
      column = end;
    }
  }
  return path.empty() ? path : "<path fill=\"" + map.classes[which].colour + "\" d=\"" + path + "\"/>\n";
}

std::string line_of(const HeatMap& map, const HeatMap::Line& line, const Scale& x, const Scale& y, double from) {
  std::string path;
  bool drawing = false;
  for (std::size_t i = 0; i < std::min(line.y.size(), map.x.values.size()); ++i) {
    const double share = y.share(line.y[i]);
    if (!std::isfinite(share)) {
      drawing = false;
      continue;
    }
    path += drawing ? "L" : "M";
    path += px(from + panel_width * x.share(map.x.values[i])) + " " +
            px(top + panel_height * (1.0 - std::clamp(share, 0.0, 1.0)));
    drawing = true;
  }
  return "<path fill=\"none\" stroke=\"#111\" stroke-width=\"1.6\"" +
         std::string(line.dashed ? " stroke-dasharray=\"6 3\"" : "") + " d=\"" + path + "\"/>\n";
}

std::string named(const HeatMap::Axis& axis, const Ticks& ticks) {
  return with_unit(axis.label, ticks.exponent == 0 ? axis.unit : power_of_ten(ticks.exponent) + " " + axis.unit);
}

}  // namespace

std::string to_svg(const HeatMap& map) {
  const Scale x(map.x), y(map.y);
  const Ticks x_ticks = x.ticks(), y_ticks = y.ticks();
  const double width = left + static_cast<double>(map.panels.size()) * (panel_width + gap);
  const double height = top + panel_height + bottom;
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + px(width) + "\" height=\"" + px(height) +
                    "\" viewBox=\"0 0 " + px(width) + " " + px(height) +
                    "\" font-family=\"sans-serif\" font-size=\"11\" fill=\"#16191d\" role=\"img\">\n<title>" +
                    escape(map.title) + "</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
  double at = left;
  for (const HeatMap::Class& kind : map.classes) {
    svg += "<rect x=\"" + px(at) + "\" y=\"10\" width=\"12\" height=\"12\" fill=\"" + kind.colour + "\"/>\n" +
           text(at + 17.0, 20.0, "start", kind.name);
    at += 40.0 + 6.5 * static_cast<double>(display_width(kind.name));
  }
  at = left;
  for (const HeatMap::Line& line : map.lines) {
    if (line.panel) continue;
    svg += "<path stroke=\"#111\" stroke-width=\"1.6\"" + std::string(line.dashed ? " stroke-dasharray=\"6 3\"" : "") +
           " d=\"M" + px(at) + " 34h24\"/>\n" + text(at + 30.0, 38.0, "start", line.name);
    at += 50.0 + 6.5 * static_cast<double>(display_width(line.name));
  }
  for (std::size_t i = 0; i < map.panels.size(); ++i) {
    const double from = left + static_cast<double>(i) * (panel_width + gap);
    svg += text(from + 0.5 * panel_width, top - 7.0, "middle", map.panels[i].title, " font-weight=\"bold\"");
    for (std::size_t kind = 0; kind < map.classes.size(); ++kind) svg += cells_of(map, map.panels[i], kind, x, y, from);
    for (const HeatMap::Line& line : map.lines) {
      if (line.panel.value_or(i) == i) svg += line_of(map, line, x, y, from);
    }
    svg += "<rect x=\"" + px(from) + "\" y=\"" + px(top) + "\" width=\"" + px(panel_width) + "\" height=\"" +
           px(panel_height) + "\" fill=\"none\" stroke=\"#8a929b\"/>\n";
    for (std::size_t t = 0; t < x_ticks.major.size(); ++t) {
      const double place = from + panel_width * x.share(x_ticks.major[t]);
      svg += "<path stroke=\"#8a929b\" d=\"M" + px(place) + " " + px(top + panel_height) + "v4\"/>\n" +
             text(place, top + panel_height + 16.0, "middle", x_ticks.labels[t]);
    }
    svg += text(from + 0.5 * panel_width, top + panel_height + 34.0, "middle", named(map.x, x_ticks));
    if (i > 0) continue;
    for (std::size_t t = 0; t < y_ticks.major.size(); ++t) {
      const double place = top + panel_height * (1.0 - y.share(y_ticks.major[t]));
      svg += "<path stroke=\"#8a929b\" d=\"M" + px(from) + " " + px(place) + "h-4\"/>\n" +
             text(from - 7.0, place + 4.0, "end", y_ticks.labels[t]);
    }
    const std::string turn = " transform=\"rotate(-90 16 " + px(top + 0.5 * panel_height) + ")\"";
    svg += text(16.0, top + 0.5 * panel_height, "middle", named(map.y, y_ticks), turn.c_str());
  }
  return svg + "</svg>\n";
}

}  // namespace tactus::report
