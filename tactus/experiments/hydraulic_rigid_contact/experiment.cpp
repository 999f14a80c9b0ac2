#include <tactus/configuration/json_schema.hpp>
#include <tactus/configuration/reference.hpp>
#include <tactus/experiments/hydraulic_rigid_contact/experiment.hpp>
#include <tactus/experiments/hydraulic_rigid_contact/hydraulic_rigid_contact.hpp>
#include <tactus/experiments/presentation.hpp>

#include <nlohmann/json.hpp>

namespace tactus::experiments {

namespace {

constexpr std::string_view hydraulic_rigid_contact_title = "Twice into the end stop without a force sensor";

struct ContactCase {
  Settings settings;
  std::vector<RigidContactRun> runs;
};

report::Table table_of(const std::vector<ContactCase>& cases) {
  std::vector<report::Column> columns = settings_columns(cases.front().settings);
  columns.insert(columns.end(), {{"inverse model", "", report::Column::Align::left},
                                 {"Tp", "ms"},
                                 {"false force", "N RMS"},
                                 {"press", ""},
                                 {"settled", "", report::Column::Align::left},
                                 {"touches", ""},
                                 {"fed back", "N"},
                                 {"ripple", "N RMS"},
                                 {"estimate after", "ms"},
                                 {"pressure after", "ms"},
                                 {"lead", "ms"}});
  report::Table table(columns, std::string(hydraulic_rigid_contact_title));
  for (const ContactCase& one : cases) {
    for (const RigidContactRun& run : one.runs) {
      for (std::size_t i = 0; i < run.contacts.size(); ++i) {
        const RigidContact& contact = run.contacts[i];
        std::vector<std::string> cells = settings_cells(one.settings);
        cells.insert(cells.end(),
                     {run.name, run.blocks > 0 ? report::number(1e3 * run.time_constant_s, 3) : std::string("-"),
                      report::number(run.false_force_N, 3), std::to_string(i + 1), contact.settled ? "yes" : "no",
                      std::to_string(contact.touches), report::number(contact.fed_back_N, 3),
                      report::number(contact.ripple_N, 2), report::number(1e3 * contact.estimate_after_s, 3),
                      report::number(1e3 * contact.pressure_after_s, 3),
                      report::number(1e3 * (contact.pressure_after_s - contact.estimate_after_s), 3)});
        table.add_row(cells);
      }
    }
  }
  return table;
}

report::Figure figure_of(const ContactCase& one) {
  report::Figure figure{.title = "Two presses onto the end stop",
                        .caption =
                            "Above: positions of master and slave. Below: the force fed back to the master, and "
                            "that of the filtered chamber pressures, divided alike. Compare Fig. 8 of Saków et "
                            "al. " +
                            settings_caption(one.settings),
                        .columns = static_cast<int>(one.runs.size()),
                        .panels = {},
                        .share_x = report::Sharing::in_line,
                        .share_y = report::Sharing::in_line};
  const report::Axis time{.label = "time", .unit = "s"};
  for (const RigidContactRun& run : one.runs) {
    figure.panels.push_back({.title = run.name,
                             .x = time,
                             .y = {.label = "position", .unit = "m"},
                             .lines = {{.name = "master", .x = run.time_s, .y = run.master_m, .colour = 0},
                                       {.name = "slave", .x = run.time_s, .y = run.slave_m, .colour = 1}},
                             .rules = {}});
  }
  for (const RigidContactRun& run : one.runs) {
    figure.panels.push_back(
        {.title = {},
         .x = time,
         .y = {.label = "force", .unit = "N"},
         .lines = {{.name = "from pressures", .x = run.time_s, .y = run.pressure_force_N, .colour = 7},
                   {.name = "fed back", .x = run.time_s, .y = run.fed_back_N, .colour = 2}},
         .rules = {}});
  }
  return figure;
}

std::string json_of(const Request& request, const std::vector<ContactCase>& cases) {
  nlohmann::ordered_json document{{"experiment", request.name}, {"runs", nlohmann::ordered_json::array()}};
  for (const ContactCase& one : cases) {
    auto variants = nlohmann::ordered_json::array();
    for (const RigidContactRun& run : one.runs) {
      auto contacts = nlohmann::ordered_json::array();
      for (const RigidContact& contact : run.contacts) {
        contacts.push_back({{"touched", contact.touched},
                            {"settled", contact.settled},
                            {"touches", contact.touches},
                            {"fed_back_N", contact.fed_back_N},
                            {"ripple_rms_N", contact.ripple_N},
                            {"pressure_force_N", contact.pressure_force_N},
                            {"estimate_at_half_after_s", contact.estimate_after_s},
                            {"pressure_at_half_after_s", contact.pressure_after_s},
                            {"lead_s", contact.pressure_after_s - contact.estimate_after_s}});
      }
      variants.push_back({{"estimator", run.name},
                          {"blocks", run.blocks},
                          {"time_constant_s", run.time_constant_s},
                          {"false_force_rms_N", run.false_force_N},
                          {"contacts", contacts}});
    }
    document["runs"].push_back(
        {{"set", nlohmann::ordered_json::parse(settings_json(one.settings))}, {"metrics", {{"variants", variants}}}});
  }
  return document.dump(2) + "\n";
}

}  // namespace

std::string HydraulicRigidContactExperiment::schema() const {
  return configuration::json_schema<HydraulicRigidContactParams>("tactus experiment: hydraulic-rigid-contact");
}

std::string HydraulicRigidContactExperiment::reference() const {
  return configuration::reference_markdown<HydraulicRigidContactParams>("Experiment `hydraulic-rigid-contact`");
}

Result<Outcome> HydraulicRigidContactExperiment::run(const Request& request, const Progress& progress) const {
  const auto prepared = prepare_cases<HydraulicRigidContactParams, HydraulicRigidContactParams>(
      request, [](const HydraulicRigidContactParams& params) -> Result<HydraulicRigidContactParams> {
        if (Check error = check(params)) return *std::move(error);
        return params;
      });
  if (!prepared) return prepared.error();
  std::vector<ContactCase> cases;
  for (const auto& [settings, params] : prepared->all) {
    auto runs = run_hydraulic_rigid_contact(params);
    if (!runs) return blame_variation(request.document.locate(runs.error()), settings);
    cases.push_back({.settings = settings, .runs = *std::move(runs)});
    progress(static_cast<double>(cases.size()) / static_cast<double>(prepared->all.size()));
  }
  const report::Table table = table_of(cases);
  std::vector<report::Figure> figures;
  for (const ContactCase& one : cases) figures.push_back(figure_of(one));

  report::Page page(request.name + ": " + std::string(hydraulic_rigid_contact_title));
  page.paragraph(
      "A person drives a servo-hydraulic slave into its end stop twice. Nothing measures the contact force: an inverse "
      "model says which valve current free motion would take, and what the current has beyond that is fed back.");
  page.table(table);
  page.definitions(
      {{"false force", "Fed back on the way to the first touch, where there is nothing to feel."},
       {"settled", "In the last 0.3 s of the press the piston stays on its stop and the master within 0.1 mm RMS."},
       {"touches", "How often the piston met the stop during the press."},
       {"estimate after, pressure after",
        "From the first touch until the force fed back, and the force of the filtered "
        "pressures, reach half of what they end at."},
       {"lead", "By how much the estimate is earlier."}});
  for (const report::Figure& figure : figures) page.figure(figure);
  add_provenance(page, request, prepared->first_configuration);
  return Outcome{
      .text = table.to_text(), .json = json_of(request, cases), .html = page.to_html(), .figures = std::move(figures)};
}

}  // namespace tactus::experiments
