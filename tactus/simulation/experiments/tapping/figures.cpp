// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/presentation.hpp>
#include <tactus/simulation/experiments/tapping/figures.hpp>

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>

namespace tactus::experiments {

namespace {

using report::Figure;
using report::Line;
using report::Panel;

constexpr std::string_view cancellation_key = "control.cancellation";
constexpr std::size_t most_columns = 6;
constexpr double shown_before_touch_s = 0.01;
constexpr double shown_after_touch_s = 0.15;

/// Runs that share a value of cancellation, or all runs where it is not varied.
struct Group {
  std::string label;
  std::vector<const TappingRun*> runs;
};

std::string cancellation_of(const TappingRun& run) {
  for (const auto& [key, value] : run.settings) {
    if (key == cancellation_key) return "cancellation " + value;
  }
  return {};
}

Settings without_cancellation(Settings settings) {
  std::erase_if(settings, [](const auto& setting) { return setting.first == cancellation_key; });
  return settings;
}

std::vector<Group> group_by_cancellation(const std::vector<TappingRun>& runs) {
  std::vector<Group> groups;
  for (const TappingRun& run : runs) {
    const std::string label = cancellation_of(run);
    auto group = std::find_if(groups.begin(), groups.end(), [&](const Group& g) { return g.label == label; });
    if (group == groups.end()) group = groups.insert(groups.end(), Group{label, {}});
    group->runs.push_back(&run);
  }
  return groups;
}

std::vector<std::size_t> evenly_chosen(std::size_t count, std::size_t most) {
  std::vector<std::size_t> chosen;
  const std::size_t taken = std::min(count, most);
  for (std::size_t i = 0; i < taken; ++i) chosen.push_back(taken == 1 ? 0 : i * (count - 1) / (taken - 1));
  return chosen;
}

template <class Value>
Line trace_line(const TappingRun& run, std::string name, int colour, Value&& value) {
  Line line{.name = std::move(name), .x = {}, .y = {}, .colour = colour};
  for (const simulation::Teleoperator::Record& record : run.trace) {
    const double since_touch_s = record.time_s - run.first_touch_s;
    if (since_touch_s < -shown_before_touch_s || since_touch_s > shown_after_touch_s) continue;
    line.x.push_back(1e3 * since_touch_s);
    line.y.push_back(value(record));
  }
  return line;
}

report::Axis time_axis() { return {.label = "time since touch", .unit = "ms"}; }

Panel force_panel(const TappingRun& run) {
  const bool vibrates =
      std::any_of(run.trace.begin(), run.trace.end(), [](const auto& record) { return record.handle_force_N != 0.0; });
  std::vector<Line> lines{trace_line(run, vibrates ? "force of the motor" : "force on the hand", 0,
                                     [](const auto& record) { return record.displayed_force_N; })};
  if (vibrates) {
    lines.push_back(trace_line(run, "force of the handle's actuator", 5,
                               [](const auto& record) { return -record.handle_force_N; }));
  }
  return {.title = {},
          .x = time_axis(),
          .y = {.label = "displayed force", .unit = "N"},
          .lines = std::move(lines),
          .rules = {}};
}

Panel position_panel(const TappingRun& run) {
  const auto millimetres = [](double simulation::Teleoperator::Record::*member) {
    return [member](const simulation::Teleoperator::Record& record) { return 1e3 * record.*member; };
  };
  Line command = trace_line(run, "slave command", 1, millimetres(&simulation::Teleoperator::Record::command_m));
  command.dash = report::Dash::dashed;
  return {.title = {},
          .x = time_axis(),
          .y = {.label = "position", .unit = "mm"},
          // The command last and dashed: without cancellation it lies on the measured position.
          .lines = {trace_line(run, "master, measured", 2,
                               millimetres(&simulation::Teleoperator::Record::master_position_m)),
                    trace_line(run, "induced motion, estimated", 3,
                               millimetres(&simulation::Teleoperator::Record::induced_position_m)),
                    trace_line(run, "slave tip", 4, millimetres(&simulation::Teleoperator::Record::tip_position_m)),
                    command},
          .rules = {}};
}

Figure transients(const std::vector<Group>& groups) {
  Figure figure{.title = "Displayed force and slave command",
                .caption =
                    "One tap for each condition, the one with the median settling time, aligned at its first "
                    "touch. Above: the force displayed to the hand. Below: the slave's position command, with "
                    "the measured master position and the model's estimate of the motion that the force "
                    "induced. Compare Fig. 13 of Kuchenbecker and Niemeyer.",
                .columns = 1,
                .panels = {},
                .share_x = report::Sharing::by_quantity,
                .share_y = report::Sharing::by_quantity};
  std::size_t count = groups.front().runs.size();
  for (const Group& group : groups) count = std::min(count, group.runs.size());
  const auto chosen = evenly_chosen(count, most_columns);
  figure.columns = static_cast<int>(chosen.size());
  for (const std::size_t index : chosen) {
    figure.column_titles.push_back(settings_caption(without_cancellation(groups.front().runs[index]->settings)));
  }
  for (const Group& group : groups) {
    for (const std::size_t index : chosen) figure.panels.push_back(force_panel(*group.runs[index]));
    for (const std::size_t index : chosen) figure.panels.push_back(position_panel(*group.runs[index]));
    figure.row_groups.push_back({group.label, 2});
  }
  return figure;
}

/// The settling time over the one other parameter that is varied, if it is a number.
std::optional<Figure> settling_over_parameter(const std::vector<Group>& groups) {
  const Settings settings = without_cancellation(groups.front().runs.front()->settings);
  if (settings.size() != 1 || groups.front().runs.size() < 2) return std::nullopt;
  const std::string& key = settings.front().first;

  Panel settling{.title = {},
                 .x = axis_of(key),
                 .y = {.label = "settling time", .unit = "ms", .lower = 0.0},
                 .lines = {},
                 .rules = {}};
  Panel share{.title = {},
              .x = axis_of(key),
              .y = {.label = "taps that settle", .unit = "%", .lower = 0.0, .upper = 105.0},
              .lines = {},
              .rules = {}};
  int colour = 0;
  for (const Group& group : groups) {
    const std::string name = group.label.empty() ? "median" : group.label;
    Line median{.name = name, .x = {}, .y = {}, .colour = colour, .width_px = 2.0};
    Line p90{.name = name + ", 90th percentile", .x = {}, .y = {}, .colour = colour, .dash = report::Dash::dashed};
    Line settled{.name = {}, .x = {}, .y = {}, .colour = colour, .width_px = 2.0};
    for (const TappingRun* run : group.runs) {
      const std::optional<double> x = as_number(without_cancellation(run->settings).front().second);
      if (!x) return std::nullopt;
      for (Line* line : {&median, &p90, &settled}) line->x.push_back(*x);
      median.y.push_back(1e3 * run->metrics.settling_time_median_s);
      p90.y.push_back(1e3 * run->metrics.settling_time_p90_s);
      settled.y.push_back(100.0 * run->metrics.settled_fraction);
    }
    settling.lines.push_back(median);
    settling.lines.push_back(p90);
    share.lines.push_back(settled);
    ++colour;
  }
  settling.rules.push_back({.at = 1e3 * groups.front().runs.front()->observation_s, .label = "observation window"});
  return Figure{.title = "How long a contact rings",
                .caption =
                    "Left: settling time over the ensemble of taps; a tap that does not settle counts with the "
                    "whole observation window. Right: the share of taps that settle.",
                .columns = 2,
                .panels = {settling, share}};
}

}  // namespace

std::vector<report::Figure> tapping_figures(const std::vector<TappingRun>& runs) {
  const std::vector<Group> groups = group_by_cancellation(runs);
  std::vector<Figure> figures{transients(groups)};
  if (auto figure = settling_over_parameter(groups)) figures.push_back(*std::move(figure));
  return figures;
}

}  // namespace tactus::experiments
