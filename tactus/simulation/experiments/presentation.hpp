// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/report/page.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/simulation/experiments/experiment.hpp>
#include <tactus/simulation/experiments/gain_limit.hpp>

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// What the results of every experiment have in common when they are shown.
namespace tactus::experiments {

/// The key's last part as words with its unit where the name ends with one: `stiffness` in `N/m`.
report::Axis axis_of(std::string_view key);
/// A column for each varied key.
std::vector<report::Column> settings_columns(const Settings& settings);
std::vector<std::string> settings_cells(const Settings& settings);
/// `{"control.force_gain": 1, "control.cancellation": "off"}` as text: numbers as numbers, words as words.
std::string settings_json(const Settings& settings);
/// The settings in a few words for a picture: `force gain 3`.
std::string settings_caption(const Settings& settings);
/// The value of a setting if it is a finite number.
std::optional<double> as_number(std::string_view text);

/// A limit with `≥` where the search ended there, and `<` where not even its `lowest_gain` settled.
std::string gain_limit_text(const GainLimit& limit, double lowest_gain);

/// "3 of 5 combinations settle; these do not: force gain 4; ...": `failures` are the captions of those that do not.
std::string settled_combinations(std::size_t combinations, const std::vector<std::string>& failures);

/// What came out, in a sentence for each run, a line each; with the run's settings before it where several were run.
template <class Runs, class Sentence>
std::string verdict_of_each(const Runs& runs, const Sentence& sentence) {
  std::string text;
  for (const auto& run : runs) {
    if (!text.empty()) text += "\n";
    if (!run.settings.empty()) text += settings_caption(run.settings) + ": ";
    text += sentence(run);
  }
  return text;
}

/// A table whose rows begin with the values of the varied keys, as those of `varied` are.
report::Table table_of_runs(const Settings& varied, std::vector<report::Column> columns, std::string caption);
void add_row(report::Table& table, const Settings& settings, std::vector<std::string> cells);

/// `{"experiment": ..., "runs": [{"set": {...}, ...}, ...]}`: each run's settings, and behind them the members of a
/// JSON object, given as text.
std::string runs_json(const Request& request, const std::vector<std::pair<Settings, std::string>>& runs);
template <class Runs, class Members>
std::string runs_json(const Request& request, const Runs& runs, Members&& members) {
  std::vector<std::pair<Settings, std::string>> texts;
  for (const auto& run : runs) texts.emplace_back(run.settings, members(run));
  return runs_json(request, texts);
}

/// `{"metrics": {"settling_time_s": 0.03, ...}}` as text, for `runs_json`. What is not finite becomes null.
std::string metrics_json(const std::vector<std::pair<std::string, double>>& metrics);

/// Ends a page with what is needed to repeat the run: the command, the configuration of its first combination, the
/// version.
void add_provenance(report::Page& page, const Request& request, std::string_view configuration);

/// What a kind shows of its runs.
struct Presentation {
  std::string text;                     ///< tables and sentences for a terminal
  std::string json;                     ///< one document
  report::Page page;                    ///< but for its end, `add_provenance`
  std::vector<report::Figure> figures;  ///< those of the page
};

/// The outcome that is presented so, with the configuration of its first combination.
Outcome outcome_of(Presentation shown, const Request& request, std::string configuration);

}  // namespace tactus::experiments
