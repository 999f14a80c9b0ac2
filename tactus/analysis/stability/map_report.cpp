// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/map_picture.hpp>
#include <tactus/analysis/stability/map_report.hpp>
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/page.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/simulation/experiments/presentation.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace tactus::stability {

namespace {

constexpr std::size_t verdicts = 4;

std::array<std::size_t, verdicts> count(const MapResult& map, const MapPlane& plane) {
  std::array<std::size_t, verdicts> counts{};
  for (std::size_t i = 0; i < plane.points; ++i) {
    ++counts[static_cast<std::size_t>(map.points[plane.first + i].verdict)];
  }
  return counts;
}

/// The axis whose limit is told: of a plane the vertical one, else the last.
std::size_t limited_axis(const MapResult& map) { return map.axes.size() - (has_planes(map) ? 2 : 1); }

/// The limits that belong to one plane, as `smallest to largest`.
std::string range_of(const MapResult& map, const std::vector<double>& limits, std::size_t plane, std::size_t planes) {
  const std::size_t each = limits.size() / planes;
  const auto from = limits.begin() + static_cast<std::ptrdiff_t>(plane * each);
  const std::vector<double> own(from, from + static_cast<std::ptrdiff_t>(each));
  const auto& values = map.axes[limited_axis(map)].values;
  const auto told = [&](double limit) {
    if (std::isnan(limit)) return "< " + report::number(values.front(), 3);
    return (limit == values.back() ? "≥ " : "") + report::number(limit, 3);
  };
  const auto below = [](double a, double b) { return std::isnan(a) ? !std::isnan(b) : a < b; };
  const auto [least, most] = std::minmax_element(own.begin(), own.end(), below);
  return told(*least) == told(*most) ? told(*least) : told(*least) + " to " + told(*most);
}

report::Table table_of(const MapResult& map, const std::vector<MapPlane>& planes, const std::vector<double>& limits) {
  const MapAxis& along = map.axes[limited_axis(map)];
  using Align = report::Column::Align;
  const std::string limit = "limit of " + label_of(along);
  report::Table table({{"plane", "", Align::left},
                       {"settled", "%"},
                       {"ringing", "%"},
                       {"limit cycle", "%"},
                       {"diverged", "%"},
                       {limit, along.unit}},
                      "Shares of the verdicts, and the limits from the smallest to the largest");
  for (std::size_t i = 0; i < planes.size(); ++i) {
    std::vector<std::string> row{planes[i].title.empty() ? "all" : planes[i].title};
    for (const std::size_t share : count(map, planes[i])) {
      row.push_back(report::number(100.0 * static_cast<double>(share) / static_cast<double>(planes[i].points), 3));
    }
    row.push_back(along.words.empty() ? range_of(map, limits, i, planes.size()) : "");
    table.add_row(std::move(row));
  }
  return table;
}

std::string json_of(const MapResult& map, const std::vector<MapPlane>& planes, const std::vector<double>& limits,
                    double elapsed_s) {
  nlohmann::ordered_json json;
  json["points"] = map.points.size();
  json["resumed_points"] = map.resumed;
  json["redone_in_double"] = map.redone;
  json["instruction_set"] = map.instruction_set;
  json["loop_ticks"] = map.ticks;
  json["lanes_busy"] = map.lane_ticks > 0.0 ? map.ticks / map.lane_ticks : 1.0;
  json["elapsed_s"] = elapsed_s;
  for (const MapPlane& plane : planes) {
    const auto counts = count(map, plane);
    nlohmann::ordered_json entry{{"plane", plane.title.empty() ? "all" : plane.title}};
    for (std::size_t verdict = 0; verdict < verdicts; ++verdict) {
      entry[std::string(name_of(static_cast<experiments::Verdict>(verdict)))] = counts[verdict];
    }
    json["planes"].push_back(std::move(entry));
  }
  json["axes"] = nlohmann::ordered_json::array();
  for (const MapAxis& axis : map.axes) {
    nlohmann::ordered_json entry{{"key", axis.key}, {"unit", axis.unit}, {"values", axis.values}};
    if (!axis.words.empty()) entry["values"] = axis.words;
    json["axes"].push_back(std::move(entry));
  }
  // JSON has no NaN: where not even the first value settled stands null.
  json["settled_limit"] = limits;
  const MapAxis& along = map.axes[limited_axis(map)];
  json["settled_limit_censored"] = nlohmann::ordered_json::array();
  for (const double limit : limits) {
    const bool censored = along.words.empty() && (std::isnan(limit) || limit == along.values.back());
    json["settled_limit_censored"].push_back(censored);
  }
  return report::json_text(json);
}

std::string effort_of(const MapResult& map, double elapsed_s) {
  std::string text = std::to_string(map.points.size()) + " runs in " + report::number(elapsed_s, 3) + " s, " +
                     report::number(map.ticks / elapsed_s / 1e6, 3) + " million control cycles a second (" +
                     map.instruction_set + ")";
  if (map.resumed > 0) text += "; " + std::to_string(map.resumed) + " from an earlier run";
  if (map.redone > 0) text += "; " + std::to_string(map.redone) + " again in double";
  return text;
}

}  // namespace

MapReport report_map(const MapResult& map, const MapParams& base, double elapsed_s,
                     const experiments::Request& request) {
  const auto planes = planes_of(map);
  const auto limits = settled_limit(map, limited_axis(map));
  const report::Table table = table_of(map, planes, limits);
  const std::string effort = effort_of(map, elapsed_s);
  const auto picture = picture_of(map);

  std::size_t settled = 0;
  for (const MapPlane& plane : planes)
    settled += count(map, plane)[static_cast<std::size_t>(experiments::Verdict::settled)];
  const std::string verdict =
      report::number(100.0 * static_cast<double>(settled) / static_cast<double>(map.points.size()), 3) + " % of " +
      std::to_string(map.points.size()) + " taps settle.";

  report::Page page(request.name + ": stability map");
  page.paragraph(verdict);
  page.paragraph(
      "One tap on the wall at every point of a grid, each a closed-loop run in time with friction, hysteresis, "
      "quantisation and saturation: " +
      effort + ".");
  if (picture) page.figure(picture->map, picture->caption);
  page.table(table);
  page.paragraph(
      "One tap near the boundary is decided by accident, so a boundary has speckle. Next to this page: map.csv "
      "with one line a run, map.h5 with the same as arrays over the axes.");
  experiments::add_provenance(page, request, configuration::to_toml(base));
  return {.text = verdict + "\n" + effort + "\n\n" + table.to_text(),
          .json = json_of(map, planes, limits, elapsed_s),
          .html = page.to_html(),
          .svg = picture ? std::optional(report::to_svg(picture->map)) : std::nullopt};
}

}  // namespace tactus::stability
