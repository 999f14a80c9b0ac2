// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/json.hpp>
#include <tactus/simulation/experiments/faults/presentation.hpp>
#include <tactus/simulation/experiments/presentation.hpp>

#include <algorithm>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

namespace tactus::experiments {

namespace {

constexpr std::string_view title = "Faults survived";

std::string of(std::int64_t part, std::int64_t whole) { return std::to_string(part) + " of " + std::to_string(whole); }

/// What a loose monitor is there to show is that the runs diverge.
bool as_expected(const FaultTally& tally) {
  return tally.row.monitored ? tally.survived == tally.tried : tally.diverged == tally.tried;
}

report::Table outcome_table(const FaultsShown& shown, const std::vector<FaultTally>& tallies, const std::string& time) {
  using Align = report::Column::Align;
  report::Table table({{"fault", "", Align::left},
                       {"survived"},
                       {"diverged"},
                       {shown.motors_give == "N" ? "peak force" : "peak torque", shown.motors_give},
                       {"energy given", "J"},
                       {"stopped"},
                       {"time to stop, most", "ms"},
                       {"step on resuming", shown.motors_give},
                       {"detected"},
                       {"after", "ticks"}},
                      std::string(title) + " (" + time + " time)");
  for (const FaultTally& tally : tallies) {
    table.add_row({std::string(tally.row.name), of(tally.survived, tally.tried), std::to_string(tally.diverged),
                   report::number(tally.worst.peak_force_N, 3), report::number(tally.worst.given_J, 3),
                   std::to_string(tally.stopped),
                   tally.stopped > 0 ? report::number(1e3 * tally.time_to_stop_most_s, 4) : "-",
                   report::number(tally.worst.resume_step_N, 3), std::to_string(tally.detected),
                   tally.detected > 0 ? report::number(tally.detection_ticks_median, 4) : "-"});
  }
  return table;
}

report::Table harm_table(const std::vector<FaultTally>& tallies, const std::string& time) {
  using Align = report::Column::Align;
  report::Table table({{"fault", "", Align::left},
                       {"master gave", "J"},
                       {"slave gave", "J"},
                       {"handle", "m/s"},
                       {"tool", "m/s"},
                       {"handle strayed", "mm"},
                       {"tool strayed", "mm"},
                       {"on the hand", "N"},
                       {"at the tool", "N"},
                       {"release", "ms"}},
                      "What a fault did until the operator cleared it, at most (" + time + " time)");
  for (const FaultTally& tally : tallies) {
    const SiteHarm &master = tally.worst.master, &slave = tally.worst.slave;
    table.add_row({std::string(tally.row.name), report::number(master.given_J, 3), report::number(slave.given_J, 3),
                   report::number(master.speed_m_per_s, 3), report::number(slave.speed_m_per_s, 3),
                   report::number(1e3 * master.strayed_m, 3), report::number(1e3 * slave.strayed_m, 3),
                   report::number(master.peak_force_N, 3), report::number(slave.peak_force_N, 3),
                   tally.stopped > 0 ? report::number(1e3 * tally.worst.release_s, 4) : "-"});
  }
  return table;
}

/// What is asked of arms besides; no rows where there are none.
report::Table arms_table(const std::vector<FaultTally>& tallies, const std::string& time) {
  using Align = report::Column::Align;
  report::Table table(
      {{"fault", "", Align::left}, {"fastest joint", "% of its limit"}, {"sank", "mm"}, {"fell without power", "mm"}},
      "What became of the arms until the operator cleared it, at most (" + time + " time)");
  for (const FaultTally& tally : tallies) {
    const ArmHarm& arms = *tally.worst.arms;
    table.add_row({std::string(tally.row.name), report::number(100.0 * arms.fastest_joint_share, 3),
                   report::number(1e3 * arms.sank_m, 3), report::number(1e3 * arms.fell_m, 3)});
  }
  return table;
}

report::Table control_table(const std::vector<FaultTally>& controls) {
  using Align = report::Column::Align;
  report::Table table({{"fault", "", Align::left}, {"switched off", "", Align::left}, {"not survived"}},
                      "Controls: the same plans without what defends, which most must not survive");
  for (const FaultTally& tally : controls) {
    table.add_row({std::string(tally.row.name), std::string(tally.row.control.off),
                   of(tally.tried - tally.survived, tally.tried)});
  }
  return table;
}

report::Table rule_table(const std::vector<FaultTally>& tallies, const std::string& time) {
  using Align = report::Column::Align;
  report::Table table({{"fault", "", Align::left},
                       {"not finite"},
                       {"stale applied"},
                       {"steps above rate"},
                       {"above force limit"},
                       {"active without arming"}},
                      "What must never happen, counted over all runs (" + time + " time)");
  for (const FaultTally& tally : tallies) {
    const FaultOutcome& worst = tally.worst;
    table.add_row({std::string(tally.row.name), std::to_string(worst.not_finite), std::to_string(worst.stale_applied),
                   std::to_string(worst.steps_above_rate), std::to_string(worst.forces_above_limit),
                   std::to_string(worst.active_without_arming)});
  }
  return table;
}

/// What the runs that did not survive broke, and the number of the first of them.
std::string failures_text(const FaultTally& tally) {
  std::string text;
  for (const BrokenRule& broken : tally.broken) {
    text += std::string(tally.row.name) + ": " + std::to_string(broken.count) +
            " not survived: " + std::string(broken.rule) + " (first: number " + std::to_string(broken.first) + ").\n";
  }
  return text;
}

/// The trips of the row without a fault.
std::string clean_text(const std::vector<FaultTally>& tallies, const std::string& time) {
  const auto clean = std::find_if(tallies.begin(), tallies.end(),
                                  [](const FaultTally& tally) { return tally.row.kind == FaultKind::none; });
  if (clean == tallies.end()) return {};
  return " Clean data: " + std::to_string(clean->detected) + " trips in " +
         report::number(clean->simulated_s / 3600.0, 3) + " h of " + time + " time.";
}

std::string summary(const FaultsShown& shown, const std::vector<FaultTally>& tallies, const std::string& time) {
  std::int64_t survived = 0, tried = 0;
  std::string text;
  for (const FaultTally& tally : tallies) {
    if (!tally.row.monitored) {
      text += std::string(tally.row.name) + ": must diverge; " + of(tally.diverged, tally.tried) + " did.\n";
      continue;
    }
    survived += tally.survived;
    tried += tally.tried;
    text += failures_text(tally);
  }
  return "Survived " + of(survived, tried) +
         " runs. Rate limit per control cycle: " + report::number(shown.rate_limit_N_per_s / shown.rate_Hz, 3) + " " +
         shown.motors_give + "." + clean_text(tallies, time) + "\n" + text;
}

/// How many controls failed as they must.
std::string control_summary(const std::vector<FaultTally>& controls) {
  std::string text;
  std::int64_t failed = 0;
  for (const FaultTally& tally : controls) {
    failed += tally.fails() ? 1 : 0;
    if (!tally.fails()) text += std::string(tally.row.name) + ": the control survives, so the row shows nothing.\n";
  }
  return of(failed, static_cast<std::int64_t>(controls.size())) +
         " controls failed in half of their runs or more, as they must.\n" + text;
}

/// The runs that were lost at the real clock, and what lost them.
report::Table lost_table(const std::vector<LostInRealTime>& lost, double rate_Hz) {
  report::Table table(
      {{"fault"}, {"number"}, {"rule"}, {"control cycles missed"}, {"in a row", "ms"}, {"with none missed"}},
      "Not survived in real time");
  for (const LostInRealTime& run : lost) {
    table.add_row({std::string(run.row.name), std::to_string(run.failure.number), std::string(run.failure.rule),
                   std::to_string(run.missed_ticks),
                   report::number(1e3 * static_cast<double>(run.longest_gap_ticks) / rate_Hz, 3),
                   run.survives_on_time ? "survived" : "not survived"});
  }
  return table;
}

/// How many of them the clock explains.
std::string lost_text(const std::vector<LostInRealTime>& lost) {
  if (lost.empty()) return {};
  const auto explained =
      std::count_if(lost.begin(), lost.end(), [](const LostInRealTime& run) { return run.survives_on_time; });
  return "Lost by missed control cycles alone: " + of(explained, static_cast<std::int64_t>(lost.size())) +
         ". With none missed such a run survives.\n";
}

using Json = nlohmann::ordered_json;

Json lost_json(const std::vector<LostInRealTime>& lost) {
  Json runs = Json::array();
  for (const LostInRealTime& run : lost) {
    runs.push_back({{"id", run.row.id},
                    {"number", run.failure.number},
                    {"rule", run.failure.rule},
                    {"missed_ticks", run.missed_ticks},
                    {"longest_gap_ticks", run.longest_gap_ticks},
                    {"late_ours", run.late_ours},
                    {"survives_on_time", run.survives_on_time}});
  }
  return runs;
}

Json failures_json(const FaultTally& tally) {
  Json failures = Json::array();
  for (const FaultFailure& failure : tally.failures) {
    failures.push_back({{"number", failure.number}, {"rule", failure.rule}});
  }
  return failures;
}

/// The figures of a described record by their keys.
template <class Harm>
Json json_of(const Harm& harm) {
  Json document = Json::object();
  for_each_signal<Harm>([&](const auto& signal) { document[signal.name] = harm.*signal.member; });
  return document;
}

Json controls_json(const std::vector<FaultTally>& controls) {
  Json rows = Json::array();
  for (const FaultTally& tally : controls) {
    rows.push_back({{"id", tally.row.id},
                    {"fault", tally.row.name},
                    {"off", tally.row.control.off},
                    {"as_expected", tally.fails()},
                    {"tried", tally.tried},
                    {"failed", tally.tried - tally.survived},
                    {"master", json_of(tally.worst.master)},
                    {"slave", json_of(tally.worst.slave)},
                    {"not_survived", failures_json(tally)}});
  }
  return rows;
}

Json json_of(const std::vector<FaultTally>& tallies) {
  Json rows = Json::array();
  for (const FaultTally& tally : tallies) {
    const FaultOutcome& worst = tally.worst;
    rows.push_back({{"id", tally.row.id},
                    {"fault", tally.row.name},
                    {"injected", tally.row.injected},
                    {"expected", tally.row.expected},
                    {"monitor", tally.row.monitored ? "on" : "as loose as its bounds allow"},
                    {"as_expected", as_expected(tally)},
                    {"tried", tally.tried},
                    {"survived", tally.survived},
                    {"diverged", tally.diverged},
                    {"peak_force_N", worst.peak_force_N},
                    {"energy_given_J", worst.given_J},
                    {"stopped", tally.stopped},
                    {"time_to_stop_median_s", tally.time_to_stop_median_s},
                    {"time_to_stop_most_s", tally.time_to_stop_most_s},
                    {"step_on_resuming_N", worst.resume_step_N},
                    {"detected", tally.detected},
                    {"detection_median_ticks", tally.detection_ticks_median},
                    {"detection_most_ticks", tally.detection_ticks_most},
                    {"simulated_s", tally.simulated_s},
                    {"not_finite_outputs", worst.not_finite},
                    {"stale_applied", worst.stale_applied},
                    {"steps_above_rate_limit", worst.steps_above_rate},
                    {"forces_above_limit", worst.forces_above_limit},
                    {"active_without_arming", worst.active_without_arming},
                    {"release_most_s", worst.release_s},
                    {"master", json_of(worst.master)},
                    {"slave", json_of(worst.slave)},
                    {"not_survived", failures_json(tally)}});
    if (worst.arms) rows.back()["arms"] = json_of(*worst.arms);
  }
  return rows;
}

std::string json_of(const Request& request, const FaultsShown& shown, const FaultTable& table,
                    const std::optional<FaultsInRealTime>& real_time) {
  Json document{{"experiment", request.name},
                {"kind", shown.kind},
                {"time", "virtual"},
                {"seeds", shown.seeds},
                {"rate_limit_N_per_tick", shown.rate_limit_N_per_s / shown.rate_Hz},
                {"rows", json_of(table.rows)},
                {"controls", controls_json(table.controls)}};
  if (real_time) {
    document["real_time"] = {{"seeds", real_time->params.task.seeds},
                             {"longest_cut_s", real_time->params.task.longest_cut_s},
                             {"rows", json_of(real_time->tallies)},
                             {"lost", lost_json(real_time->lost)},
                             {"servo", report::parse_json<Json>(real_time->timing_json)}};
  }
  return report::json_text(document);
}

/// Survived runs by fault, in percent.
report::Figure figure_of(const std::vector<FaultTally>& tallies) {
  report::Panel panel{.title = {},
                      .x = {.label = "share of runs", .unit = "%", .lower = 0.0, .upper = 100.0},
                      .y = {.label = "fault"},
                      .lines = {},
                      .rules = {}};
  report::Bars survived{.name = "survived", .lengths = {}}, diverged{.name = "diverged", .lengths = {}, .colour = 1};
  for (const FaultTally& tally : tallies) {
    const auto percent = [&tally](std::int64_t part) {
      return 100.0 * static_cast<double>(part) / static_cast<double>(tally.tried);
    };
    panel.y.categories.emplace_back(tally.row.name);
    survived.lengths.push_back(percent(tally.survived));
    diverged.lengths.push_back(percent(tally.diverged));
  }
  panel.bars = {survived, diverged};
  return {.title = std::string(title),
          .caption =
              "Share of the runs of each fault in which everything that the table asks for was kept, and in "
              "which the master's motor gave more energy than a passive one could.",
          .columns = 1,
          .panels = {panel}};
}

}  // namespace

Outcome present_faults(const Request& request, const FaultsShown& shown, const FaultTable& table,
                       const std::optional<FaultsInRealTime>& real_time) {
  std::vector<report::Figure> figures{figure_of(table.rows)};
  report::Page page(request.name + ": " + std::string(title));
  page.paragraph(shown.subject);
  std::string text;
  const auto add = [&](const std::vector<FaultTally>& rows, const std::string& time) {
    std::vector<report::Table> tables{outcome_table(shown, rows, time), harm_table(rows, time)};
    if (!rows.empty() && rows.front().worst.arms) tables.push_back(arms_table(rows, time));
    tables.push_back(rule_table(rows, time));
    const std::string said = summary(shown, rows, time);
    page.paragraph(said);
    text += said + "\n";
    for (const report::Table& one : tables) {
      page.table(one);
      text += one.to_text() + "\n";
    }
  };
  add(table.rows, "virtual");
  if (!table.controls.empty()) {
    const report::Table controls = control_table(table.controls);
    const std::string said = control_summary(table.controls);
    page.table(controls);
    page.paragraph(said);
    text += "\n" + controls.to_text() + "\n" + said;
  }
  page.figure(figures.front());
  if (real_time) {
    page.heading("In real time");
    text += "\n";
    add(real_time->tallies, "real");
    if (!real_time->lost.empty()) {
      const report::Table lost = lost_table(real_time->lost, shown.rate_Hz);
      const std::string said = lost_text(real_time->lost);
      page.table(lost);
      page.paragraph(said);
      text += "\n" + lost.to_text() + "\n" + said;
    }
    for (const report::Table& timing : real_time->timing) {
      page.table(timing);
      text += "\n";
      text += timing.to_text();
    }
  }
  std::vector<std::pair<std::string, std::string>> expected;
  for (const FaultTally& tally : table.rows) {
    expected.emplace_back(tally.row.name, std::string(tally.row.injected) + ": " + std::string(tally.row.expected));
  }
  page.definitions(expected);
  return outcome_of({.text = std::move(text),
                     .json = json_of(request, shown, table, real_time),
                     .page = std::move(page),
                     .figures = std::move(figures)},
                    request, shown.configuration);
}

}  // namespace tactus::experiments
