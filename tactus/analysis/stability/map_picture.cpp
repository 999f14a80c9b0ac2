// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/map_picture.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/simulation/experiments/presentation.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

namespace tactus::stability {

namespace {

constexpr std::size_t most_panels = 4;

bool spans(const MapAxis& axis) { return axis.words.empty() && axis.values.size() > 1; }

report::HeatMap::Axis drawn(const MapAxis& axis) {
  return {.label = label_of(axis), .unit = axis.unit, .values = axis.values, .logarithmic = axis.logarithmic};
}

std::string percent_settled(const MapResult& map, const MapPlane& plane) {
  const auto from = map.points.begin() + static_cast<std::ptrdiff_t>(plane.first);
  const auto settled = std::count_if(from, from + static_cast<std::ptrdiff_t>(plane.points),
                                     [](const PointResult& p) { return p.verdict == experiments::Verdict::settled; });
  return report::number(100.0 * static_cast<double>(settled) / static_cast<double>(plane.points), 3) + " % settled";
}

MapPicture verdicts_of(const MapResult& map, const std::vector<MapPlane>& planes) {
  const auto& y = map.axes[map.axes.size() - 2];
  const auto& x = map.axes.back();
  report::HeatMap picture{.title = "Where a tap on the wall settles",
                          .x = drawn(x),
                          .y = drawn(y),
                          .classes = {{"settled", "#cfe8d5", "#2c6142"},
                                      {"ringing", "#ffe08a", "#9a7a1e"},
                                      {"limit cycle", "#f2a07b", "#a5492a"},
                                      {"diverged", "#8a4b7d", "#571f4c"}},
                          .panels = {},
                          .lines = {}};
  const auto limits = settled_limit(map, map.axes.size() - 2);
  const auto columns = static_cast<std::ptrdiff_t>(x.values.size());
  // Two boundaries can be told apart in one picture; more stand each in its own panel.
  const bool compared = planes.size() <= 2;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const std::string share = percent_settled(map, planes[i]);
    report::HeatMap::Panel panel{planes[i].title.empty() ? share : planes[i].title + ": " + share, {}};
    for (std::size_t n = 0; n < planes[i].points; ++n) {
      panel.cells.push_back(static_cast<std::size_t>(map.points[planes[i].first + n].verdict));
    }
    picture.panels.push_back(std::move(panel));
    const auto from = limits.begin() + static_cast<std::ptrdiff_t>(i) * columns;
    picture.lines.push_back({.name = "limit" + (planes[i].title.empty() ? "" : ", " + planes[i].title),
                             .y = std::vector<double>(from, from + columns),
                             .dashed = compared && i > 0,
                             .panel = compared ? std::nullopt : std::optional(i)});
  }
  return {.map = std::move(picture),
          .caption =
              "One run a cell. Settled: within 100 ms of the first touch; ringing: later; limit cycle: not within the "
              "observation. The line is the largest " +
              label_of(y) + " below which every run settled or rang; along the upper edge: beyond " +
              report::number(y.values.back(), 3) + ", where the map ends."};
}

/// Round values between the ends of an axis, these among them: 1, 2 and 5 times powers of ten.
std::vector<double> round_steps(double from, double to) {
  std::vector<double> steps{from};
  const double least = std::max(from, 1e-3 * to);
  for (double decade = std::pow(10.0, std::floor(std::log10(least))); decade <= to; decade *= 10.0) {
    for (const double times : {1.0, 2.0, 5.0}) {
      if (const double step = times * decade; step > least && step < to) steps.push_back(step);
    }
  }
  steps.push_back(to);
  return steps;
}

using Rgb = std::array<double, 3>;

/// A colour between two, as `#rrggbb`.
std::string blend(const Rgb& red, const Rgb& pale, double share) {
  char text[8];
  const auto mixed = [&](std::size_t i) {
    return static_cast<unsigned>(std::lround(red[i] + share * (pale[i] - red[i])));
  };
  std::snprintf(text, sizeof text, "#%02x%02x%02x", mixed(0), mixed(1), mixed(2));
  return text;
}

MapPicture limits_of(const MapResult& map) {
  const MapAxis &slow = map.axes[0], &along = map.axes[1], &fast = map.axes[2];
  const std::vector<double> steps = round_steps(along.values.front(), along.values.back());
  report::HeatMap picture{.title = "Limit of the " + label_of(along),
                          .x = drawn(fast),
                          .y = drawn(slow),
                          .classes = {{"below " + report::number(steps.front(), 2), "#8a4b7d", "#571f4c"}},
                          .panels = {{"largest " + label_of(along) + " below which every run settled or rang", {}}},
                          .lines = {}};
  for (std::size_t i = 0; i + 1 < steps.size(); ++i) {
    const double share = steps.size() > 2 ? static_cast<double>(i) / static_cast<double>(steps.size() - 2) : 0.0;
    // From red to yellow.
    picture.classes.push_back({report::number(steps[i], 2) + " to " + report::number(steps[i + 1], 2),
                               blend({0xb5, 0x44, 0x3c}, {0xff, 0xf3, 0xb0}, share),
                               blend({0x7a, 0x22, 0x1c}, {0xb8, 0x9c, 0x3e}, share)});
  }
  picture.classes.push_back({report::number(steps.back(), 2) + " or more, where the map ends", "#cfe8d5", "#2c6142"});
  for (const double limit : settled_limit(map, 1)) {
    const auto above = std::upper_bound(steps.begin(), steps.end(), limit);
    picture.panels[0].cells.push_back(std::isnan(limit) ? 0 : static_cast<std::size_t>(above - steps.begin()));
  }
  return {.map = std::move(picture),
          .caption = "Each cell is the limit over " + std::to_string(along.values.size()) + " runs of growing " +
                     label_of(along) + "."};
}

}  // namespace

