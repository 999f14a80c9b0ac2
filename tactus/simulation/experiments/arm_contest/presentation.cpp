// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/simulation/experiments/arm_contest/presentation.hpp>
#include <tactus/simulation/experiments/internal/gain_json.hpp>
#include <tactus/simulation/experiments/presentation.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <nlohmann/json.hpp>

namespace tactus::experiments {

namespace {

using Json = nlohmann::ordered_json;

std::string text_of(const GainLimit& limit, const ArmContestTask& task) {
  return gain_limit_text(limit, task.lowest_gain);
}

std::string name_of_method(std::size_t method) { return std::string(arm_contest_methods()[method].name); }

/// The least of what a method comes to in any hand on a pair.
struct Least {
  GainLimit limit{.gain = std::numeric_limits<double>::infinity()};
  double felt_share_at_limit = std::numeric_limits<double>::infinity();
};

Least least_of(const ArmContest& contest, const std::vector<ArmContestScore>& scores, std::size_t pair,
               std::size_t method) {
  Least least;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    const ArmContestEntry& entry = contest.entries[i];
    if (entry.pair != pair || entry.method != method) continue;
    if (scores[i].limit.gain < least.limit.gain) least.limit = scores[i].limit;
    least.felt_share_at_limit = std::fmin(least.felt_share_at_limit, scores[i].felt_share_at_limit.value_or(0.0));
  }
  return least;
}

}  // namespace

std::string arm_contest_verdict(const ArmContest& contest, const std::vector<ArmContestScore>& scores,
                                const ArmContestTask& task) {
  std::string text;
  for (std::size_t pair = 0; pair < contest.pairs.size(); ++pair) {
    if (pair > 0) text += "\n";
    text += contest.pairs[pair] + ": ";
    const std::vector<std::size_t> winners = arm_contest_winners(contest, scores, pair);
    if (winners.empty()) {
      text += "none settles in every hand.";
      continue;
    }
    const Least least = least_of(contest, scores, pair, winners.front());
    text += "use " + name_of_method(winners.front()) + ": " + percent(least.felt_share_at_limit) +
            " % of the contact above 15 Hz reaches the hand at its limit, a gain of " + text_of(least.limit, task) +
            (contest.hands.size() > 1 ? ", each in the hand that has less" : "");
    for (std::size_t i = 1; i < winners.size(); ++i)
      text += (i == 1 ? "; nearly as much: " : ", ") + name_of_method(winners[i]);
    text += ".";
  }
  return text;
}

report::Table arm_contest_table(const ArmContest& contest, const std::vector<ArmContestScore>& scores,
                                const ArmContestTask& task) {
  using Align = report::Column::Align;
  report::Table table({{"method", "", Align::left},
                       {"arms", "", Align::left},
                       {"hand", "", Align::left},
                       {"gain limit"},
                       {"felt at 1", "%"},
                       {"felt at limit", "%"},
                       {"lag", "mm"},
                       {"effort", "N RMS"}},
                      "The largest force gain that settles, and what the method costs");
  for (std::size_t i = 0; i < scores.size(); ++i) {
    const ArmContestEntry& entry = contest.entries[i];
    const ArmContestScore& score = scores[i];
    table.add_row({name_of_method(entry.method), contest.pairs[entry.pair], contest.hands[entry.hand],
                   text_of(score.limit, task), percent(score.felt_share), percent(score.felt_share_at_limit),
                   report::number(1e3 * score.reach.lag_m, 3), report::number(score.reach.effort_N, 3)});
  }
  return table;
}

