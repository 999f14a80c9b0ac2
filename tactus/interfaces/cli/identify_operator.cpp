// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/page.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/identification/axis/operator_impedance.hpp>
#include <tactus/interfaces/cli/axis_options.hpp>
#include <tactus/interfaces/cli/identify.hpp>
#include <tactus/interfaces/cli/outcome_files.hpp>
#include <tactus/interfaces/cli/streams.hpp>
#include <tactus/kernel/core/version.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace tactus::cli {
namespace {

using identification::AxisRecording;
using identification::Estimate;
using identification::ImpedanceVerdict;
using identification::OperatorImpedance;
using identification::OperatorImpedances;
using Json = nlohmann::ordered_json;

struct OperatorOptions {
  AxisOptions axis;
  identification::OperatorImpedanceOptions estimate;
};

struct Quantity {
  const char* name;
  Estimate OperatorImpedance::*estimate;
  const char* unit;
  const char* rotary_unit;
};

constexpr std::array quantities{
    Quantity{"stiffness", &OperatorImpedance::stiffness, "N/m", "N m/rad"},
    Quantity{"damping", &OperatorImpedance::damping, "N s/m", "N m s/rad"},
    Quantity{"mass", &OperatorImpedance::mass, "kg", "kg m^2"},
};

const char* word_of(ImpedanceVerdict verdict) {
  switch (verdict) {
    case ImpedanceVerdict::determined:
      return "determined";
    case ImpedanceVerdict::still:
      return "still";
    case ImpedanceVerdict::hand_drives:
      return "hand-drives";
    case ImpedanceVerdict::unexplained:
      return "unexplained";
    case ImpedanceVerdict::contradicted:
      return "contradicted";
  }
  return "";
}

const char* reason_of(ImpedanceVerdict verdict) {
  switch (verdict) {
    case ImpedanceVerdict::determined:
      return "determined";
    case ImpedanceVerdict::still:
      return "too little motion";
    case ImpedanceVerdict::hand_drives:
      return "the hand drives";
    case ImpedanceVerdict::unexplained:
      return "motion does not explain the force";
    case ImpedanceVerdict::contradicted:
      return "not a passive hand";
  }
  return "";
}

Json parameters_of(const OperatorImpedance& impedance, bool rotary) {
  Json list = Json::array();
  for (const Quantity& quantity : quantities) {
    const Estimate& estimate = impedance.*quantity.estimate;
    list.push_back({{"name", quantity.name},
                    {"value", estimate.value},
                    {"unit", rotary ? quantity.rotary_unit : quantity.unit},
                    {"interval_95", {estimate.lower, estimate.upper}},
                    {"determined", impedance.determined(estimate)}});
  }
  return list;
}

std::string json_of(const OperatorImpedances& found, const AxisRecording& axis, const std::string& file) {
  Json document{{"recording", file},
                {"position", axis.position.name},
                {"force", axis.force.name},
                {"sample_time_s", axis.sample_time.value},
                {"samples", axis.position.values.size()},
                {"lower_Hz", found.lower_Hz},
                {"upper_Hz", found.upper_Hz},
                {"window_s", found.window_s},
                {"explained", found.whole.explained},
                {"verdict", word_of(found.whole.verdict)},
                {"parameters", parameters_of(found.whole, axis.rotary)},
                {"windows", Json::array()}};
  for (const OperatorImpedance& window : found.windows) {
    document["windows"].push_back({{"from_s", window.from_s},
                                   {"to_s", window.to_s},
                                   {"explained", window.explained},
                                   {"verdict", word_of(window.verdict)},
                                   {"parameters", parameters_of(window, axis.rotary)}});
  }
  return report::json_text(document);
}

/// `12 ± 3`, in brackets where the data do not tell it.
std::string cell(const OperatorImpedance& impedance, const Estimate& estimate) {
  const std::string text =
      report::number(estimate.value, 3) + " ± " + report::number(0.5 * (estimate.upper - estimate.lower), 2);
  return impedance.determined(estimate) ? text : "(" + text + ")";
}

report::Table table_of(const OperatorImpedances& found, bool rotary) {
  std::vector<report::Column> columns{{.title = "from", .unit = "s"}, {.title = "to", .unit = "s"}};
  for (const Quantity& quantity : quantities) {
    columns.push_back({.title = quantity.name, .unit = rotary ? quantity.rotary_unit : quantity.unit});
  }
  columns.push_back({.title = "explained", .unit = "%"});
  columns.push_back({.title = "verdict", .align = report::Column::Align::left});
  report::Table table(columns);
  const auto add = [&](const OperatorImpedance& impedance) {
    std::vector<std::string> row{report::number(impedance.from_s, 3), report::number(impedance.to_s, 3)};
    for (const Quantity& quantity : quantities) row.push_back(cell(impedance, impedance.*quantity.estimate));
    row.push_back(report::number(100.0 * impedance.explained, 2));
    row.emplace_back(reason_of(impedance.verdict));
    table.add_row(row);
  };
  for (const OperatorImpedance& window : found.windows) add(window);
  add(found.whole);
  return table;
}

std::string summary_of(const OperatorImpedances& found, const AxisRecording& axis) {
  std::string told;
  for (const Quantity& quantity : quantities) {
    const auto count = std::count_if(found.windows.begin(), found.windows.end(), [&](const OperatorImpedance& window) {
      return window.determined(window.*quantity.estimate);
    });
    told += (told.empty() ? "" : ", ") + std::string(quantity.name) + " in " + std::to_string(count);
  }
  return "Judged from " + report::number(found.lower_Hz, 2) + " to " + report::number(found.upper_Hz, 2) +
         " Hz: below, intended motion cannot be distinguished from stiffness and damping. Of " +
         std::to_string(found.windows.size()) + " windows the data determine " + told +
         "; in brackets what they do not determine. The last row is the whole recording. ± is the 95 % interval. "
         "Position " +
         axis.position.name + ", force " + axis.force.name + ".";
}

/// Value and interval where they are determined, a break in the line where they are not.
report::Panel panel_of(const OperatorImpedances& found, const Quantity& quantity, bool rotary) {
  std::vector<double> time_s, value, lower, upper;
  for (const OperatorImpedance& window : found.windows) {
    const Estimate& estimate = window.*quantity.estimate;
    const bool determined = window.determined(estimate);
    const double nothing = std::nan("");
    // A step over the middle of the window, so that a single window shows.
    const double middle_s = 0.5 * (window.from_s + window.to_s);
    for (const double at_s : {middle_s - 0.125 * found.window_s, middle_s + 0.125 * found.window_s}) {
      time_s.push_back(at_s);
      value.push_back(determined ? estimate.value : nothing);
      lower.push_back(determined ? estimate.lower : nothing);
      upper.push_back(determined ? estimate.upper : nothing);
    }
  }
  return {.title = {},
          .x = {.label = "time", .unit = "s"},
          .y = {.label = quantity.name, .unit = rotary ? quantity.rotary_unit : quantity.unit, .lower = 0.0},
          .lines = {{.name = "95 % interval", .x = time_s, .y = upper, .colour = 1, .width_px = 0.6},
                    {.name = {}, .x = time_s, .y = lower, .colour = 1, .width_px = 0.6},
                    {.name = "estimate", .x = time_s, .y = value}},
          .rules = {}};
}

report::Page page_of(const OperatorImpedances& found, const AxisRecording& axis, const report::Table& table,
                     const std::string& summary, const std::string& command) {
  report::Page page("Impedance of the hand on " + axis.position.name);
  page.paragraph(summary);
  report::Figure figure{
      .title = "Impedance over time",
      .caption = "Each value is of a window around its time; a gap where the data do not determine it.",
      .panels = {}};
  for (const Quantity& quantity : quantities) figure.panels.push_back(panel_of(found, quantity, axis.rotary));
  page.figure(figure);
  page.table(table);
  page.footer("tactus " + std::string(version()), command);
  return page;
}

Check identify_operator(OperatorOptions options, const std::string& command) {
  options.axis.roles.of_the_hand = true;
  const auto axis = read_axis(options.axis);
  if (!axis) return axis.error();
  options.estimate.doubt_sign = !options.axis.roles.force_sign;
  const auto found = identification::estimate_operator_impedance(
      {.position = axis->position.values, .force = axis->force.values, .sample_time = axis->sample_time},
      options.estimate);
  if (!found) {
    Error error = found.error();
    error.place = options.axis.file;
    error.message += " (position '" + axis->position.name + "', force '" + axis->force.name + "')";
    return error;
  }
  const report::Table table = table_of(*found, axis->rotary);
  const std::string summary = summary_of(*found, *axis);
  return write_outcome(options.axis.output, {.text = summary + "\n\n" + table.to_text(),
                                             .json = json_of(*found, *axis, options.axis.file),
                                             .html = page_of(*found, *axis, table, summary, command).to_html(),
                                             .figures = {}});
}

}  // namespace

