// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/json.hpp>
#include <tactus/simulation/experiments/experiment_of.hpp>
#include <tactus/simulation/experiments/hydraulic_rigid_contact/hydraulic_rigid_contact.hpp>

#include <algorithm>
#include <limits>

#include <nlohmann/json.hpp>

namespace tactus::experiments {

namespace {

constexpr std::string_view hydraulic_rigid_contact_title = "Twice into the end stop without a force sensor";

/// A servo-hydraulic slave driven into its end stop through a sensorless loop (paper B, Fig. 8).
class HydraulicRigidContactExperiment final
    : public SweepOf<HydraulicRigidContactParams, std::vector<RigidContactRun>> {
  Check check(const HydraulicRigidContactParams& params) const override { return experiments::check(params); }
  Result<std::vector<RigidContactRun>> run_one(const HydraulicRigidContactParams& params) const override {
    return run_hydraulic_rigid_contact(params);
  }
  Presentation present(const Request& request, const Runs& cases) const override;
};
using ContactCase = HydraulicRigidContactExperiment::Run;

report::Table table_of(const std::vector<ContactCase>& cases) {
  report::Table table = table_of_runs(cases.front().settings,
                                      {{"inverse model", "", report::Column::Align::left},
                                       {"Tp", "ms"},
                                       {"false force", "N RMS"},
                                       {"press", ""},
                                       {"settled", "", report::Column::Align::left},
                                       {"touches", ""},
                                       {"fed back", "N"},
                                       {"ripple", "N RMS"},
                                       {"estimate after", "ms"},
                                       {"pressure after", "ms"},
                                       {"lead", "ms"}},
                                      std::string(hydraulic_rigid_contact_title));
  for (const ContactCase& one : cases) {
    for (const RigidContactRun& run : one.found) {
      for (std::size_t i = 0; i < run.contacts.size(); ++i) {
        const RigidContact& contact = run.contacts[i];
        add_row(table, one.settings,
                {run.name, run.blocks > 0 ? report::number(1e3 * run.time_constant_s, 3) : std::string("-"),
                 report::number(run.false_force_N, 3), std::to_string(i + 1), contact.settled ? "yes" : "no",
                 std::to_string(contact.touches), report::number(contact.fed_back_N, 3),
                 report::number(contact.ripple_N, 2), report::number(1e3 * contact.estimate_after_s, 3),
                 report::number(1e3 * contact.pressure_after_s, 3),
                 report::number(1e3 * (contact.pressure_after_s - contact.estimate_after_s), 3)});
      }
    }
  }
  return table;
}

/// The most that the manipulator of paper B gives, in N: the one force that the paper names beside its Fig. 8.
constexpr double published_most_N = 20e3;

/// What the two forces end at, and why they are not the same.
std::string why_they_differ(const RigidContactRun& run) {
  const auto both = [&](double RigidContact::*force_N) {
    return report::number(run.contacts[0].*force_N, 3) + " and " + report::number(run.contacts[1].*force_N, 3) + " N";
  };
  return "At the end of the presses the loop feeds back " + both(&RigidContact::fed_back_N) + ", the pressures give " +
         both(&RigidContact::pressure_force_N) + ", and the stop is pressed with " + both(&RigidContact::stop_force_N) +
         ". So the pressures are right: a piston at rest lets even a small current fill its chamber to the "
         "supply's "
         "pressure. The estimate takes current for force, which holds in motion alone: on the stop it shows how far "
         "the "
         "master is ahead, so it grows with the press where the force hardly can.";
}

report::Figure figure_of(const ContactCase& one) {
  report::Figure figure{
      .title = "Two presses onto the end stop",
      .caption =
          "Above: positions of master and slave. Below: the force fed back to the master, and "
          "that of the filtered chamber pressures, divided alike. " +
          why_they_differ(one.found.back()) +
          " In addition to Fig. 8 of Saków et al. the text gives three figures: forces a hundredth of what "
          "they are, at most 20 kN, and an estimate up to 200 ms before the pressures. " +
          settings_caption(one.settings),
      .columns = static_cast<int>(one.found.size()),
      .panels = {},
      .share_x = report::Sharing::in_line,
      .share_y = report::Sharing::in_line};
  const report::Axis time{.label = "time", .unit = "s"};
  for (const RigidContactRun& run : one.found) {
    figure.panels.push_back({.title = run.name,
                             .x = time,
                             .y = {.label = "position", .unit = "m"},
                             .lines = {{.name = "master", .x = run.time_s, .y = run.master_m, .colour = 0},
                                       {.name = "slave", .x = run.time_s, .y = run.slave_m, .colour = 1}},
                             .rules = {}});
  }
  for (const RigidContactRun& run : one.found) {
    figure.panels.push_back(
        {.title = {},
         .x = time,
         .y = {.label = "force", .unit = "N"},
         .lines = {{.name = "from pressures", .x = run.time_s, .y = run.pressure_force_N, .colour = 7},
                   {.name = "fed back", .x = run.time_s, .y = run.fed_back_N, .colour = 2}},
         .rules = {{.at = published_most_N / one.params.task.force_division, .label = "most of Saków et al.'s rig"}}});
  }
  return figure;
}

std::string sentence_of(const ContactCase& one) {
  std::size_t presses = 0, settled = 0;
  double least_lead_s = std::numeric_limits<double>::infinity(), most_lead_s = -least_lead_s;
  for (const RigidContactRun& run : one.found) {
    for (const RigidContact& contact : run.contacts) {
      ++presses;
      settled += contact.settled ? 1U : 0U;
      const double lead_s = contact.pressure_after_s - contact.estimate_after_s;
      least_lead_s = std::min(least_lead_s, lead_s);
      most_lead_s = std::max(most_lead_s, lead_s);
    }
  }
  return std::to_string(settled) + " of " + std::to_string(presses) +
         " presses settle without a force sensor; what is fed back is " + report::number(1e3 * least_lead_s, 3) +
         " to " + report::number(1e3 * most_lead_s, 3) + " ms ahead of the pressures.";
}

std::string json_of(const ContactCase& one) {
  auto variants = nlohmann::ordered_json::array();
  for (const RigidContactRun& run : one.found) {
    auto contacts = nlohmann::ordered_json::array();
    for (const RigidContact& contact : run.contacts) {
      contacts.push_back({{"touched", contact.touched},
                          {"settled", contact.settled},
                          {"touches", contact.touches},
                          {"fed_back_N", contact.fed_back_N},
                          {"ripple_rms_N", contact.ripple_N},
                          {"pressure_force_N", contact.pressure_force_N},
                          {"stop_force_N", contact.stop_force_N},
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
  return report::json_line(nlohmann::ordered_json{{"metrics", {{"variants", variants}}}});
}

Presentation HydraulicRigidContactExperiment::present(const Request& request, const Runs& cases) const {
  const report::Table table = table_of(cases);
  const std::string verdict = verdict_of_each(cases, [](const auto& run) { return sentence_of(run); });
  std::vector<report::Figure> figures;
  for (const ContactCase& one : cases) figures.push_back(figure_of(one));

  report::Page page(request.name + ": " + std::string(hydraulic_rigid_contact_title));
  page.paragraph(verdict);
  page.paragraph(
      "An operator drives a servo-hydraulic slave into its end stop twice. Nothing measures the contact force: an "
      "inverse "
      "model states which valve current free motion would take, and what the current has beyond that is fed back.");
  page.table(table);
  page.definitions(
      {{"false force", "Fed back before the first touch, where there is nothing to feel."},
       {"settled", "In the last 0.3 s of the press the piston stays on its stop and the master within 0.1 mm RMS."},
       {"touches", "How often the piston met the stop during the press."},
       {"estimate after, pressure after",
        "From the first touch until the force fed back, and the force of the filtered "
        "pressures, reach half of what they end at."},
       {"lead", "By how much the estimate is earlier."}});
  for (const report::Figure& figure : figures) page.figure(figure);
  return {.text = verdict + "\n\n" + table.to_text(),
          .json = runs_json(request, cases, [](const auto& run) { return json_of(run); }),
          .page = std::move(page),
          .figures = std::move(figures)};
}

}  // namespace

std::unique_ptr<const Experiment> hydraulic_rigid_contact_experiment() {
  return std::make_unique<HydraulicRigidContactExperiment>();
}

}  // namespace tactus::experiments
