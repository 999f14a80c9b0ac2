// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/json.hpp>
#include <tactus/simulation/experiments/experiment_of.hpp>
#include <tactus/simulation/experiments/force_estimators/force_estimators.hpp>

#include <algorithm>
#include <utility>

#include <nlohmann/json.hpp>

namespace tactus::experiments {

namespace {

constexpr std::string_view force_estimators_title = "Contact force without a sensor: estimators on the same data";

/// Round-off of a signal that stands still is no noise.
std::string in_millinewton(double force_N, int digits) {
  return force_N < 1e-12 ? "0" : report::number(1e3 * force_N, digits);
}

/// Estimators of contact force on the same data: one row for each.
class ForceEstimatorsExperiment final : public SweepOf<ForceEstimatorsParams, ForceEstimatorsResult> {
  Check check(const ForceEstimatorsParams& params) const override { return experiments::check(params); }
  Result<ForceEstimatorsResult> run_one(const ForceEstimatorsParams& params) const override {
    return compare_force_estimators(params);
  }
  Presentation present(const Request& request, const Runs& runs) const override;
};
using EstimatorsRun = ForceEstimatorsExperiment::Run;

report::Table table_of(const std::vector<EstimatorsRun>& runs) {
  report::Table table = table_of_runs(runs.front().settings,
                                      {{"estimator", "", report::Column::Align::left},
                                       {"error in contact", "mN RMS"},
                                       {"lead", "ms"},
                                       {"false force in free motion", "mN RMS"},
                                       {"noise at rest", "mN RMS"}},
                                      std::string(force_estimators_title));
  for (const EstimatorsRun& run : runs) {
    for (const EstimatorScore& score : run.found.scores) {
      add_row(table, run.settings,
              {score.name, in_millinewton(score.contact_error_N, 3), report::number(1e3 * score.lead_s, 2),
               in_millinewton(score.free_residual_N, 3), in_millinewton(score.rest_noise_N, 2)});
    }
  }
  return table;
}

/// A term as a product: d_0 is the newest difference of positions, u_1 the model's output one lag ago.
std::string words_of(const control::NarxTerm& term) {
  using Variables = control::NarxVariables;
  std::string words;
  for (const std::int64_t variable : {term.variable_1, term.variable_2, term.variable_3}) {
    const auto i = static_cast<std::size_t>(variable);
    if (i == 0) continue;
    if (!words.empty()) words += " ";
    if (i < Variables::first_output) {
      words += "d_" + std::to_string(i - Variables::first_difference);
    } else {
      words += "u_" + std::to_string(i - Variables::first_output + 1);
    }
  }
  return words.empty() ? "1" : words;
}

report::Table narx_table_of(const identification::NarxFit& fit) {
  report::Table table({{"term", "", report::Column::Align::left},
                       {"error reduction", "%"},
                       {"coefficient", "mN"},
                       {"standard error", "mN"}},
                      "NARX model: " + std::to_string(fit.terms.size()) + " of " + std::to_string(fit.candidates) +
                          " terms, on " + std::to_string(fit.rows) + " rows of another motion");
  for (const identification::RankedNarxTerm& term : fit.terms) {
    table.add_row({words_of(term.term), report::number(100.0 * term.error_reduction, 3),
                   report::number(1e3 * term.term.coefficient_N, 3), report::number(1e3 * term.standard_error_N, 2)});
  }
  return table;
}

nlohmann::ordered_json narx_json(const identification::NarxFit& fit) {
  nlohmann::ordered_json terms = nlohmann::ordered_json::array();
  for (const identification::RankedNarxTerm& term : fit.terms) {
    terms.push_back({{"term", words_of(term.term)},
                     {"error_reduction", term.error_reduction},
                     {"coefficient_N", term.term.coefficient_N},
                     {"standard_error_N", term.standard_error_N}});
  }
  return {{"candidates", fit.candidates},           {"rows", fit.rows},
          {"command_rms_N", fit.command_rms_N},     {"residual_rms_N", fit.residual_rms_N},
          {"simulated_rms_N", fit.simulated_rms_N}, {"terms", terms}};
}

/// The true force and what each estimator makes of it, in free motion and in contact.
report::Figure figure_of(const EstimatorsRun& run) {
  const ForceEstimatorsPlan plan = plan_of(run.params.task);
  report::Figure figure{.title = "Estimated and true force",
                        .caption = "Free motion, where every estimate should be 0, and the press onto the wall. " +
                                   settings_caption(run.settings),
                        .columns = 2,
                        .panels = {},
                        .share_y = report::Sharing::in_line};
  const auto line = [&](std::string name, int colour, const std::vector<double>& force_N, double from_s,
                        double until_s) {
    report::Line result{.name = std::move(name), .x = {}, .y = {}, .colour = colour};
    for (std::size_t tick = 0; tick < force_N.size(); ++tick) {
      const double time_s = static_cast<double>(tick) * run.found.run.tick_s;
      if (time_s < from_s || time_s > until_s) continue;
      result.x.push_back(time_s);
      result.y.push_back(force_N[tick]);
    }
    return result;
  };
  for (std::size_t i = 1; i < run.found.scores.size(); ++i) {
    const EstimatorScore& score = run.found.scores[i];
    for (const auto& [from_s, until_s] : {std::pair{plan.rest_s, plan.free_until_s}, {plan.press_s, plan.end_s}}) {
      figure.panels.push_back({.title = score.name,
                               .x = {.label = "time", .unit = "s"},
                               .y = {.label = "force", .unit = "N"},
                               .lines = {line("true", 7, run.found.run.true_N, from_s, until_s),
                                         line("estimated", 0, score.estimate_N, from_s, until_s)},
                               .rules = {}});
    }
  }
  return figure;
}

/// The best without a sensor, in contact and in free motion. The sensor stands first.
std::string sentence_of(const EstimatorsRun& run) {
  const auto& scores = run.found.scores;
  const auto best = [&scores](double EstimatorScore::*error) -> const EstimatorScore& {
    return *std::min_element(scores.begin() + 1, scores.end(),
                             [error](const EstimatorScore& a, const EstimatorScore& b) { return a.*error < b.*error; });
  };
  const EstimatorScore &in_contact = best(&EstimatorScore::contact_error_N),
                       &in_free_motion = best(&EstimatorScore::free_residual_N);
  return "Without a sensor the " + in_contact.name + " is nearest in contact, " +
         report::number(1e3 * in_contact.contact_error_N, 3) + " mN RMS off where the sensor is " +
         report::number(1e3 * scores.front().contact_error_N, 3) + "; the " + in_free_motion.name +
         " has the smallest error where nothing is touched, " +
         report::number(1e3 * in_free_motion.free_residual_N, 3) + " mN RMS.";
}

std::string json_of(const EstimatorsRun& run) {
  nlohmann::ordered_json estimators = nlohmann::ordered_json::array();
  for (const EstimatorScore& score : run.found.scores) {
    estimators.push_back({{"name", score.name},
                          {"contact_error_N", score.contact_error_N},
                          {"lead_s", score.lead_s},
                          {"free_motion_residual_N", score.free_residual_N},
                          {"rest_noise_N", score.rest_noise_N}});
  }
  return report::json_line(nlohmann::ordered_json{{"estimators", estimators}, {"narx", narx_json(run.found.narx)}});
}

Presentation ForceEstimatorsExperiment::present(const Request& request, const Runs& runs) const {
  const report::Table table = table_of(runs);
  const std::string verdict = verdict_of_each(runs, [](const auto& run) { return sentence_of(run); });
  const report::Table narx_table = narx_table_of(runs.front().found.narx);
  report::Figure figure = figure_of(runs.front());
  report::Page page(request.name + ": " + std::string(force_estimators_title));
  page.paragraph(verdict);
  page.paragraph(
      "A slave rests, goes to and fro before a wall, presses onto it and leaves. Every estimator sees the same "
      "commands "
      "and the same encoder; none but the first sees the force sensor. Force is that of the wall on the slave.");
  page.table(table);
  page.definitions(
      {{"error in contact", "To the true force behind a zero-phase low-pass of 200 Hz, from the press to the release."},
       {"lead", "By how much the estimate is ahead of the true force where the two correlate most."},
       {"false force in free motion", "What is estimated while nothing is touched."},
       {"noise at rest", "About the mean, before anything moves."}});
  page.table(narx_table);
  page.definitions({{"term",
                     "Product of d_i, the difference of positions i and i + 1 lags old, and u_i, "
                     "the model's own output i lags ago; each over its scale."},
                    {"error reduction", "Share of the squared force that the term explained when it was chosen."}});
  page.figure(figure);
  return {.text = verdict + "\n\n" + table.to_text() + "\n" + narx_table.to_text(),
          .json = runs_json(request, runs, [](const auto& run) { return json_of(run); }),
          .page = std::move(page),
          .figures = {std::move(figure)}};
}

}  // namespace

std::unique_ptr<const Experiment> force_estimators_experiment() {
  return std::make_unique<ForceEstimatorsExperiment>();
}

}  // namespace tactus::experiments
