#include <tactus/configuration/json_schema.hpp>
#include <tactus/configuration/reference.hpp>
#include <tactus/experiments/force_display/experiment.hpp>
#include <tactus/experiments/force_display/force_display.hpp>
#include <tactus/experiments/presentation.hpp>
#include <tactus/experiments/tapping/tapping.hpp>

#include <nlohmann/json.hpp>

namespace tactus::experiments {

namespace {

constexpr std::string_view force_display_title = "A force displayed to a moving hand";

/// One combination of the varied parameters as it went.
struct DisplayRun {
  Settings settings;
  std::vector<ForceDisplayCase> cases;
  std::vector<ForceDisplayTrace> traces;
};

report::Table table_of(const std::vector<DisplayRun>& runs) {
  using Align = report::Column::Align;
  std::vector<report::Column> columns = settings_columns(runs.front().settings);
  columns.insert(columns.end(), {{"force scale"},
                                 {"model friction", "", Align::left},
                                 {"model", "", Align::left},
                                 {"induced motion", "um RMS"},
                                 {"kept by the estimate", "%"},
                                 {"encoder alone", "%"}});
  report::Table table(columns, std::string(force_display_title) + ": what is left of the induced motion above 20 Hz");
  for (const DisplayRun& run : runs) {
    for (const ForceDisplayCase& one : run.cases) {
      std::vector<std::string> cells = settings_cells(run.settings);
      cells.insert(cells.end(),
                   {report::number(one.scale, 2), name_of(one.friction), one.mismatched ? "mismatched" : "nominal",
                    report::number(1e6 * one.induced_rms_m, 3), report::number(100.0 * one.kept_fraction, 3),
                    report::number(100.0 * one.encoder_fraction, 3)});
      table.add_row(cells);
    }
  }
  return table;
}

std::string json_of(const Request& request, const std::vector<DisplayRun>& runs) {
  nlohmann::ordered_json document{{"experiment", request.name}, {"runs", nlohmann::ordered_json::array()}};
  for (const DisplayRun& run : runs) {
    auto cases = nlohmann::ordered_json::array();
    for (const ForceDisplayCase& one : run.cases) {
      cases.push_back({{"scale", one.scale},
                       {"friction", name_of(one.friction)},
                       {"model", one.mismatched ? "mismatched" : "nominal"},
                       {"induced_rms_m", one.induced_rms_m},
                       {"kept_fraction", one.kept_fraction},
                       {"encoder_fraction", one.encoder_fraction}});
    }
    document["runs"].push_back(
        {{"set", nlohmann::ordered_json::parse(settings_json(run.settings))}, {"metrics", {{"cases", cases}}}});
  }
  return document.dump(2) + "\n";
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
                        .columns = static_cast<int>(run.traces.size()),
                        .panels = {},
                        .share_x = report::Sharing::by_quantity,
                        .share_y = report::Sharing::by_quantity};
  const report::Axis time{.label = "time since start of the force", .unit = "ms"};
  for (const ForceDisplayTrace& trace : run.traces) {
    figure.column_titles.push_back("force scale " + report::number(trace.scale, 2));
    figure.panels.push_back({.title = {},
                             .x = time,
                             .y = {.label = "force", .unit = "N"},
                             .lines = {{.name = "displayed force", .x = times(1e3, trace.time_s), .y = trace.force_N}},
                             .rules = {}});
  }
  for (const ForceDisplayTrace& trace : run.traces) {
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

std::string page_of(const Request& request, const std::vector<DisplayRun>& runs, const report::Table& table,
                    const std::vector<report::Figure>& figures, std::string_view configuration) {
  report::Page page(request.name + ": " + std::string(force_display_title));
  page.paragraph(
      "While a person moves the handle at constant speed, a force is played that knows nothing of the motion. The "
      "motion "
      "that it induces at the motor is known exactly here, from the same run without the force. The table says how "
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
  add_provenance(page, request, configuration);
  return page.to_html();
}

}  // namespace

std::string ForceDisplayExperiment::schema() const {
  return configuration::json_schema<ForceDisplayParams>("tactus experiment: force-display");
}

std::string ForceDisplayExperiment::reference() const {
  return configuration::reference_beside<ForceDisplayParams, TappingParams>("Experiment `force-display`", "tapping");
}

Result<Outcome> ForceDisplayExperiment::run(const Request& request, const Progress& progress) const {
  const auto cases = prepare_cases<ForceDisplayParams, ForceDisplay>(
      request, [](const ForceDisplayParams& params) { return ForceDisplay::make(params); });
  if (!cases) return cases.error();

  std::vector<DisplayRun> runs;
  for (const auto& [settings, display] : cases->all) {
    runs.push_back({.settings = settings, .cases = display.cases(), .traces = display.traces()});
    progress(static_cast<double>(runs.size()) / static_cast<double>(cases->all.size()));
  }
  const report::Table table = table_of(runs);
  std::vector<report::Figure> figures;
  for (const DisplayRun& run : runs) figures.push_back(figure_of(run));
  std::string html = page_of(request, runs, table, figures, cases->first_configuration);
  return Outcome{
      .text = table.to_text(), .json = json_of(request, runs), .html = std::move(html), .figures = std::move(figures)};
}

}  // namespace tactus::experiments