void add_identify_operator(CLI::App& identify, const std::string& name, const std::string& command, int& status) {
  auto options = std::make_shared<OperatorOptions>();
  CLI::App* verb = identify.add_subcommand(
      "operator", "Estimate the impedance of the hand over time, from the leader's motion and the hand force");
  add_axis_options(*verb, options->axis, command);
  verb->remove_option(verb->get_option("--external"));
  verb->get_option("--position")->description("Column of the leader's position; in a MATLAB file NAME:COLUMN");
  verb->get_option("--force")->description("Column of the force or torque of the hand on the leader");
  verb->get_option("--force-sign")->description("-1 reverses the hand force; 1 confirms its sign");
  verb->get_option("--out")->description("Folder for report.html and results.json");
  verb->add_option("--lower-Hz", options->estimate.lower_Hz, "Lower edge of the band, above intended motion")
      ->type_name("HZ");
  verb->add_option("--upper-Hz", options->estimate.upper_Hz, "Upper edge of the band")->type_name("HZ");
  verb->add_option("--window-s", options->estimate.window_s, "Length of a window")->type_name("S");
  verb->callback([options, name, &command, &status] {
    if (const auto error = identify_operator(*options, command)) {
      status = report_error(name, *error);
    }
  });
}

}  // namespace tactus::cli
