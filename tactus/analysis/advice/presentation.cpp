// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/advice/presentation.hpp>
#include <tactus/data/configuration/text.hpp>
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/page.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/simulation/experiments/presentation.hpp>
#include <tactus/simulation/experiments/tapping/presentation.hpp>

#include <algorithm>
#include <utility>

#include <nlohmann/json.hpp>

namespace tactus::advice {

namespace {

using Json = nlohmann::ordered_json;
using Align = report::Column::Align;

constexpr std::string_view control_section = "control.";
constexpr double far_below = 0.7;

std::string number(double value) { return format_number(rounded(value)); }

std::string with_unit(double value, const std::string& unit) {
  return number(value) + (unit.empty() ? "" : " " + unit);
}

/// How much more gain there would be without an obstacle, `at least` where the search ended.
std::string more_gain(const Obstacle& obstacle, const Candidate& start) {
  return (obstacle.limit.beyond_search ? "at least " : "") + number(obstacle.limit.gain / start.limit.gain) +
         " times the gain";
}

bool is_control(const std::string& key) { return key.starts_with(control_section); }

/// The method, and that more was given where that is so.
std::string words_of(const Bench& bench, const Candidate& candidate) {
  const bool more = std::any_of(bench.given.begin(), bench.given.end(), [](const std::string& key) {
    return is_control(key) && !key.starts_with("control.model.") && key != "control.force_gain" &&
           key != "control.force_limit_N";
  });
  return candidate.method.words() + (more ? " (in addition to what you gave)" : "");
}

std::string range_of(const Obstacle& obstacle) {
  const auto [lower, upper] = *obstacle.interval_95;
  return number(lower) + " to " + with_unit(upper, obstacle.unit);
}

std::string describe_obstacle(const Obstacle& obstacle) {
  if (obstacle.parameter == all_uncertain) return obstacle.parameter + ", known exactly";
  if (obstacle.interval_95) return obstacle.parameter + ", " + range_of(obstacle) + ", known exactly";
  return obstacle.parameter + ", " + with_unit(*obstacle.instead, obstacle.unit) + " instead of " +
         with_unit(obstacle.value, obstacle.unit);
}

std::string limited_by_text(const Advice& advice) {
  if (const Obstacle* obstacle = largest(advice.obstacles, *advice.start)) {
    return "Limited by " + describe_obstacle(*obstacle) + ": that would allow " + more_gain(*obstacle, *advice.start) +
           ".";
  }
  if (advice.start->censored()) {
    return "Limited by the search, which ends at a force gain of " + number(highest_gain) + ".";
  }
  return "Limited by no single thing of those that were tried.";
}

/// `four times as firm as yours`.
std::string words_of_grip(double factor) {
  if (factor == 1.0) return "as firm as yours";
  if (factor == any_grip[1]) return "a quarter as firm as yours";
  return number(factor) + " times as firm as yours";
}

/// What holds farther than the start in other hands; empty where nothing does.
std::string in_other_hands(const Bench& bench, const Advice& advice) {
  constexpr double worth_naming = 1.2;
  if (!advice.start) return {};
  const auto best =
      std::max_element(advice.alternatives.begin(), advice.alternatives.end(),
                       [](const Candidate& a, const Candidate& b) { return a.first_gain < b.first_gain; });
  if (best == advice.alternatives.end() || best->first_gain <= worth_naming * advice.start->first_gain) return {};
  return "In other hands: " + words_of(bench, *best) + " settles up to " + number(best->first_gain) +
         " in any grip from a quarter to four times as firm as yours.";
}

report::Table table_of(const Bench& bench, const Advice& advice) {
  report::Table table({{"configuration", "", Align::left},
                       {"force gain"},
                       {"first gain"},
                       {"holds up to"},
                       {"display", "N"},
                       {"hand error", "%"},
                       {"effort", "mN"}},
                      "Methods that were tested in full, the advice first");
  const auto add = [&](const Candidate& one) {
    table.add_row({words_of(bench, one), number(one.force_gain), one.first_gain > 0.0 ? number(one.first_gain) : "none",
                   experiments::gain_limit_text(one.limit, lowest_gain), number(one.force_limit_N),
                   one.hand_error ? report::number(100.0 * *one.hand_error, 2) : "–",
                   report::number(1e3 * one.effort_N, 2)});
  };
  if (advice.start) add(*advice.start);
  for (const Candidate& one : advice.alternatives) add(one);
  return table;
}

report::Table settings_table(const experiments::Settings& settings) {
  report::Table table({{"key", "", Align::left}, {"value", "", Align::left}}, "What it sets, as --set takes it");
  for (const auto& [key, value] : settings) table.add_row({key, value});
  return table;
}

std::string basis(const Bench& bench) {
  const std::string taps = "Each gain had to settle on every one of 12 rigs";
  if (bench.knowledge.of_identification()) {
    return taps + " drawn from the intervals in " + report::printable(bench.results.string()) +
           ", and then on 8 others with 20 taps each that no search had seen.\n";
  }
  if (bench.knowledge.stated_error() > 0.0) {
    return taps + " whose model is wrong by up to " + number(100.0 * bench.knowledge.stated_error()) +
           " % (task.model_error; no identification was named), and then on 8 others with 20 taps each that no search "
           "had seen.\n";
  }
  return taps + ", all alike, for nothing is stated as uncertain, and then on 8 others with 20 taps each.\n";
}

Json settings_object(const experiments::Settings& settings) {
  return report::parse_json<Json>(experiments::settings_json(settings));
}

void add_gains(Json& object, const Candidate& candidate) {
  object["force_gain"] = candidate.force_gain;
  if (candidate.censored()) object["force_gain_censored"] = true;
  object["first_gain"] = candidate.first_gain;
  object["first_gain_limited_by_grip"] = candidate.limiting_grip ? Json(*candidate.limiting_grip) : Json(nullptr);
  if (candidate.first_gain == 0.0 || (candidate.censored() && candidate.first_gain == candidate.force_gain)) {
    object["first_gain_censored"] = true;
  }
}

/// As the contest names them.
void add_costs(Json& object, const Candidate& candidate) {
  if (candidate.hand_error) object["spectral_error"] = *candidate.hand_error;
  object["free_space_hand_force_rms_N"] = candidate.effort_N;
}

Json limited_by_json(const Advice& advice) {
  if (!advice.start) return {{"parameter", nullptr}, {"unit", ""}};
  if (const Obstacle* obstacle = largest(advice.obstacles, *advice.start)) {
    Json object{{"parameter", obstacle->parameter}, {"unit", obstacle->unit}};
    if (obstacle->parameter != all_uncertain) object["value"] = obstacle->value;
    if (obstacle->interval_95) object["interval_95"] = *obstacle->interval_95;
    if (obstacle->instead) object["instead"] = *obstacle->instead;
    object["gain_factor"] = rounded(obstacle->limit.gain / advice.start->limit.gain);
    if (obstacle->limit.beyond_search) object["gain_factor_censored"] = true;
    return object;
  }
  Json object{{"parameter", advice.start->censored() ? Json("control.force_gain") : Json(nullptr)}, {"unit", ""}};
  if (advice.start->censored()) {
    object["value"] = highest_gain;
    object["value_censored"] = true;
  }
  return object;
}

Json expected_json(const Advice& advice) {
  if (!advice.start) return Json::object();
  Json object = report::parse_json<Json>(experiments::metrics_json(advice.expected));
  add_costs(object, *advice.start);
  return object;
}

std::string json_of(const Bench& bench, const Advice& advice) {
  Json document{{"advice", sentence(bench, advice)}, {"set", Json::object()}};
  if (advice.start) {
    document["set"] = settings_object(settings_of(bench, *advice.start));
    add_gains(document, *advice.start);
  } else {
    document["force_gain"] = 0.0;
    document["first_gain"] = 0.0;
    document["first_gain_limited_by_grip"] = nullptr;
  }
  document["expected"] = expected_json(advice);
  document["limited_by"] = limited_by_json(advice);
  document["next_measurement"] = next_measurement(bench, advice);
  document["alternatives"] = Json::array();
  for (const Candidate& one : advice.alternatives) {
    Json object{{"set", settings_object(settings_of(bench, one))}};
    add_gains(object, one);
    add_costs(object, one);
    document["alternatives"].push_back(std::move(object));
  }
  return report::json_text(document);
}

}  // namespace

experiments::Settings settings_of(const Bench& bench, const Candidate& candidate) {
  experiments::Settings all;
  const auto has = [&all](const std::string& key) {
    return std::any_of(all.begin(), all.end(), [&key](const auto& one) { return one.first == key; });
  };
  for (const std::string& assignment : bench.set) {
    const std::size_t equals = assignment.find('=');
    const std::string key(configuration::trimmed(std::string_view(assignment).substr(0, equals)));
    if (!is_control(key)) continue;
    std::erase_if(all, [&key](const auto& one) { return one.first == key; });  // the last of a key wins
    all.emplace_back(key, configuration::trimmed(std::string_view(assignment).substr(equals + 1)));
  }
  experiments::Settings found = candidate.method.settings();
  found.emplace_back("control.force_limit_N", format_number(candidate.force_limit_N));
  found.emplace_back("control.force_gain", format_number(candidate.force_gain));
  for (auto& setting : found) {
    if (!has(setting.first) && !bench.given.contains(setting.first)) all.push_back(std::move(setting));
  }
  return all;
}

std::string sentence(const Bench& bench, const Advice& advice) {
  if (!advice.start) {
    const std::string best = advice.alternatives.empty()
                                 ? ""
                                 : "; what holds best is " + words_of(bench, advice.alternatives.front()) + ", up to " +
                                       number(advice.alternatives.front().force_gain);
    if (advice.asked_gain) {
      return "Do not use a force gain of " + number(*advice.asked_gain) + ": nothing that was tried settles there" +
             best + ".";
    }
    return "Do not close this loop as it is: nothing that was tried settles at a force gain of " + number(lowest_gain) +
           " or more with a display of " + number(advice.asked_limit_N) + " N" + best +
           "; soften the wall, lower control.force_limit_N or identify the master.";
  }
  const Candidate& start = *advice.start;
  const std::string with = " with " + words_of(bench, start);
  std::string display;
  if (start.force_limit_N != advice.asked_limit_N) {
    display = "; no gain holds with the display of " + number(advice.asked_limit_N) + " N, so limit it to " +
              number(start.force_limit_N) + " N";
  }
  if (start.first_gain == 0.0) {
    return "Use a force gain of up to " + number(start.force_gain) + with + ", in your own grip alone: in one " +
           words_of_grip(start.limiting_grip.value_or(1.0)) + " no gain of " + number(lowest_gain) +
           " or more settles" + display + ".";
  }
  if (start.first_gain >= start.force_gain) {
    return "Start at a force gain of " + number(start.force_gain) + with +
           ": it holds in any grip from a quarter to four times as firm as yours" + display + ".";
  }
  const std::string limit =
      start.limiting_grip ? " (more does not settle in a grip " + words_of_grip(*start.limiting_grip) + ")" : "";
  return "Start at a force gain of " + number(start.first_gain) + with + limit + " and go up to " +
         number(start.force_gain) + " in your own grip" + display + ".";
}

std::string next_measurement(const Bench& bench, const Advice& advice) {
  if (!advice.start) return "Identify the master first (tactus identify quick).";
  const Candidate& start = *advice.start;
  if (const Obstacle* obstacle = worth_measuring(advice.obstacles, start)) {
    const std::string gain = " would allow " + more_gain(*obstacle, start) + ".";
    const bool all = obstacle->parameter == all_uncertain;
    if (!bench.knowledge.of_identification()) {
      return "Identify the master (tactus identify quick, a minute): " +
             (all ? std::string("an exact model") : "a model with " + obstacle->parameter + " exact") + gain;
    }
    if (all) {
      return "Identify the master again, taken apart (tactus identify isolate): everything known exactly" + gain;
    }
    return "Measure " + obstacle->parameter + ", so far " + range_of(*obstacle) + ": knowing it exactly" + gain;
  }
  if (start.first_gain < far_below * start.force_gain) {
    return "Measure how firmly the people hold it who will use it (tactus identify operator): over grips of a quarter "
           "to four times yours the gain is " +
           (start.first_gain > 0.0 ? number(start.first_gain) : "below " + number(lowest_gain)) + " instead of " +
           number(start.force_gain) + ".";
  }
  return "None: no single number that is uncertain here keeps the gain down.";
}

std::string advice_toml(const Bench& bench, const Advice& advice, const std::string& command) {
  std::string text = "# " + command + "\n# " + report::printable(sentence(bench, advice)) + "\n";
  for (const auto& [key, value] : settings_of(bench, *advice.start)) {
    const bool plain = experiments::as_number(value) || value == "true" || value == "false";
    text += key + " = " + (plain ? value : configuration::toml_string(value)) + "\n";
  }
  return text;
}

Result<experiments::Outcome> present(const Bench& bench, const Advice& advice, const experiments::Request& request) {
  experiments::Settings settings;
  if (advice.start) settings = settings_of(bench, *advice.start);
  configuration::Document document = bench.document;
  for (const auto& [key, value] : settings) {
    if (auto error = document.set(key + "=" + value)) return *std::move(error);
  }
  const auto params = document.read<experiments::TappingParams>();
  if (!params) return params.error();
  const std::string first = sentence(bench, advice), next = next_measurement(bench, advice);
  const report::Table table = table_of(bench, advice), set = settings_table(settings);
  const std::string limit = advice.start ? limited_by_text(advice) : "", others = in_other_hands(bench, advice);
  report::Page page(request.name + ": what to start with");
  page.paragraph(first);
  page.table(set);
  if (!limit.empty()) page.paragraph(limit);
  if (!others.empty()) page.paragraph(others);
  page.paragraph("Next measurement: " + next);
  page.table(table);
  page.paragraph(basis(bench));
  std::string text = first + "\n";
  if (!settings.empty()) text += "\n" + set.to_text();
  if (!limit.empty()) text += "\n" + limit + "\n";
  if (!others.empty()) text += others + "\n";
  text += "Next measurement: " + next + "\n";
  if (advice.start || !advice.alternatives.empty()) text += "\n" + table.to_text();
  text += basis(bench);
  return experiments::outcome_of(
      {.text = std::move(text), .json = json_of(bench, advice), .page = std::move(page), .figures = {}}, request,
      configuration::to_toml(*params));
}

}  // namespace tactus::advice
