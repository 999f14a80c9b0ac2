// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/arm_contest/arm_contest.hpp>
#include <tactus/simulation/experiments/arm_contest/presentation.hpp>
#include <tactus/simulation/experiments/experiment_of.hpp>
#include <tactus/simulation/teleoperator/parallel.hpp>

#include <filesystem>
#include <string>
#include <utility>

namespace tactus::experiments {

namespace {

constexpr std::string_view arm_contest_title = "Every way to couple two arms, side by side";

/// Every method on every pair of arms in every hand: a row for each, and one picture.
class ArmContestExperiment final : public ExperimentOf<ArmContestParams> {
  /// Errors besides those of every experiment: `inconsistent` for a varied key.
  Result<Outcome> run(const Request& request, const Progress& progress) const override;
};

report::Table arm_methods_table() {
  using Align = report::Column::Align;
  report::Table table({{"method", "", Align::left},
                       {"what it does", "", Align::left},
                       {"based on", "", Align::left},
                       {"set on top", "", Align::left}},
                      "What each method is");
  for (const ArmContestMethod& method : arm_contest_methods()) {
    std::string settings;
    for (const std::string_view setting : method.settings) {
      settings += (settings.empty() ? "" : ", ") + std::string(setting);
    }
    table.add_row({std::string(method.name), std::string(method.explanation),
                   method.recommended ? "the pair as recommended" : "the bare pair", settings});
  }
  return table;
}

report::Page arm_contest_page(const Request& request, const std::string& verdict, const report::Table& table,
                              const report::Figure& figure) {
  report::Page page(request.name + ": " + std::string(arm_contest_title));
  page.paragraph(verdict);
  page.paragraph(
      "The same operator taps the same surface through the same arms; only the controllers differ. For each method the "
      "force gain is raised in steps of √2 until taps no longer settle. Simulated.");
  page.figure(figure);
  page.table(table);
  page.definitions(
      {{"gain limit",
        "Largest force gain up to which every one that was tried settled: at least 95 % of the taps touch, and neither "
        "ring nor run away, as arm-tapping counts. ≥: the search ended there. <: not even its lowest gain settled."},
       {"felt",
        "Force above 15 Hz on the hand's spring and damper over that of the contact, RMS, at gain 1 and at the limit; "
        "median. What does not grow with the gain does not display the contact, however large its limit."},
       {"lag",
        "Farthest of the follower's tool from where the leader's joints would have it, in a reach of 200 mm in 0.75 s "
        "that meets nothing."},
       {"effort", "Force of the hand's spring and damper along that reach, RMS."},
       {"use",
        "The method of which the hand that feels least feels most at its limit; nearly as much: within a factor √2."}});
  page.table(arm_methods_table());
  return page;
}

Result<Outcome> ArmContestExperiment::run(const Request& request, const Progress& progress) const {
  if (Check error =
          refuse_variations(request, "the contest varies what it compares by itself: set one value with --set")) {
    return *std::move(error);
  }
  const auto params = request.document.read<ArmContestParams>();
  if (!params) return params.error();
  const auto contest = make_arm_contest(*params, std::filesystem::path(request.document.name()).parent_path());
  if (!contest) return request.document.locate(contest.error());
  const ArmContestTask& task = params->task;
  std::vector<ArmContestScore> scores(contest->entries.size());
  simulation::for_each_in_parallel(
      scores.size(),
      [&](std::size_t i) { scores[i] = score_of(contest->entries[i].taps, task.lowest_gain, task.highest_gain); },
      progress);

  const report::Table table = arm_contest_table(*contest, scores, task);
  report::Figure figure = arm_contest_figure(*contest, scores, task);
  const std::string verdict = arm_contest_verdict(*contest, scores, task);
  report::Page page = arm_contest_page(request, verdict, table, figure);
  return outcome_of({.text = verdict + "\n\n" + table.to_text(),
                     .json = arm_contest_json(request.name, *contest, scores, task),
                     .page = std::move(page),
                     .figures = {std::move(figure)}},
                    request, configuration::to_toml(*params));
}

}  // namespace

std::unique_ptr<const Experiment> arm_contest_experiment() { return std::make_unique<ArmContestExperiment>(); }

}  // namespace tactus::experiments
