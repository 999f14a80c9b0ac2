// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/advice/advise.hpp>
#include <tactus/analysis/advice/arm_presentation.hpp>
#include <tactus/data/configuration/text.hpp>
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/page.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/simulation/experiments/presentation.hpp>

#include <algorithm>
#include <utility>

#include <nlohmann/json.hpp>

namespace tactus::advice {

namespace {

using ArmJson = nlohmann::ordered_json;
using experiments::Settings;

std::string three_digits(double value) { return format_number(rounded(value)); }

std::string two_digits(double value) { return report::number(value, 2); }

std::string share_text(double share) { return report::number(100.0 * share, 3) + " %"; }

std::string words_of(const ArmCandidate& candidate) {
  return candidate.note.empty() ? candidate.method.words() : candidate.note;
}

std::string both_hands(const ArmBench& bench) {
  return bench.hands.size() > 1 ? "in your hand and in a light grip" : "in your hand";
}

/// A value for each hand, as `10.7 / 7`.
template <class Values, class Text>
std::string of_hands(const Values& values, const Text& text) {
  std::string all;
  for (const auto& value : values) all += (all.empty() ? "" : " / ") + text(value);
  return all.empty() ? "–" : all;
}

std::string lags_text(const std::vector<experiments::ArmReach>& reach) {
  return of_hands(reach, [](const auto& one) { return two_digits(1e3 * one.lag_m); });
}

std::string efforts_text(const std::vector<experiments::ArmReach>& reach) {
  return of_hands(reach, [](const auto& one) { return two_digits(one.effort_N); });
}

/// What the start costs and shows.
std::string costs_text(const ArmBench& bench, const ArmAdvice& advice) {
  const ArmCandidate& start = *advice.start;
  return "It costs, " + both_hands(bench) + ", a lag of " + lags_text(start.reach) + " mm where the bare pair has " +
         lags_text(advice.plain) + " mm, and an effort of " + efforts_text(start.reach) + " N where that takes " +
         efforts_text(advice.plain) + " N. Of the contact above 15 Hz the hand feels " +
         of_hands(start.felt, [](double share) { return two_digits(100.0 * share); }) + " %.";
}

const ArmObstacle* largest_of(const ArmAdvice& advice) {
  constexpr double worth_it = 1.05;
  if (advice.obstacles.empty()) return nullptr;
  const ArmObstacle& first = advice.obstacles.front();
  return first.limit.gain > worth_it * advice.start->limit.gain ? &first : nullptr;
}

std::string more_gain(const ArmObstacle& obstacle, const ArmCandidate& start) {
  return (obstacle.limit.beyond_search ? "at least " : "") + three_digits(obstacle.limit.gain / start.limit.gain) +
         " times the gain";
}

std::string limited_text(const ArmBench& bench, const ArmAdvice& advice) {
  const ArmCandidate& start = *advice.start;
  if (start.limit.beyond_search) {
    return "Limited by the search, which ends at a force gain of " + three_digits(highest_arm_gain) + ".";
  }
  std::string text = "Limited at " + three_digits(start.limit.gain) + ".";
  if (advice.fault) {
    text += " A tap " + words_of(bench, advice.fault->where) + ", " + advice.fault->how + " at " +
            three_digits(advice.fault->gain) + ".";
  }
  if (const ArmObstacle* obstacle = largest_of(advice)) {
    return text + " What is most in the way: " + obstacle->words + " would allow " + more_gain(*obstacle, start) + ".";
  }
  return text + " None of the things that were tried in its place would allow more.";
}

std::string next_text(const ArmAdvice& advice) {
  if (!advice.start) return "Identify the arm (tactus identify arm) and see whether its URDF is right.";
  const ArmObstacle* first = largest_of(advice);
  for (const ArmObstacle& one : advice.obstacles) {
    if (first == nullptr || one.set.front().first != "task.model_error") continue;
    if (one.limit.gain <= advice.start->limit.gain) break;
    return "Identify the arm (tactus identify arm): an exact model would allow " + more_gain(one, *advice.start) + ".";
  }
  return "None: an exact model of the arm would allow no more.";
}

report::Table arm_settings_table(const Settings& settings) {
  using Align = report::Column::Align;
  report::Table table({{"key", "", Align::left}, {"value", "", Align::left}}, "What it sets, as --set takes it");
  for (const auto& [key, value] : settings) table.add_row({key, value});
  return table;
}

report::Table tried_table(const ArmAdvice& advice) {
  using Align = report::Column::Align;
  report::Table table({{"configuration", "", Align::left},
                       {"force gain"},
                       {"holds up to"},
                       {"settled", "%"},
                       {"felt", "%"},
                       {"lag", "mm"},
                       {"effort", "N"}},
                      "Methods that were tested in full, the advice first; felt, lag and effort of each hand");
  const auto add = [&](const ArmCandidate& one) {
    table.add_row({words_of(one) + (one.within_costs ? "" : " (costs too much)"), three_digits(one.force_gain),
                   experiments::gain_limit_text(one.limit, lowest_arm_gain),
                   one.taps > 0 ? report::number(100.0 * one.settled_fraction, 3) : "–",
                   of_hands(one.felt, [](double share) { return two_digits(100.0 * share); }), lags_text(one.reach),
                   efforts_text(one.reach)});
  };
  if (advice.start) add(*advice.start);
  for (const ArmCandidate& one : advice.alternatives) add(one);
  return table;
}

report::Table climb_table(const ArmAdvice& advice) {
  using Align = report::Column::Align;
  report::Table table({{"at a gain of"}, {"taken", "", Align::left}, {"taps that fail"}},
                      "How the search went: up from the bare pair, then down in more poses");
  for (const ArmChange& one : advice.climb) {
    table.add_row({three_digits(one.gain), one.words,
                   std::to_string(one.failed) + " of " + std::to_string(one.of) + ", before " +
                       std::to_string(one.failed_before)});
  }
  return table;
}

std::string basis_text(const ArmBench& bench) {
  return "Each gain had to settle 95 % of the taps " + both_hands(bench) +
         ", in several poses and directions, with a model that is wrong by up to " +
         three_digits(100.0 * bench.as_given.task.model_error) +
         " %; the force gain is the largest that did, divided by " + three_digits(reserve) +
         ", and holds, as half of it does, on taps that no search had seen, some in poses new to it. Configurations "
         "that lag by more than " +
         three_digits(1e3 * most_lag_more_m) + " mm beyond the bare pair, or take more than " +
         three_digits(most_effort_factor) + " times its effort, are not advised. Simulated.\n";
}

ArmJson object_of(const Settings& settings) {
  return report::parse_json<ArmJson>(experiments::settings_json(settings));
}

void add_members(ArmJson& object, const ArmCandidate& candidate) {
  object["force_gain"] = candidate.force_gain;
  object["gain_limit"] = candidate.limit.gain;
  if (candidate.limit.censored()) object["gain_limit_censored"] = true;
}

ArmJson expected_of(const ArmBench& bench, const ArmCandidate& candidate) {
  ArmJson object{{"taps", candidate.taps}, {"settled_fraction", candidate.settled_fraction}};
  object["hands"] = ArmJson::array();
  for (std::size_t hand = 0; hand < candidate.reach.size(); ++hand) {
    ArmJson one{{"hand", bench.hands[hand].name}};
    one["felt_share"] = hand < candidate.felt.size() ? ArmJson(candidate.felt[hand]) : ArmJson(nullptr);
    one["reach_lag_m"] = candidate.reach[hand].lag_m;
    one["reach_effort_N"] = candidate.reach[hand].effort_N;
    object["hands"].push_back(std::move(one));
  }
  return object;
}

ArmJson limits_json(const ArmBench& bench, const ArmAdvice& advice) {
  ArmJson object{{"parameter", nullptr}, {"unit", ""}};
  if (!advice.start) return object;
  if (advice.start->limit.beyond_search) {
    object["parameter"] = "control.force_gain";
    object["value"] = highest_arm_gain;
    object["value_censored"] = true;
    return object;
  }
  if (const ArmObstacle* obstacle = largest_of(advice)) {
    object["parameter"] = obstacle->set.front().first;
    object["set"] = object_of(obstacle->set);
    object["gain_factor"] = rounded(obstacle->limit.gain / advice.start->limit.gain);
    if (obstacle->limit.beyond_search) object["gain_factor_censored"] = true;
  }
  if (advice.fault) {
    object["fails_first"] = {{"force_gain", rounded(advice.fault->gain)},
                             {"hand", bench.hands[advice.fault->where.hand].name},
                             {"pose", advice.fault->where.pose},
                             {"direction", name_of(advice.fault->where.direction)},
                             {"how", advice.fault->how}};
  }
  return object;
}

std::string arm_advice_json(const ArmBench& bench, const ArmAdvice& advice) {
  ArmJson document{{"advice", sentence(bench, advice)}, {"set", ArmJson::object()}};
  if (advice.start) {
    document["set"] = object_of(settings_of(bench, *advice.start));
    add_members(document, *advice.start);
    document["expected"] = expected_of(bench, *advice.start);
  } else {
    document["force_gain"] = 0.0;
    document["expected"] = ArmJson::object();
  }
  document["limited_by"] = limits_json(bench, advice);
  document["next_measurement"] = next_text(advice);
  document["alternatives"] = ArmJson::array();
  for (const ArmCandidate& one : advice.alternatives) {
    ArmJson object{{"words", words_of(one)}, {"set", object_of(settings_of(bench, one))}};
    add_members(object, one);
    object["within_costs"] = one.within_costs;
    object["expected"] = expected_of(bench, one);
    document["alternatives"].push_back(std::move(object));
  }
  return report::json_text(document);
}

}  // namespace

Settings settings_of(const ArmBench& bench, const ArmCandidate& candidate) {
  Settings all;
  for (const std::string& assignment : bench.set) {
    const std::size_t equals = assignment.find('=');
    const std::string key(configuration::trimmed(std::string_view(assignment).substr(0, equals)));
    if (!key.starts_with("control.")) continue;
    std::erase_if(all, [&key](const auto& one) { return one.first == key; });  // the last of a key wins
    all.emplace_back(key, configuration::trimmed(std::string_view(assignment).substr(equals + 1)));
  }
  for (auto& setting : candidate.method.settings()) all.push_back(std::move(setting));
  if (!bench.asked_gain) all.emplace_back("control.force_gain", format_number(candidate.force_gain));
  return all;
}

std::string sentence(const ArmBench& bench, const ArmAdvice& advice) {
  if (advice.start) {
    const ArmCandidate& start = *advice.start;
    return "Use a force gain of up to " + three_digits(start.force_gain) + " with " + words_of(start) + ": " +
           share_text(start.settled_fraction) + " of " + std::to_string(start.taps) +
           " taps that no search saw settle " + both_hands(bench) + ".";
  }
  const auto best =
      std::max_element(advice.alternatives.begin(), advice.alternatives.end(),
                       [](const ArmCandidate& a, const ArmCandidate& b) { return a.force_gain < b.force_gain; });
  const std::string most = best != advice.alternatives.end() && best->force_gain > 0.0
                               ? "; what holds best is " + words_of(*best) + ", up to " + three_digits(best->force_gain)
                               : "";
  if (bench.asked_gain) {
    return "Do not use a force gain of " + three_digits(*bench.asked_gain) +
           ": nothing that was tried settles there at a lag and effort that are allowed" + most + ".";
  }
  return "Do not couple these arms so: nothing that was tried settles at a force gain of " +
         three_digits(lowest_arm_gain) + " or more at a lag and effort that are allowed" + most +
         "; soften the follower or the surface.";
}

std::string advice_toml(const ArmBench& bench, const ArmAdvice& advice, const std::string& command) {
  std::string text = "# " + command + "\n# " + report::printable(sentence(bench, advice)) + "\n";
  for (const auto& [key, value] : settings_of(bench, *advice.start)) {
    const bool plain = experiments::as_number(value) || value == "true" || value == "false";
    text += key + " = " + (plain ? value : configuration::toml_string(value)) + "\n";
  }
  return text;
}

Result<experiments::Outcome> present(const ArmBench& bench, const ArmAdvice& advice,
                                     const experiments::Request& request) {
  const Settings settings = advice.start ? settings_of(bench, *advice.start) : Settings{};
  configuration::Document document = bench.document;
  for (const auto& [key, value] : settings) {
    if (auto error = document.set(key + "=" + value)) return *std::move(error);
  }
  const auto params = document.read<experiments::ArmTappingParams>();
  if (!params) return params.error();
  const std::string first = sentence(bench, advice), next = next_text(advice), basis = basis_text(bench);
  const report::Table tried = tried_table(advice), set = arm_settings_table(settings);
  report::Page page(request.name + ": what to start with");
  page.paragraph(first);
  std::string text = first + "\n";
  if (advice.start) {
    const std::string costs = costs_text(bench, advice), limit = limited_text(bench, advice);
    page.paragraph(costs);
    page.table(set);
    page.paragraph(limit);
    text += costs + "\n\n" + set.to_text() + "\n" + limit + "\n";
  }
  page.paragraph("Next measurement: " + next);
  page.table(tried);
  if (!advice.climb.empty()) page.table(climb_table(advice));
  page.paragraph(basis);
  text += "Next measurement: " + next + "\n\n" + tried.to_text() + basis;
  return experiments::outcome_of(
      {.text = std::move(text), .json = arm_advice_json(bench, advice), .page = std::move(page), .figures = {}},
      request, configuration::to_toml(*params));
}

}  // namespace tactus::advice
