// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/json.hpp>
#include <tactus/simulation/experiments/experiment_of.hpp>
#include <tactus/simulation/experiments/force_display/force_display.hpp>

#include <algorithm>
#include <tuple>

#include <nlohmann/json.hpp>

namespace tactus::experiments {

namespace {

constexpr std::string_view force_display_title = "A force displayed to a moving hand";

struct Displayed {
  std::vector<ForceDisplayCase> cases;
  std::vector<ForceDisplayTrace> traces;
};

/// A force played to a moving hand: what cancellation leaves of the motion that it induces (paper A, Figs. 4 and 12).
class ForceDisplayExperiment final : public SweepOf<ForceDisplayParams, Displayed> {
  Check check(const ForceDisplayParams& params) const override;
  Result<Displayed> run_one(const ForceDisplayParams& params) const override;
  Presentation present(const Request& request, const Runs& runs) const override;
};
using DisplayRun = ForceDisplayExperiment::Run;

report::Table table_of(const std::vector<DisplayRun>& runs) {
  using Align = report::Column::Align;
  report::Table table =
      table_of_runs(runs.front().settings,
                    {{"force scale"},
                     {"model friction", "", Align::left},
                     {"model", "", Align::left},
                     {"induced motion", "um RMS"},
                     {"kept by the estimate", "%"},
                     {"encoder alone", "%"}},
                    std::string(force_display_title) + ": what is left of the induced motion above 20 Hz");
  for (const DisplayRun& run : runs) {
    for (const ForceDisplayCase& one : run.found.cases) {
      add_row(table, run.settings,
              {report::number(one.scale, 2), name_of(one.friction), one.mismatched ? "mismatched" : "nominal",
               report::number(1e6 * one.induced_rms_m, 3), report::number(100.0 * one.kept_fraction, 3),
               report::number(100.0 * one.encoder_fraction, 3)});
    }
  }
  return table;
}

/// Of the largest force, with the friction law under which a model that is right keeps least.
std::string sentence_of(const DisplayRun& run) {
  const auto& cases = run.found.cases;
  const auto keeps_less = [](const ForceDisplayCase& a, const ForceDisplayCase& b) {
    return std::tuple(-a.scale, a.mismatched, a.kept_fraction) < std::tuple(-b.scale, b.mismatched, b.kept_fraction);
  };
  const ForceDisplayCase& best = *std::min_element(cases.begin(), cases.end(), keeps_less);
  std::string text = "A model that is right leaves " + report::number(100.0 * best.kept_fraction, 3) +
                     " % of the induced motion in the estimate";
  for (const ForceDisplayCase& one : cases) {
    if (one.mismatched && one.scale == best.scale && one.friction == best.friction) {
      text += ", one that is off " + report::number(100.0 * one.kept_fraction, 3) + " %";
    }
  }
  return text + "; no estimate can leave less than the encoder's " + report::number(100.0 * best.encoder_fraction, 3) +
         " %. Force scale " + report::number(best.scale, 2) + ", model friction " + name_of(best.friction) + ".";
}

std::string json_of(const DisplayRun& run) {
  auto cases = nlohmann::ordered_json::array();
  for (const ForceDisplayCase& one : run.found.cases) {
    cases.push_back({{"scale", one.scale},
                     {"friction", name_of(one.friction)},
                     {"model", one.mismatched ? "mismatched" : "nominal"},
                     {"induced_rms_m", one.induced_rms_m},
                     {"kept_fraction", one.kept_fraction},
                     {"encoder_fraction", one.encoder_fraction}});
  }
  return report::json_line(nlohmann::ordered_json{{"metrics", {{"cases", cases}}}});
}

std::vector<double> times(double factor, const std::vector<double>& values) {
  std::vector<double> scaled;
  scaled.reserve(values.size());
  for (const double value : values) scaled.push_back(factor * value);
  return scaled;
}

report::Figure figure_of(const DisplayRun& run) {
  report::Figure figure{.title = "Open-loop display",
                        .caption =
                            "A force is played to a hand that moves at constant speed. Above: the force. Below: "
                            "the motor as measured, the estimate of the intended motion (nominal model, "
                            "friction on total velocity), and the same hand without the force. Compare Figs. 4 "
                            "and 12 of Kuchenbecker and Niemeyer.",
                        .columns = static_cast<int>(run.found.traces.size()),
                        .panels = {},
                        .share_x = report::Sharing::by_quantity,
                        .share_y = report::Sharing::by_quantity};
  const report::Axis time{.label = "time since start of the force", .unit = "ms"};
  for (const ForceDisplayTrace& trace : run.found.traces) {
    figure.column_titles.push_back("force scale " + report::number(trace.scale, 2));
    figure.panels.push_back({.title = {},
                             .x = time,
                             .y = {.label = "force", .unit = "N"},
                             .lines = {{.name = "displayed force", .x = times(1e3, trace.time_s), .y = trace.force_N}},
                             .rules = {}});
  }
  for (const ForceDisplayTrace& trace : run.found.traces) {
    const std::vector<double> time_ms = times(1e3, trace.time_s);
    figure.panels.push_back(
        {.title = {},
         .x = time,
         .y = {.label = "motor position", .unit = "mm"},
         .lines =
             {{.name = "measured", .x = time_ms, .y = times(1e3, trace.measured_m), .colour = 2},
              {.name = "estimate of the intended motion", .x = time_ms, .y = times(1e3, trace.estimate_m), .colour = 1},
              {.name = "without the force",
               .x = time_ms,
               .y = times(1e3, trace.without_m),
               .colour = 7,
               .dash = report::Dash::dashed}},
         .rules = {}});
  }
  return figure;
}

report::Page page_of(const Request& request, const std::string& verdict, const std::vector<DisplayRun>& runs,
                     const report::Table& table, const std::vector<report::Figure>& figures) {
  report::Page page(request.name + ": " + std::string(force_display_title));
  page.paragraph(verdict);
  page.paragraph(
      "While an operator moves the handle at constant speed, a force is played that knows nothing of the motion. The "
      "motion "
      "that it induces at the motor is known exactly here, from the same run without the force. The table shows how "
      "much "
      "of it is left in the estimate of the intended motion, measured position less the model's, above 20 Hz.");
  page.table(table);
  page.definitions(
      {{"induced motion",
        "RMS over the observation window of the motor's true motion less that without the force, "
        "behind a second-order Butterworth high-pass at 20 Hz."},
       {"kept by the estimate", "The same of the estimate less the motion without the force, over the induced motion."},
       {"encoder alone", "The same of the encoder's quantisation error: no estimate can keep less."},
       {"model friction",
        "at-rest: as in the paper, on the induced velocity alone. total-velocity: on intended plus "
        "induced velocity, less the friction that the intended motion meets anyway."},
       {"model", "nominal, or with the errors of task.mismatch."}});
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (!runs[i].settings.empty()) page.heading(settings_caption(runs[i].settings));
    page.figure(figures[i]);
  }
  return page;
}

Check ForceDisplayExperiment::check(const ForceDisplayParams& params) const {
  const auto display = ForceDisplay::make(params);
  return display ? Check{} : Check{display.error()};
}

Result<Displayed> ForceDisplayExperiment::run_one(const ForceDisplayParams& params) const {
  const auto display = ForceDisplay::make(params);
  if (!display) return display.error();
  return Displayed{.cases = display->cases(), .traces = display->traces()};
}

Presentation ForceDisplayExperiment::present(const Request& request, const Runs& runs) const {
  const report::Table table = table_of(runs);
  const std::string verdict = verdict_of_each(runs, [](const auto& run) { return sentence_of(run); });
  std::vector<report::Figure> figures;
  for (const Run& run : runs) figures.push_back(figure_of(run));
  report::Page page = page_of(request, verdict, runs, table, figures);
  return {.text = verdict + "\n\n" + table.to_text(),
          .json = runs_json(request, runs, [](const auto& run) { return json_of(run); }),
          .page = std::move(page),
          .figures = std::move(figures)};
}

}  // namespace

std::unique_ptr<const Experiment> force_display_experiment() { return std::make_unique<ForceDisplayExperiment>(); }

}  // namespace tactus::experiments