report::Figure arm_contest_figure(const ArmContest& contest, const std::vector<ArmContestScore>& scores,
                                  const ArmContestTask& task) {
  std::vector<std::string> names;
  for (std::size_t method = 0; method < arm_contest_methods().size(); ++method) names.push_back(name_of_method(method));
  const std::size_t hands = contest.hands.size();
  const auto bars = [&](std::size_t pair, auto&& length, auto&& label) {
    std::vector<report::Bars> of_hands(hands);
    for (std::size_t hand = 0; hand < hands; ++hand) {
      of_hands[hand].name = contest.hands[hand];
      of_hands[hand].colour = static_cast<int>(hand);
    }
    for (std::size_t i = 0; i < scores.size(); ++i) {
      const ArmContestEntry& entry = contest.entries[i];
      if (entry.pair != pair) continue;
      of_hands[entry.hand].lengths.push_back(length(scores[i]));
      of_hands[entry.hand].labels.push_back(label(scores[i]));
    }
    return of_hands;
  };
  report::Figure figure{.title = "How much force gain each method allows on two arms, and what it costs",
                        .caption = "A good method has long bars in the first two columns and short ones next to them.",
                        .columns = 4,
                        .panels = {},
                        .column_titles = {"largest gain that settles", "felt there", "lag", "effort"},
                        .share_x = report::Sharing::in_line,
                        .share_y = report::Sharing::in_line};
  const auto largest = [&](auto&& length) {
    double most = 0.0;
    for (const ArmContestScore& score : scores) most = std::fmax(most, length(score));
    return most;
  };
  constexpr double room = 1.35;  // for the labels behind the bars
  const auto felt = [](const ArmContestScore& score) {
    return score.felt_share_at_limit ? 100.0 * *score.felt_share_at_limit : std::numeric_limits<double>::quiet_NaN();
  };
  const auto lag = [](const ArmContestScore& score) { return 1e3 * score.reach.lag_m; };
  const auto effort = [](const ArmContestScore& score) { return score.reach.effort_N; };
  const auto two_digits = [](auto&& length) {
    return [length](const ArmContestScore& score) { return report::number(length(score), 2); };
  };
  for (std::size_t pair = 0; pair < contest.pairs.size(); ++pair) {
    const auto add = [&](report::Axis x, std::vector<report::Bars> drawn) {
      figure.panels.push_back({.title = "",
                               .x = std::move(x),
                               .y = {.label = "", .categories = names},
                               .lines = {},
                               .rules = {},
                               .bars = std::move(drawn)});
    };
    add({.label = "force gain",
         .lower = task.lowest_gain,
         .upper = 4.0 * task.highest_gain,
         .scale = report::Axis::Scale::logarithmic},
        bars(
            pair, [](const ArmContestScore& score) { return score.limit.gain; },
            [&](const ArmContestScore& score) { return text_of(score.limit, task); }));
    add({.label = "above 15 Hz", .unit = "%", .upper = room * largest(felt)},
        bars(pair, felt, [&](const ArmContestScore& score) {
          return score.felt_share_at_limit ? percent(score.felt_share_at_limit) : std::string("settles nowhere");
        }));
    add({.label = "tools apart", .unit = "mm", .upper = room * largest(lag)}, bars(pair, lag, two_digits(lag)));
    add({.label = "force", .unit = "N RMS", .upper = room * largest(effort)}, bars(pair, effort, two_digits(effort)));
    figure.row_groups.push_back({.label = contest.pairs[pair], .rows = 1});
  }
  return figure;
}

std::string arm_contest_json(const std::string& experiment, const ArmContest& contest,
                             const std::vector<ArmContestScore>& scores, const ArmContestTask& task) {
  Json document{{"experiment", experiment}, {"lowest_gain", task.lowest_gain}, {"highest_gain", task.highest_gain},
                {"methods", Json::array()}, {"results", Json::array()},        {"use", Json::array()}};
  for (const ArmContestMethod& method : arm_contest_methods()) {
    document["methods"].push_back(
        {{"name", method.name}, {"recommended", method.recommended}, {"set", method.settings}});
  }
  for (std::size_t i = 0; i < scores.size(); ++i) {
    const ArmContestEntry& entry = contest.entries[i];
    Json result{{"arms", contest.pairs[entry.pair]},
                {"hand", contest.hands[entry.hand]},
                {"method", arm_contest_methods()[entry.method].name}};
    result.update(json_of(scores[i].limit));
    result["metrics"] = {{"felt_share", json_of(scores[i].felt_share)},
                         {"felt_share_at_limit", json_of(scores[i].felt_share_at_limit)},
                         {"reach_lag_m", scores[i].reach.lag_m},
                         {"reach_effort_N", scores[i].reach.effort_N}};
    document["results"].push_back(std::move(result));
  }
  for (std::size_t pair = 0; pair < contest.pairs.size(); ++pair) {
    Json methods = Json::array();
    for (const std::size_t method : arm_contest_winners(contest, scores, pair)) {
      methods.push_back(arm_contest_methods()[method].name);
    }
    document["use"].push_back({{"arms", contest.pairs[pair]}, {"methods", methods}});
  }
  return report::json_text(document);
}

}  // namespace tactus::experiments
