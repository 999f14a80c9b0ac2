// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/page.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/identification/axis/force_comparison.hpp>
#include <tactus/interfaces/cli/axis_options.hpp>
#include <tactus/interfaces/cli/commands.hpp>
#include <tactus/interfaces/cli/estimate.hpp>
#include <tactus/interfaces/cli/outcome_files.hpp>
#include <tactus/interfaces/cli/streams.hpp>
#include <tactus/kernel/control/estimators/inverse_model_estimator.hpp>
#include <tactus/kernel/core/version.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace tactus::cli {

namespace {

using identification::AxisRecording;
using identification::FalseForce;
using identification::ForceComparison;

constexpr double comparison_cutoff_Hz = 60.0;
constexpr double shortest_free_motion_s = 0.1;
constexpr const char* signal_file = "estimated_force.csv";
constexpr double settling_s = 0.05;  ///< of the estimator's filters, left out of the figures

struct EstimateOptions {
  AxisOptions axis;
  std::string model;
};

struct Run {
  std::vector<double> force;
  double friction;  ///< of the model: less than this cannot be told from free motion [N or N m]
};

/// One tick after another, as on a servo: no sample sees a later one. The position counts from where it begins, so that
/// the filters start at rest.
Result<Run> run_estimator(const AxisRecording& axis, const std::string& model) {
  const auto document = configuration::Document::load(model);
  if (!document) return document.error();
  const auto params = document->read<control::InverseModelEstimator::Params>();
  if (!params) return params.error();
  auto estimator = control::InverseModelEstimator::make(*params, axis.sample_time);
  if (!estimator) return document->locate(estimator.error());
  Run run{.force = {}, .friction = params->friction.force_N};
  run.force.reserve(axis.position.values.size());
  for (std::size_t i = 0; i < axis.position.values.size(); ++i) {
    run.force.push_back(estimator
                            ->step({.command = axis.force.values[i],
                                    .position = axis.position.values[i] - axis.position.values.front()})
                            .force);
  }
  return run;
}

std::string json_of(const EstimateOptions& options, const AxisRecording& axis, const Run& run,
                    const std::optional<ForceComparison>& comparison, const FalseForce& free, std::size_t skip) {
  using Json = nlohmann::ordered_json;
  const std::string unit = axis.rotary ? "_N_m" : "_N";
  Json document{{"recording", options.axis.file},
                {"model", options.model},
                {"position", axis.position.name},
                {"force", axis.force.name},
                {"sample_time_s", axis.sample_time.value},
                {"samples", run.force.size()},
                {"causal", true},
                {"sign", "force of the environment on the axis, positive toward +position"}};
  double peak = 0.0;
  for (std::size_t i = skip; i < run.force.size(); ++i) peak = std::max(peak, std::abs(run.force[i]));
  document["peak" + unit] = peak;
  if (comparison) {
    document["compared_with"] = axis.measured->name;
    document["comparison_cutoff_Hz"] = comparison_cutoff_Hz;
    document["rmse" + unit] = comparison->rmse;
    document["mean_error" + unit] = comparison->mean_error;
    document["correlation"] = comparison->correlation;
    document["lead_s"] = comparison->lead_s;
  }
  const bool moved_freely = free.duration_s >= shortest_free_motion_s;
  document["free_motion_residual" + unit] = moved_freely ? Json(free.rms) : Json(nullptr);
  document["free_motion_s"] = free.duration_s;
  return report::json_text(document);
}

/// What was read and what was estimated from it, as a recording.
std::string csv_of(const AxisRecording& axis, const Run& run) {
  const std::string unit = axis.rotary ? "_N_m" : "_N";
  const auto place = [&axis](std::size_t i) { return static_cast<double>(i) * axis.sample_time.value; };
  std::string text = (axis.rotary ? "time_s,position_rad,actuator_torque" : "time_s,position_m,actuator_force") + unit +
                     (axis.rotary ? ",estimated_torque" : ",estimated_force") + unit + "\n";
  for (std::size_t i = 0; i < run.force.size(); ++i) {
    text += format_number(place(i)) + "," + format_number(axis.position.values[i]) + "," +
            format_number(axis.force.values[i]) + "," + format_number(run.force[i]) + "\n";
  }
  return text;
}

Check estimate_force(const EstimateOptions& options, const std::string& command) {
  const auto axis = read_axis(options.axis, true);
  if (!axis) return axis.error();
  const auto run = run_estimator(*axis, options.model);
  if (!run) return run.error();
  const auto skip = static_cast<std::size_t>(settling_s / axis->sample_time.value);
  std::optional<ForceComparison> comparison;
  FalseForce free;
  if (axis->measured) {
    auto compared = identification::compare_force(run->force, axis->measured->values, comparison_cutoff_Hz,
                                                  axis->sample_time, skip);
    if (!compared) return compared.error();
    comparison = *std::move(compared);
    const auto found = identification::false_force(run->force, comparison->reference, axis->position.values,
                                                   run->friction, axis->sample_time, skip);
    if (!found) return found.error();
    free = *found;
  }
  const std::string json = json_of(options, *axis, *run, comparison, free, skip);

  const std::string unit = axis->rotary ? "N m" : "N";
  std::string text = "Estimated " + std::to_string(run->force.size()) + " samples, causal";
  if (comparison) {
    text += "; against " + axis->measured->name + ": RMSE " + report::number(comparison->rmse, 3) + " " + unit +
            ", correlation " + report::number(comparison->correlation, 4) + ", lead " +
            report::number(1e3 * comparison->lead_s, 2) + " ms";
  } else {
    text += "; name a measured force with --compare to judge it";
  }
  report::Page page("Estimated force, " + options.axis.file);
  page.paragraph(text + ".");
  report::Panel panel{.title = "Force of the environment on the axis",
                      .x = {.label = "time", .unit = "s"},
                      .y = {.label = "force", .unit = unit},
                      .lines = {},
                      .rules = {}};
  std::vector<double> time_s;
  for (std::size_t i = 0; i < run->force.size(); ++i)
    time_s.push_back(static_cast<double>(i) * axis->sample_time.value);
  if (comparison) panel.lines.push_back({.name = "measured, zero-phase", .x = time_s, .y = comparison->reference});
  panel.lines.push_back({.name = "estimated, causal", .x = time_s, .y = run->force, .colour = 1});
  page.figure({.title = "Force", .caption = "Estimate from command and position alone.", .panels = {panel}});
  page.footer("tactus " + std::string(version()), command);
  return write_outcome(options.axis.output, {.text = text + "\n", .json = json, .html = page.to_html(), .figures = {}},
                       {{signal_file, csv_of(*axis, *run)}});
}

}  // namespace

void add_estimate(CLI::App& app, const std::string& command, int& status) {
  auto options = std::make_shared<EstimateOptions>();
  CLI::App* estimate = app.add_subcommand("estimate", "Estimate forces and torques that no sensor measures");
  estimate->require_subcommand(1);
  add_estimate_torque(*estimate, app.get_name(), command, status);
  CLI::App* verb = estimate->add_subcommand("force", "Estimate the force of the environment from command and position");
  add_axis_options(*verb, options->axis, command);
  options->axis.output.own_files = {signal_file};
  verb->get_option("--out")->description("Folder for " + std::string(signal_file) + ", report.html and results.json");
  verb->add_option("--model", options->model, "Model file, written by `identify inverse --out`")->required();
  verb->add_option("--compare", options->axis.roles.measured, "Column of the measured force")->type_name("NAME");
  verb->add_option("--compare-sign", options->axis.roles.measured_sign,
                   "-1 if the file has the force on the environment, not on the axis")
      ->type_name("SIGN")
      ->check(CLI::IsMember({-1.0, 1.0}));
  verb->callback([options, name = app.get_name(), &command, &status] {
    if (const auto error = estimate_force(*options, command)) {
      status = report_error(name, *error);
    }
  });
}

}  // namespace tactus::cli
