// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/json.hpp>
#include <tactus/simulation/experiments/internal/gain_json.hpp>
#include <tactus/simulation/experiments/presentation.hpp>
#include <tactus/simulation/experiments/tapping/presentation.hpp>

#include <cctype>
#include <cmath>

#include <nlohmann/json.hpp>

namespace tactus::experiments {

namespace {
constexpr std::string_view tapping_title = "Tapping a wall through the teleoperator";

/// With the site that supervision stopped first, and why.
std::string verdict_of(const TappingMetrics& metrics) {
  const std::string verdict{name_of(metrics.verdict)};
  if (metrics.verdict != Verdict::stopped) return verdict;
  return verdict + ": " + std::string(name_of(metrics.stopped_by->site)) + ", " +
         std::string(name_of(metrics.stopped_by->cause));
}

}  // namespace

report::Table tapping_table(const std::vector<TappingRun>& runs) {
  report::Table table = table_of_runs(runs.empty() ? Settings{} : runs.front().settings,
                                      {{"taps"},
                                       {"settled", "%"},
                                       {"settling, median", "ms"},
                                       {"settling, p90", "ms"},
                                       {"contacts"},
                                       {"peak force", "N"},
                                       {"residual", "mN RMS"},
                                       {"verdict", "", report::Column::Align::left}},
                                      std::string(tapping_title));
  for (const TappingRun& run : runs) {
    const TappingMetrics& m = run.metrics;
    const auto settling = [](double seconds, bool censored) {
      return (censored ? "> " : "") + report::number(1e3 * seconds, 3);
    };
    add_row(table, run.settings,
            {std::to_string(m.taps), report::number(100.0 * m.settled_fraction, 3),
             settling(m.settling_time_median_s, m.settling_time_median_censored),
             settling(m.settling_time_p90_s, m.settling_time_p90_censored), format_number(m.contacts_median),
             report::number(m.peak_force_N, 3), report::number(1e3 * m.residual_rms_N, 3), verdict_of(m)});
  }
  return table;
}

std::string tapping_verdict(const std::vector<TappingRun>& runs) {
  if (runs.empty()) return "No tap came to its end.";
  if (runs.size() == 1) {
    const TappingMetrics& m = runs.front().metrics;
    const auto settled = std::lround(m.settled_fraction * static_cast<double>(m.taps));
    std::string text = verdict_of(m);
    text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
    text += ": " + std::to_string(settled) + " of " + std::to_string(m.taps) + (m.taps == 1 ? " tap" : " taps") +
            " settled";
    if (!m.settling_time_median_censored) {
      text += ", half of them within " + report::number(1e3 * m.settling_time_median_s, 3) + " ms";
    }
    return text + ".";
  }
  std::vector<std::string> failures;
  for (const TappingRun& run : runs) {
    if (run.metrics.verdict == Verdict::settled) continue;
    failures.push_back(settings_caption(run.settings) + " (" + verdict_of(run.metrics) + ")");
  }
  return settled_combinations(runs.size(), failures);
}

std::string metrics_json(const TappingMetrics& metrics) {
  nlohmann::ordered_json json{{"taps", metrics.taps}};
  json.update(json_of_settling(metrics));
  json.update({{"contacts_median", metrics.contacts_median},
               {"peak_force_N", metrics.peak_force_N},
               {"residual_rms_N", metrics.residual_rms_N},
               {"verdict", name_of(metrics.verdict)}});
  if (metrics.stopped_by) {
    json["stopped"] = metrics.stopped;
    json["stopped_by"] = {{"site", name_of(metrics.stopped_by->site)}, {"cause", name_of(metrics.stopped_by->cause)}};
  }
  return report::json_line(json);
}

std::string tapping_json(const Request& request, const std::vector<TappingRun>& runs) {
  return runs_json(request, runs,
                   [](const TappingRun& run) { return "{\"metrics\":" + metrics_json(run.metrics) + "}"; });
}

report::Page tapping_page(const Request& request, const std::string& verdict, const report::Table& table,
                          const std::vector<report::Figure>& figures) {
  report::Page page(request.name + ": " + std::string(tapping_title));
  page.paragraph(verdict);
  page.paragraph(
      "An operator reaches through the teleoperator onto a wall and presses. The force measured at the slave's tip, "
      "times "
      "the force gain, is displayed to the hand, saturated. Each row of the table is an ensemble of taps that differ "
      "in speed, depth, tremor and model error; each picture shows one of them, the one with the median settling "
      "time.");
  page.table(table);
  page.definitions(
      {{"settling",
        "From first touch until the contact force above 15 Hz stays below a tenth of its peak. A tap that "
        "does not get there enters the quantiles with the whole observation window, marked >."},
       {"contacts", "How often the tip met the wall within the observation window, median."},
       {"peak force", "Largest contact force of a tap, median."},
       {"residual", "RMS of the contact force above 15 Hz over the last 100 ms, median."},
       {"verdict",
        "settled: at least 95 % of the taps settled, the median within 100 ms. limit-cycle: fewer than half "
        "settled. diverged: a safety gate latched or a device left its workspace. stopped: supervision ended a tap; "
        "the site is named, and why. ringing: all else."}});
  for (const report::Figure& figure : figures) page.figure(figure);
  return page;
}

}  // namespace tactus::experiments
