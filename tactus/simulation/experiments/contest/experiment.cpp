// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/contest/contest.hpp>
#include <tactus/simulation/experiments/contest/presentation.hpp>
#include <tactus/simulation/experiments/experiment_of.hpp>
#include <tactus/simulation/tasks/work.hpp>

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace tactus::experiments {

namespace {

/// Every method on the same rig: one row for each, and one picture.
class ContestExperiment final : public ExperimentOf<ContestParams> {
  /// Errors besides those of every experiment: `inconsistent` for a varied key.
  Result<Outcome> run(const Request& request, const Progress& progress) const override;
  bool has_tasks() const override { return true; }
};

constexpr std::string_view contest_title = "Every way to keep contact stable, side by side";

/// The file's parameters with what the method sets on top.
Result<ContestParams> read_with(configuration::Document document, const ContestMethod& method) {
  for (const std::string_view setting : method.settings) {
    if (auto error = document.set(setting)) return *std::move(error);
  }
  return document.read<ContestParams>();
}

report::Table settings_table() {
  using Align = report::Column::Align;
  report::Table table({{"method", "", Align::left}, {"set on top of the file", "", Align::left}},
                      "What each method is");
  for (const ContestMethod& method : contest_methods()) {
    std::string settings;
    for (const std::string_view setting : method.settings) {
      settings += (settings.empty() ? "" : ", ") + std::string(setting);
    }
    table.add_row({std::string(method.name), settings});
  }
  return table;
}

report::Page page_of(const Request& request, const std::string& verdict, const report::Table& table,
                     const report::Figure& figure) {
  report::Page page(request.name + ": " + std::string(contest_title));
  page.paragraph(verdict);
  page.paragraph(
      "The same hand taps the same wall through the same devices; only the controllers differ. For each method the "
      "force gain is raised until the taps no longer settle.");
  page.figure(figure);
  page.table(table);
  page.definitions(
      {{"gain limit",
        "Largest force gain up to which every gain that was tried settled, to 2 %: at least 95 % of the taps, the "
        "median within 100 ms plus two round trips. ≥: the search ended there. <: not even its lowest gain settled."},
       {"at … N", "The same with a display that saturates later."},
       {"at … ms", "The same with this delay each way."},
       {"grip × …", "The same with a hand that holds so much firmer or lighter than the model assumes."},
       {"hand error",
        "Spectral error, 20 Hz to 1 kHz, between what the hand should feel (contact force times gain, saturated) and "
        "the force on the hand, median over the taps. If the taps do not settle, it has no meaning."},
       {"effort", "Force of the hand over a reach of 60 mm in 0.5 s that meets nothing, at force gain 1."},
       {"lag", "How much later than the master's motor the slave's tip is half-way on that reach."}});
  page.table(settings_table());
  return page;
}

std::string task_key(const ContestJob& piece) {
  return std::string(contest_methods()[piece.method].name) + ": " + piece.name;
}

Error not_a_piece(const std::string& key) {
  return {.code = ErrorCode::failed,
          .parameter = {},
          .message = "the result of the task '" + key + "' cannot be read: start the job again",
          .place = {}};
}

/// The pieces as tasks, by their keys. `pieces` must outlive the job.
tasks::Job job_of(const std::vector<ContestJob>& pieces, const ContestParams& params) {
  std::string description = "contest\n" + configuration::to_toml(params);
  std::map<std::string, const ContestJob*, std::less<>> by_key;
  for (const ContestJob& piece : pieces) by_key.emplace(task_key(piece), &piece);
  for (const ContestMethod& method : contest_methods()) {
    description += std::string(method.name) + ":";
    for (const std::string_view setting : method.settings) description += " " + std::string(setting);
    description += "\n";
  }
  return {.description = std::move(description), .run = [by_key](std::string_view key) -> Result<std::string> {
            const auto piece = by_key.find(key);
            if (piece == by_key.end()) return not_a_piece(std::string(key));
            return piece->second->run();
          }};
}

Result<Outcome> ContestExperiment::run(const Request& request, const Progress& progress) const {
  if (Check error =
          refuse_variations(request, "the contest varies what it compares by itself: set one value with --set")) {
    return *std::move(error);
  }
  const auto params = request.document.read<ContestParams>();
  if (!params) return params.error();
  std::vector<ContestJob> pieces;
  for (std::size_t method = 0; method < contest_methods().size(); ++method) {
    const auto own = read_with(request.document, contest_methods()[method]);
    if (!own) return own.error();
    auto more = contest_jobs(method, *own);
    if (!more) return request.document.locate(more.error());
    for (ContestJob& piece : *more) pieces.push_back(std::move(piece));
  }
  std::vector<MethodScore> scores(contest_methods().size());
  auto work = tasks::Work::begin(request.place, job_of(pieces, *params));
  if (!work) return work.error();
  if (!work->leads()) return Outcome{};
  if (auto error = work->run(
          {.count = pieces.size(), .key = [&](std::size_t i) { return task_key(pieces[i]); }},
          [&](std::size_t i, std::string_view value, tasks::Origin) -> Check {
            if (pieces[i].take(value, scores[pieces[i].method])) return {};
            return not_a_piece(task_key(pieces[i]));
          },
          progress)) {
    return *std::move(error);
  }

  const report::Table table = contest_table(scores, *params);
  report::Figure figure = contest_figure(scores, *params);
  const std::string verdict = contest_verdict(scores, *params);
  report::Page page = page_of(request, verdict, table, figure);
  return outcome_of({.text = verdict + "\n\n" + table.to_text(),
                     .json = contest_json(request.name, scores, *params),
                     .page = std::move(page),
                     .figures = {std::move(figure)}},
                    request, configuration::to_toml(*params));
}

}  // namespace

std::unique_ptr<const Experiment> contest_experiment() { return std::make_unique<ContestExperiment>(); }

}  // namespace tactus::experiments