std::string label_of(const MapAxis& axis) {
  std::string own = experiments::axis_of(axis.key).label;
  const std::size_t dot = axis.key.rfind('.');
  if (dot == std::string::npos) return own;
  std::string group = axis.key.substr(0, dot);
  group = group.substr(group.rfind('.') + 1);
  if (group == "control" || group == "task") return own;
  std::replace(group.begin(), group.end(), '_', ' ');
  return group + " " + own;
}

bool has_planes(const MapResult& map) {
  return map.axes.size() >= 2 && spans(map.axes.back()) && spans(map.axes[map.axes.size() - 2]);
}

std::vector<MapPlane> planes_of(const MapResult& map) {
  if (!has_planes(map)) return {{.title = {}, .first = 0, .points = map.points.size()}};
  const std::size_t size = map.axes.back().values.size() * map.axes[map.axes.size() - 2].values.size();
  std::vector<MapPlane> planes;
  for (std::size_t first = 0; first < map.points.size(); first += size) {
    std::string title;
    std::size_t stride = map.points.size();
    for (std::size_t i = 0; i + 2 < map.axes.size(); ++i) {
      const MapAxis& axis = map.axes[i];
      stride /= axis.values.size();
      const std::size_t at = first / stride % axis.values.size();
      title += (title.empty() ? "" : ", ") + label_of(axis) + " ";
      title += axis.words.empty() ? report::number(axis.values[at], 3) + (axis.unit.empty() ? "" : " " + axis.unit)
                                  : axis.words[at];
    }
    planes.push_back({std::move(title), first, size});
  }
  return planes;
}

std::optional<MapPicture> picture_of(const MapResult& map) {
  if (!has_planes(map)) return std::nullopt;
  const auto planes = planes_of(map);
  if (planes.size() > most_panels && map.axes.size() == 3 && spans(map.axes[0])) return limits_of(map);
  return verdicts_of(map, planes);
}

}  // namespace tactus::stability
