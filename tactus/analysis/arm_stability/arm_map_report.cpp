// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/arm_stability/arm_map.hpp>
#include <tactus/analysis/arm_stability/internal/mode_json.hpp>
#include <tactus/data/report/json.hpp>
#include <tactus/simulation/experiments/presentation.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include <nlohmann/json.hpp>

namespace tactus::arm_stability {
namespace {

using MapJson = nlohmann::ordered_json;
using experiments::Settings;

/// The key whose values stand side by side: the last with several numbers.
std::optional<std::size_t> key_across(const ArmMap& map) {
  const Settings& first = map.points.front().settings;
  for (std::size_t key = first.size(); key-- > 0;) {
    const bool numbers = std::all_of(map.points.begin(), map.points.end(), [&](const ArmMapPoint& point) {
      return experiments::as_number(point.settings[key].second).has_value();
    });
    const bool several = std::any_of(map.points.begin(), map.points.end(), [&](const ArmMapPoint& point) {
      return point.settings[key].second != first[key].second;
    });
    if (numbers && several) return key;
  }
  return std::nullopt;
}

/// Points that differ in one key alone, in the order of the map.
struct Row {
  std::string hand;
  double hand_stiffness_N_per_m = 0.0;
  Settings settings;  ///< without that key
  std::vector<const ArmMapPoint*> points;
};

std::vector<Row> rows_of(const ArmMap& map, std::optional<std::size_t> across) {
  std::vector<Row> rows;
  for (const ArmMapPoint& point : map.points) {
    Settings others = point.settings;
    if (across) others.erase(others.begin() + static_cast<std::ptrdiff_t>(*across));
    auto row = std::find_if(rows.begin(), rows.end(), [&](const Row& one) {
      return across && one.hand == map.hands[point.hand] && one.settings == others;
    });
    if (row == rows.end()) {
      rows.push_back({map.hands[point.hand], point.hand_stiffness_N_per_m, others, {}});
      row = rows.end() - 1;
    }
    row->points.push_back(&point);
  }
  return rows;
}

std::vector<std::string> head_of(const Row& row) {
  std::vector<std::string> cells{row.hand};
  for (const auto& [key, value] : row.settings) cells.push_back(value);
  return cells;
}

std::vector<report::Column> columns_of(const Row& row) {
  std::vector<report::Column> columns{{"hand", "", report::Column::Align::left}};
  for (report::Column column : experiments::settings_columns(row.settings)) columns.push_back(std::move(column));
  return columns;
}

std::string limit_text(const experiments::GainLimit& limit) {
  return experiments::gain_limit_text(limit, lowest_arm_gain);
}

report::Table limits_table(const std::vector<Row>& rows, std::optional<std::size_t> across) {
  std::vector<report::Column> columns = columns_of(rows.front());
  for (const ArmMapPoint* point : rows.front().points) {
    columns.push_back(
        {across ? experiments::axis_of(point->settings[*across].first).label + " " + point->settings[*across].second
                : "limit"});
  }
  report::Table table(columns, "Gain limit of the linear loop, drawn models included");
  for (const Row& row : rows) {
    std::vector<std::string> cells = head_of(row);
    for (const ArmMapPoint* point : row.points) cells.push_back(limit_text(point->limit.drawn));
    table.add_row(std::move(cells));
  }
  return table;
}

const ArmMapPoint& least_of(const Row& row) {
  return **std::min_element(row.points.begin(), row.points.end(), [](const ArmMapPoint* a, const ArmMapPoint* b) {
    return a->limit.drawn.gain < b->limit.drawn.gain;
  });
}

report::Table least_table(const std::vector<Row>& rows, std::optional<std::size_t> across) {
  std::vector<report::Column> columns = columns_of(rows.front());
  if (across) columns.push_back({experiments::axis_of(rows.front().points.front()->settings[*across].first).label});
  for (report::Column column : std::vector<report::Column>{
           {"limit"}, {"exact model"}, {"rings at", "Hz"}, {"moves most", "", report::Column::Align::left}}) {
    columns.push_back(std::move(column));
  }
  report::Table table(columns, "The least of each line, and what grows just beyond it");
  for (const Row& row : rows) {
    const ArmMapPoint& least = least_of(row);
    std::vector<std::string> cells = head_of(row);
    if (across) cells.push_back(least.settings[*across].second);
    cells.push_back(limit_text(least.limit.drawn));
    cells.push_back(limit_text(least.limit.exact));
    const auto& mode = least.limit.beyond_drawn;
    cells.push_back(mode ? report::number(mode->frequency_Hz, 3) : "");
    cells.push_back(mode ? words_of(*mode, least.joints) : "");
    table.add_row(std::move(cells));
  }
  return table;
}

std::string map_json(const ArmMap& map, const experiments::Request& request, double friction_speed_rad_per_s) {
  MapJson document{{"experiment", request.name}, {"friction_speed_rad_per_s", friction_speed_rad_per_s}};
  document["points"] = MapJson::array();
  for (const ArmMapPoint& point : map.points) {
    MapJson entry{{"hand", map.hands[point.hand]},
                  {"set", report::parse_json<MapJson>(experiments::settings_json(point.settings))}};
    entry["hand_stiffness_N_per_m"] = point.hand_stiffness_N_per_m;
    entry["gain_limit"] = point.limit.exact.gain;
    entry["gain_limit_censored"] = point.limit.exact.censored();
    entry["at_limit"] = mode_json(point.limit.beyond_exact, point.joints);
    entry["drawn_limit"] = point.limit.drawn.gain;
    entry["drawn_limit_censored"] = point.limit.drawn.censored();
    entry["at_drawn_limit"] = mode_json(point.limit.beyond_drawn, point.joints);
    document["points"].push_back(std::move(entry));
  }
  return report::json_text(document);
}

std::string csv_of(const ArmMap& map) {
  std::ostringstream csv;
  csv.precision(17);
  csv << "hand,hand_stiffness (N/m)";
  for (const auto& [key, value] : map.points.front().settings) csv << "," << key;
  csv << ",gain_limit,gain_limit_censored,at_Hz,drawn_limit,drawn_limit_censored,drawn_at_Hz,moves_most\n";
  const auto limit = [&csv](const experiments::GainLimit& of, const std::optional<ArmMode>& mode) {
    csv << "," << of.gain << "," << (of.censored() ? "true" : "false") << ",";
    if (mode) csv << mode->frequency_Hz;
  };
  for (const ArmMapPoint& point : map.points) {
    csv << map.hands[point.hand] << "," << point.hand_stiffness_N_per_m;
    for (const auto& [key, value] : point.settings) csv << "," << value;
    limit(point.limit.exact, point.limit.beyond_exact);
    limit(point.limit.drawn, point.limit.beyond_drawn);
    csv << "," << (point.limit.beyond_drawn ? words_of(*point.limit.beyond_drawn, point.joints) : "") << "\n";
  }
  return csv.str();
}

/// Steps of the picture, and their colours on a light and a dark page: from red over yellow to green.
constexpr std::array<double, 6> steps{0.5, 1.0, 2.0, 4.0, 8.0, 16.0};
constexpr std::array<std::array<const char*, 2>, 7> colours{{{"#8a4b7d", "#571f4c"},
                                                             {"#b5443c", "#7a221c"},
                                                             {"#d98a5b", "#8f4a25"},
                                                             {"#efc27d", "#a0763a"},
                                                             {"#fff3b0", "#b89c3e"},
                                                             {"#e3eeb8", "#7d8b3c"},
                                                             {"#cfe8d5", "#2c6142"}}};

std::size_t class_of(double limit) {
  return static_cast<std::size_t>(std::upper_bound(steps.begin(), steps.end(), limit) - steps.begin());
}

/// Over the key across and the stiffness of hands, a panel for each combination of the others.
std::optional<report::HeatMap> picture_of(const std::vector<Row>& rows, std::optional<std::size_t> across) {
  if (!across) return std::nullopt;
  std::set<double> hands;
  for (const Row& row : rows) hands.insert(row.hand_stiffness_N_per_m);
  std::vector<double> values;
  for (const ArmMapPoint* point : rows.front().points) {
    values.push_back(*experiments::as_number(point->settings[*across].second));
  }
  if (hands.size() < 2 || !std::is_sorted(values.begin(), values.end())) return std::nullopt;
  report::HeatMap picture{
      .title = "Gain limit of the linear loop",
      .x = {.label = experiments::axis_of(rows.front().points.front()->settings[*across].first).label,
            .values = values},
      .y = {.label = "stiffness of the hand",
            .unit = "N/m",
            .values = {hands.begin(), hands.end()},
            .logarithmic = true},
      .classes = {},
      .panels = {},
      .lines = {}};
  for (std::size_t i = 0; i < colours.size(); ++i) {
    const std::string name = i == 0 ? "below " + report::number(steps.front(), 2)
                             : i == steps.size()
                                 ? report::number(steps.back(), 2) + " or more"
                                 : report::number(steps[i - 1], 2) + " to " + report::number(steps[i], 2);
    picture.classes.push_back({name, colours[i][0], colours[i][1]});
  }
  std::map<std::string, std::size_t> panel_of;
  for (const Row& row : rows) {
    std::string title;
    for (const auto& [key, value] : row.settings) title += (title.empty() ? "" : ", ") + value;
    const auto [found, fresh] = panel_of.emplace(title, picture.panels.size());
    constexpr std::size_t blank = 99;
    if (fresh) {
      picture.panels.push_back({title, std::vector<std::size_t>(hands.size() * values.size(), blank)});
    }
    const auto line = static_cast<std::size_t>(std::distance(hands.begin(), hands.find(row.hand_stiffness_N_per_m)));
    for (std::size_t i = 0; i < row.points.size(); ++i) {
      picture.panels[found->second].cells[line * values.size() + i] = class_of(row.points[i]->limit.drawn.gain);
    }
  }
  return picture;
}

std::string map_verdict(const std::vector<Row>& rows) {
  const Row* least = &rows.front();
  for (const Row& row : rows) {
    if (least_of(row).limit.drawn.gain < least_of(*least).limit.drawn.gain) least = &row;
  }
  const ArmMapPoint& point = least_of(*least);
  return "The least gain limit of the linear loop is " + limit_text(point.limit.drawn) + ": hand " + least->hand +
         (point.settings.empty() ? "" : ", " + experiments::settings_caption(point.settings)) + ".";
}

}  // namespace

ArmMapReport report_arm_map(const ArmMap& map, const experiments::Request& request, double friction_speed_rad_per_s) {
  const auto across = key_across(map);
  const std::vector<Row> rows = rows_of(map, across);
  const report::Table limits = limits_table(rows, across), least = least_table(rows, across);
  const std::string verdict = map_verdict(rows);
  const auto picture = picture_of(rows, across);
  report::Page page(request.name + ": gain limits of two arms");
  page.paragraph(verdict);
  page.paragraph(
      "Each point is the largest force gain up to which the linear loop in contact is stable; with cancellation, also "
      "with each of " +
      std::to_string(models_drawn) +
      " models of induced motion with the errors that the task draws. Taps in simulation settle up to less: ringing "
      "must have "
      "ended, and the tool leaves the surface.");
  if (picture) page.figure(*picture, "Gain limit over what is varied and the hand that holds the leader.");
  page.table(limits);
  page.table(least);
  experiments::add_provenance(page, request, map.configuration);
  return {.outcome = {.text = verdict + "\n\n" + limits.to_text() + least.to_text(),
                      .json = map_json(map, request, friction_speed_rad_per_s),
                      .html = page.to_html(),
                      .figures = {},
                      .traces = {},
                      .configuration = map.configuration},
          .csv = csv_of(map),
          .svg = picture ? std::optional(report::to_svg(*picture)) : std::nullopt};
}

}  // namespace tactus::arm_stability
