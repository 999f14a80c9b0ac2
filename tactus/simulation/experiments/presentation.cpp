// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/json.hpp>
#include <tactus/kernel/core/version.hpp>
#include <tactus/simulation/experiments/presentation.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <utility>

#include <nlohmann/json.hpp>

namespace tactus::experiments {

report::Axis axis_of(std::string_view key) {
  const std::string_view name = key_of(key);
  const Unit unit = unit_at_end_of(name);
  std::string words(name.substr(0, name.size() - std::string_view(unit.suffix).size()));
  std::replace(words.begin(), words.end(), '_', ' ');
  return {.label = words, .unit = unit.symbol};
}

std::vector<report::Column> settings_columns(const Settings& settings) {
  std::vector<report::Column> columns;
  for (const auto& [key, value] : settings) {
    const report::Axis axis = axis_of(key);
    columns.push_back({axis.label, axis.unit, report::Column::Align::left});
  }
  return columns;
}

std::vector<std::string> settings_cells(const Settings& settings) {
  std::vector<std::string> cells;
  for (const auto& [key, value] : settings) cells.push_back(value);
  return cells;
}

std::optional<double> as_number(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::string settings_json(const Settings& settings) {
  auto object = nlohmann::ordered_json::object();
  for (const auto& [key, value] : settings) {
    const auto parsed = report::parse_json<nlohmann::ordered_json>(value);
    object[key] = parsed.is_number() || parsed.is_boolean() ? parsed : nlohmann::ordered_json(value);
  }
  return report::json_line(object);
}

std::string settings_caption(const Settings& settings) {
  std::string caption;
  for (const auto& [key, value] : settings) {
    const report::Axis axis = axis_of(key);
    if (!caption.empty()) caption += ", ";
    caption += axis.label + " " + value;
    if (!axis.unit.empty()) caption += " " + axis.unit;
  }
  return caption;
}

std::string gain_limit_text(const GainLimit& limit, double lowest_gain) {
  if (limit.gain == 0.0) return "< " + report::number(lowest_gain, 3);
  return (limit.beyond_search ? "≥ " : "") + report::number(limit.gain, 3);
}

std::string settled_combinations(std::size_t combinations, const std::vector<std::string>& failures) {
  constexpr std::size_t most = 6;  // that are named
  std::string text =
      std::to_string(combinations - failures.size()) + " of " + std::to_string(combinations) + " combinations settle";
  for (std::size_t i = 0; i < std::min(most, failures.size()); ++i) {
    text += (i == 0 ? "; these do not: " : "; ") + failures[i];
  }
  if (failures.size() > most) text += " and " + std::to_string(failures.size() - most) + " more";
  return text + ".";
}

report::Table table_of_runs(const Settings& varied, std::vector<report::Column> columns, std::string caption) {
  std::vector<report::Column> all = settings_columns(varied);
  std::move(columns.begin(), columns.end(), std::back_inserter(all));
  return report::Table(std::move(all), std::move(caption));
}

void add_row(report::Table& table, const Settings& settings, std::vector<std::string> cells) {
  std::vector<std::string> all = settings_cells(settings);
  std::move(cells.begin(), cells.end(), std::back_inserter(all));
  table.add_row(std::move(all));
}

std::string runs_json(const Request& request, const std::vector<std::pair<Settings, std::string>>& runs) {
  nlohmann::ordered_json document{{"experiment", request.name}, {"runs", nlohmann::ordered_json::array()}};
  for (const auto& [settings, members] : runs) {
    nlohmann::ordered_json run{{"set", report::parse_json<nlohmann::ordered_json>(settings_json(settings))}};
    const auto own = report::parse_json<nlohmann::ordered_json>(members);
    if (own.is_object()) {
      run.update(own);
    } else {
      run["not_an_object"] = members;
    }
    document["runs"].push_back(std::move(run));
  }
  return report::json_text(document);
}

std::string metrics_json(const std::vector<std::pair<std::string, double>>& metrics) {
  auto values = nlohmann::ordered_json::object();
  for (const auto& [key, value] : metrics) values[key] = value;  // what is not finite is written as null
  return report::json_line(nlohmann::ordered_json{{"metrics", std::move(values)}});
}

void add_provenance(report::Page& page, const Request& request, std::string_view configuration) {
  page.heading("How to repeat this");
  page.code(request.command, "Command");
  page.folded(configuration, request.variations.empty()
                                 ? "The whole configuration of the run, defaults included"
                                 : "The whole configuration of the first row, defaults included; the other rows differ "
                                   "from it in the varied keys alone");
  page.footer("tactus " + std::string(version()), request.command);
}

Outcome outcome_of(Presentation shown, const Request& request, std::string configuration) {
  add_provenance(shown.page, request, configuration);
  return {.text = std::move(shown.text),
          .json = std::move(shown.json),
          .html = shown.page.to_html(),
          .figures = std::move(shown.figures),
          .traces = {},
          .configuration = std::move(configuration)};
}

}  // namespace tactus::experiments
