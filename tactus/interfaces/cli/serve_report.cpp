// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/figure.hpp>
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/page.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/interfaces/cli/serve_report.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/simulation/experiments/presentation.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>
#include <tactus/simulation/teleoperator/quantile.hpp>

#include <algorithm>
#include <string>
#include <utility>
#include <variant>

#include <nlohmann/json.hpp>

namespace tactus::cli {

namespace {

using live::LiveVerdict;
using live::SessionHistory;

std::string text_of(const live::ParameterValue& value) {
  if (const auto* number = std::get_if<double>(&value)) return format_number(*number);
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "yes" : "no";
  return std::get<std::string>(value);
}

const char* word_of(LiveVerdict verdict) {
  switch (verdict) {
    case LiveVerdict::settled:
      return "settled";
    case LiveVerdict::rings:
      return "rang";
    case LiveVerdict::contact:
    case LiveVerdict::free:
      break;
  }
  return "too short to judge";
}

/// The contacts of one loop under one setting.
struct Group {
  std::size_t setting;
  std::size_t loop;
  std::vector<const SessionHistory::Contact*> contacts;

  [[nodiscard]] std::size_t how_many(LiveVerdict verdict) const {
    return static_cast<std::size_t>(std::count_if(contacts.begin(), contacts.end(),
                                                  [verdict](const auto* one) { return one->verdict == verdict; }));
  }
  [[nodiscard]] double median(double SessionHistory::Contact::*value) const {
    std::vector<double> values;
    for (const auto* contact : contacts) values.push_back(contact->*value);
    return simulation::quantile(values, 0.5);
  }
};

std::vector<Group> groups_of(const SessionHistory& history) {
  std::vector<Group> groups;
  for (std::size_t setting = 0; setting < history.settings().size(); ++setting) {
    for (std::size_t loop = 0; loop < live::loops; ++loop) {
      Group group{.setting = setting, .loop = loop, .contacts = {}};
      for (const auto& contact : history.contacts()) {
        if (contact.setting == setting && contact.loop == loop) group.contacts.push_back(&contact);
      }
      if (!group.contacts.empty()) groups.push_back(std::move(group));
    }
  }
  return groups;
}

report::Table settings_table(const SessionHistory& history, const std::vector<live::ParameterDescription>& parameters) {
  std::vector<report::Column> columns{{"setting", "", report::Column::Align::left}};
  for (const auto& parameter : parameters) columns.push_back({parameter.label, std::string(parameter.unit.symbol)});
  report::Table table(columns, "What was set, where there was a contact");
  for (std::size_t setting = 0; setting < history.settings().size(); ++setting) {
    const bool used = std::any_of(history.contacts().begin(), history.contacts().end(),
                                  [setting](const auto& contact) { return contact.setting == setting; });
    if (!used) continue;
    std::vector<std::string> cells{std::to_string(setting + 1)};
    for (const auto& parameter : history.settings()[setting]) cells.push_back(text_of(parameter.value));
    table.add_row(cells);
  }
  return table;
}

report::Table contacts_table(const std::vector<Group>& groups) {
  report::Table table({{"setting", "", report::Column::Align::left},
                       {"loop", "", report::Column::Align::left},
                       {"contacts"},
                       {"settled"},
                       {"rang"},
                       {"time to settle, median", "ms"},
                       {"peak at the wall, median", "N"},
                       {"vibration energy, median", "mJ"}},
                      "Contacts");
  for (const Group& group : groups) {
    table.add_row({std::to_string(group.setting + 1), live::loop_names[group.loop],
                   std::to_string(group.contacts.size()), std::to_string(group.how_many(LiveVerdict::settled)),
                   std::to_string(group.how_many(LiveVerdict::rings)),
                   report::number(1e3 * group.median(&SessionHistory::Contact::settling_time_s), 3),
                   report::number(group.median(&SessionHistory::Contact::peak_force_N), 3),
                   report::number(1e3 * group.median(&SessionHistory::Contact::vibration_energy_J), 3)});
  }
  return table;
}

report::Table session_table(const ServeSession& session, const SessionHistory& history) {
  report::Table table({{"", "", report::Column::Align::left}, {"value"}, {"unit", "", report::Column::Align::left}},
                      "Session");
  const auto count = [](std::uint64_t value) { return std::to_string(value); };
  table.add_row({"loops ran", report::number(session.duration_s, 4), "s"});
  table.add_row({"contacts", count(history.contacts().size() + history.forgotten()), ""});
  if (history.forgotten() > 0) table.add_row({"contacts that are only counted", count(history.forgotten()), ""});
  table.add_row({"connections taken", count(session.server.accepted), ""});
  table.add_row({"turned away", count(session.server.turned_away), ""});
  table.add_row({"refused", count(session.server.refused), ""});
  table.add_row({"messages dropped for slow clients", count(session.server.dropped), ""});
  table.add_row({"control cycles that the view missed", count(session.lost_ticks), ""});
  return table;
}

/// Each contact, in the order of time.
report::Figure contacts_figure(const SessionHistory& history) {
  const auto panel = [&history](const char* label, const char* unit, double scale,
                                double SessionHistory::Contact::*value) {
    report::Panel drawn{.title = {},
                        .x = {.label = "time of the touch", .unit = "s"},
                        .y = {.label = label, .unit = unit, .lower = 0.0},
                        .lines = {},
                        .rules = {}};
    for (std::size_t loop = 0; loop < live::loops; ++loop) {
      report::Line line{.name = live::loop_names[loop], .x = {}, .y = {}, .colour = static_cast<int>(loop)};
      for (const auto& contact : history.contacts()) {
        if (contact.loop != loop) continue;
        line.x.push_back(contact.time_s);
        line.y.push_back(scale * contact.*value);
      }
      drawn.lines.push_back(std::move(line));
    }
    return drawn;
  };
  report::Figure figure{
      .title = "Contact by contact",
      .caption =
          "Each corner of a line is a contact of that loop. Time to settle: until the contact force above 15 Hz "
          "stays below a tenth of its peak; above the dashed line a contact counts as one that rings. Vibration "
          "energy: what the motor gave to the handle above 15 Hz, from the touch to the end of the verdict.",
      .columns = 1,
      .panels = {panel("time to settle", "ms", 1e3, &SessionHistory::Contact::settling_time_s),
                 panel("peak at the wall", "N", 1.0, &SessionHistory::Contact::peak_force_N),
                 panel("vibration energy", "mJ", 1e3, &SessionHistory::Contact::vibration_energy_J)},
      .share_x = report::Sharing::in_line};
  figure.panels.front().rules.push_back({.direction = report::Rule::Direction::horizontal,
                                         .at = 1e3 * experiments::settled_within_s,
                                         .label = "rings above"});
  return figure;
}

std::string json_of(const ServeSession& session, const SessionHistory& history) {
  nlohmann::ordered_json settings = nlohmann::ordered_json::array();
  for (const auto& setting : history.settings()) {
    nlohmann::ordered_json values = nlohmann::ordered_json::object();
    for (const auto& parameter : setting) {
      std::visit([&](const auto& value) { values[parameter.name] = value; }, parameter.value);
    }
    settings.push_back(std::move(values));
  }
  nlohmann::ordered_json contacts = nlohmann::ordered_json::array();
  for (const auto& contact : history.contacts()) {
    contacts.push_back({{"loop", live::loop_names[contact.loop]},
                        {"setting", contact.setting},
                        {"time_s", contact.time_s},
                        {"verdict", word_of(contact.verdict)},
                        {"settling_time_s", contact.settling_time_s},
                        {"peak_force_N", contact.peak_force_N},
                        {"vibration_energy_J", contact.vibration_energy_J}});
  }
  const nlohmann::ordered_json document{{"duration_s", session.duration_s},
                                        {"connections", session.server.accepted},
                                        {"turned_away", session.server.turned_away},
                                        {"refused", session.server.refused},
                                        {"dropped_messages", session.server.dropped},
                                        {"lost_ticks", session.lost_ticks},
                                        {"settings", std::move(settings)},
                                        {"contacts", std::move(contacts)},
                                        {"forgotten_contacts", history.forgotten()}};
  return report::json_text(document);
}

}  // namespace

experiments::Outcome serve_outcome(const ServeSession& session, const SessionHistory& history,
                                   const std::vector<live::ParameterDescription>& parameters,
                                   const experiments::Request& request, std::string_view configuration) {
  const report::Table about = session_table(session, history);
  report::Page page(request.name + ": a live session");
  std::string text;
  std::vector<report::Figure> figures;
  if (!history.contacts().empty()) {
    const report::Table contacts = contacts_table(groups_of(history));
    const report::Table settings = settings_table(history, parameters);
    figures.push_back(contacts_figure(history));
    page.paragraph("The left loop had the method, the right one what it was compared with, under the same hand.");
    page.table(contacts);
    page.figure(figures.back());
    page.table(settings);
    text = contacts.to_text() + "\n" + settings.to_text() + "\n";
  } else {
    page.paragraph("Nobody touched the wall.");
  }
  page.table(about);
  experiments::add_provenance(page, request, configuration);
  return {.text = text + about.to_text(),
          .json = json_of(session, history),
          .html = page.to_html(),
          .figures = std::move(figures),
          .traces = {},
          .configuration = std::string(configuration)};
}

}  // namespace tactus::cli
