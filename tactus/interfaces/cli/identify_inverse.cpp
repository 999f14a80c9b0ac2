// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/page.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/identification/axis/inverse_dynamics.hpp>
#include <tactus/interfaces/cli/axis_options.hpp>
#include <tactus/interfaces/cli/identify.hpp>
#include <tactus/interfaces/cli/outcome_files.hpp>
#include <tactus/interfaces/cli/streams.hpp>
#include <tactus/kernel/control/estimators/inverse_model_estimator.hpp>
#include <tactus/kernel/core/version.hpp>

#include <algorithm>
#include <array>
#include <memory>
#include <numbers>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace tactus::cli {

namespace {

using identification::AxisRecording;
using identification::Estimate;
using identification::InverseDynamics;

struct Term {
  const char* name;
  Estimate estimate;
  double least_squares;
  const char* unit;
};

struct InverseOptions {
  AxisOptions axis;
  std::optional<double> cutoff_Hz;
};

std::array<Term, 4> rows_of(const InverseDynamics& model, bool rotary) {
  return {Term{"inertia", model.inertia, model.least_squares[0], rotary ? "kg m^2" : "kg"},
          Term{"viscous_friction", model.viscous, model.least_squares[1], rotary ? "N m s/rad" : "N s/m"},
          Term{"coulomb_friction", model.coulomb, model.least_squares[2], rotary ? "N m" : "N"},
          Term{"offset", model.offset, model.least_squares[3], rotary ? "N m" : "N"}};
}

/// A parameter is determined when its interval leaves zero out.
bool determined(const Estimate& estimate) { return estimate.lower > 0.0 || estimate.upper < 0.0; }

std::string json_of(const InverseDynamics& model, const AxisRecording& axis, const std::string& file) {
  using Json = nlohmann::ordered_json;
  Json document{{"recording", file},
                {"position", axis.position.name},
                {"force", axis.force.name},
                {"sample_time_s", axis.sample_time.value},
                {"samples", axis.position.values.size()},
                {"cutoff_Hz", model.cutoff_Hz},
                {"friction_speed", model.friction_speed},
                {"explained", model.explained},
                {axis.rotary ? "residual_rms_N_m" : "residual_rms_N", model.residual_rms},
                {"parameters", Json::array()}};
  for (const Term& row : rows_of(model, axis.rotary)) {
    document["parameters"].push_back({{"name", row.name},
                                      {"value", row.estimate.value},
                                      {"unit", row.unit},
                                      {"interval_95", {row.estimate.lower, row.estimate.upper}},
                                      {"determined", determined(row.estimate)},
                                      {"least_squares", row.least_squares}});
  }
  return report::json_text(document);
}

/// The file that `tactus estimate force` loads. Friction below zero, which the fit may find within its interval, is
/// none.
std::string toml_of(const InverseDynamics& model, const AxisRecording& axis, const std::string& command) {
  control::InverseModelEstimator::Params params;
  params.mass_kg = model.inertia.value;
  params.viscous_damping_N_s_per_m = std::max(0.0, model.viscous.value);
  params.friction.law = control::FrictionLaw::smooth_coulomb;
  params.friction.force_N = std::max(0.0, model.coulomb.value);
  params.friction.offset_N = model.offset.value;
  params.friction.velocity_scale_m_per_s = model.friction_speed;
  const double filter_s = 1.0 / (2.0 * std::numbers::pi * 2.0 * model.cutoff_Hz);
  params.force_filter_s = filter_s;
  params.derivative_filter_s = filter_s;
  params.prediction = signal::Predictor::Params::none();
  return "# " + command + "\n" +
         (axis.rotary ? "# Of a rotary axis: read kg as kg m^2, N as N m and m as rad.\n" : "") +
         configuration::to_toml(params);
}

report::Page page_of(const InverseDynamics& model, const AxisRecording& axis, const report::Table& table,
                     const std::string& command) {
  report::Page page("Inverse dynamic model of " + axis.position.name);
  page.paragraph("Force = inertia·a + viscous·v + Coulomb·tanh(v/v0) + offset explains " +
                 report::number(100.0 * model.explained, 3) + " % of the force's variance below " +
                 report::number(model.cutoff_Hz, 2) +
                 " Hz. Intervals are of 95 %, from the scatter over twelve blocks of the recording.");
  page.table(table);
  const char* unit = axis.rotary ? "N m" : "N";
  report::Panel over_time{.title = "Force over time",
                          .x = {.label = "time", .unit = "s"},
                          .y = {.label = "force", .unit = unit},
                          .lines = {},
                          .rules = {}};
  over_time.lines.push_back({.name = "measured", .x = model.time_s, .y = model.measured});
  over_time.lines.push_back({.name = "model", .x = model.time_s, .y = model.modelled, .colour = 1});
  page.figure({.title = "Fit", .caption = "Measured force and model, both low-passed.", .panels = {over_time}});
  page.footer("tactus " + std::string(version()), command);
  return page;
}

Check identify_inverse(const InverseOptions& options, const std::string& command) {
  const auto axis = read_axis(options.axis);
  if (!axis) return axis.error();
  const auto model = identification::fit_inverse_dynamics(
      {.position = axis->position.values, .force = axis->force.values, .sample_time = axis->sample_time},
      options.cutoff_Hz);
  if (!model) {
    Error error = model.error();
    error.place = options.axis.file;
    error.message += " (position '" + axis->position.name + "', force '" + axis->force.name + "')";
    return error;
  }
  report::Table table({{.title = "Parameter", .align = report::Column::Align::left},
                       {.title = "Value"},
                       {.title = "95 % from"},
                       {.title = "to"},
                       {.title = "Unit", .align = report::Column::Align::left}});
  for (const Term& row : rows_of(*model, axis->rotary)) {
    table.add_row({row.name, report::number(row.estimate.value, 4), report::number(row.estimate.lower, 4),
                   report::number(row.estimate.upper, 4), row.unit});
  }
  const std::string text = "Explains " + report::number(100.0 * model->explained, 3) + " % of the force; position " +
                           axis->position.name + ", force " + axis->force.name + ".\n\n" + table.to_text();
  return write_outcome(options.axis.output,
                       {.text = text,
                        .json = json_of(*model, *axis, options.axis.file),
                        .html = page_of(*model, *axis, table, command).to_html(),
                        .figures = {}},
                       {{"model.toml", toml_of(*model, *axis, command)}});
}

}  // namespace

void add_identify_inverse(CLI::App& identify, const std::string& name, const std::string& command, int& status) {
  auto options = std::make_shared<InverseOptions>();
  CLI::App* verb = identify.add_subcommand("inverse", "Identify the inverse dynamics of one axis from a recording");
  options->axis.output.own_files = {"model.toml"};
  add_axis_options(*verb, options->axis, command);
  verb->add_option("--cutoff-Hz", options->cutoff_Hz, "Cutoff of the zero-phase filter")->type_name("HZ");
  verb->callback([options, name, &command, &status] {
    if (const auto error = identify_inverse(*options, command)) {
      status = report_error(name, *error);
    }
  });
}

}  // namespace tactus::cli
