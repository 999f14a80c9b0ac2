// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/arm_tapping/contact_figure.hpp>
#include <tactus/simulation/experiments/arm_tapping/presentation.hpp>
#include <tactus/simulation/experiments/presentation.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace tactus::experiments {

namespace {

constexpr std::string_view arm_tapping_title = "Tapping a surface through two arms";

report::Figure first_tap_figure(const Settings& settings, const std::vector<ArmRecord>& trace, double tick_s) {
  const report::Axis time{.label = "time", .unit = "s"};
  report::Line contact{.name = "on the surface", .x = {}, .y = {}, .colour = 0};
  report::Line hand{.name = "on the hand", .x = {}, .y = {}, .colour = 1};
  report::Line leader{.name = "leader", .x = {}, .y = {}, .colour = 1};
  report::Line follower{.name = "follower", .x = {}, .y = {}, .colour = 0};
  for (std::size_t k = 0; k < trace.size(); ++k) {
    const double now_s = static_cast<double>(k) * tick_s;
    for (report::Line* line : {&contact, &hand, &leader, &follower}) line->x.push_back(now_s);
    contact.y.push_back(trace[k].contact_N);
    hand.y.push_back(trace[k].hand_N);
    leader.y.push_back(1e3 * trace[k].leader_m);
    follower.y.push_back(1e3 * trace[k].follower_m);
  }
  report::Panel forces{
      .title = "", .x = time, .y = {.label = "force", .unit = "N"}, .lines = {contact, hand}, .rules = {}};
  report::Panel heights{.title = "",
                        .x = time,
                        .y = {.label = "tool, out of the surface", .unit = "mm"},
                        .lines = {leader, follower},
                        .rules = {}};
  return {.title = "The first tap",
          .caption = "Force of the surface on the follower's tool and on the hand, and both tools. " +
                     settings_caption(settings),
          .columns = 2,
          .panels = {forces, heights}};
}

}  // namespace

std::vector<report::Figure> arm_figures(const Settings& settings, const ArmTaps& taps, const ArmTrace& first) {
  std::vector<report::Figure> figures{first_tap_figure(settings, first.records, taps.tick_s())};
  if (first.pressing) figures.push_back(contact_figure(taps.setup(), *first.pressing, settings_caption(settings)));
  return figures;
}

report::Table arm_table(const std::vector<ArmTappingRun>& runs) {
  report::Table table = table_of_runs(runs.empty() ? Settings{} : runs.front().settings,
                                      {{"taps"},
                                       {"settled", "%"},
                                       {"ring", "%"},
                                       {"run away", "%"},
                                       {"never touch", "%"},
                                       {"ring at gain 0", "%"},
                                       {"contact lost", "ms"},
                                       {"peak", "N"},
                                       {"steady", "N"},
                                       {"felt", "%"},
                                       {"lag", "mm"},
                                       {"effort", "N"},
                                       {"false force", "N"},
                                       {"drift", "mm"},
                                       {"hold", "N"},
                                       {"hold drift", "mm"}},
                                      std::string(arm_tapping_title));
  for (const ArmTappingRun& run : runs) {
    const ArmTappingMetrics& m = run.metrics;
    add_row(table, run.settings,
            {std::to_string(m.taps), report::number(100.0 * m.settled_fraction, 3),
             report::number(100.0 * m.rings_fraction, 3), report::number(100.0 * m.ran_away_fraction, 3),
             report::number(100.0 * m.never_touched_fraction, 3), report::number(100.0 * m.rings_at_gain_0_fraction, 3),
             report::number(1e3 * m.longest_lost_s, 3), report::number(m.peak_force_N, 3),
             report::number(m.steady_force_N, 3), report::number(100.0 * m.felt_share, 3),
             report::number(1e3 * m.reach.lag_m, 3), report::number(m.reach.effort_N, 3),
             report::number(m.reach.false_force_N, 2), report::number(1e3 * m.reach.drift_m, 2),
             report::number(m.hold.force_N, 2), report::number(1e3 * m.hold.drift_m, 2)});
  }
  return table;
}

std::string arm_json(const Request& request, const std::vector<ArmTappingRun>& runs) {
  return runs_json(request, runs, [](const ArmTappingRun& run) {
    const ArmTappingMetrics& m = run.metrics;
    return metrics_json({{"taps", static_cast<double>(m.taps)},
                         {"settled_fraction", m.settled_fraction},
                         {"rings_fraction", m.rings_fraction},
                         {"ran_away_fraction", m.ran_away_fraction},
                         {"never_touched_fraction", m.never_touched_fraction},
                         {"rings_at_gain_0_fraction", m.rings_at_gain_0_fraction},
                         {"contact_lost_fraction", m.lost_fraction},
                         {"longest_contact_lost_s", m.longest_lost_s},
                         {"peak_force_N", m.peak_force_N},
                         {"steady_force_N", m.steady_force_N},
                         {"residual_rms_N", m.residual_rms_N},
                         {"felt_share", m.felt_share},
                         {"reach_lag_m", m.reach.lag_m},
                         {"reach_effort_N", m.reach.effort_N},
                         {"reach_false_force_N", m.reach.false_force_N},
                         {"reach_drift_m", m.reach.drift_m},
                         {"hold_force_N", m.hold.force_N},
                         {"hold_drift_m", m.hold.drift_m}});
  });
}

namespace {

std::string of_all(const ArmTappingMetrics& m, double share) {
  return std::to_string(std::lround(share * static_cast<double>(m.taps))) + " of " + std::to_string(m.taps) +
         (m.taps == 1 ? " tap" : " taps");
}

/// The first thing that an operator would not put up with, or nothing: whether taps settle comes first, and why not.
std::string first_failure(const ArmTappingMetrics& m) {
  constexpr double may_fail = 1.0 - settles_share;
  if (m.settled_fraction < settles_share) {
    if (m.never_touched_fraction > may_fail) {
      return of_all(m, m.never_touched_fraction) + " never touched the surface";
    }
    if (m.rings_at_gain_0_fraction > may_fail) {
      return of_all(m, m.rings_at_gain_0_fraction) + " already ring at gain 0";
    }
    return of_all(m, std::max(m.rings_fraction, m.ran_away_fraction)) +
           (m.rings_fraction >= m.ran_away_fraction ? " ring" : " run away");
  }
  if (m.lost_fraction > may_fail) {
    return "contact is lost for up to " + report::number(1e3 * m.longest_lost_s, 2) + " ms (at most " +
           report::number(1e3 * most_lost_s, 2) + ") in " + of_all(m, m.lost_fraction);
  }
  if (m.hold.force_N > most_hold_N) {
    return "at rest the hand bears " + report::number(m.hold.force_N, 2) + " N (at most " +
           report::number(most_hold_N, 2) + ")";
  }
  if (m.hold.drift_m > most_hold_m) {
    return "at rest a tool drifts by " + report::number(1e3 * m.hold.drift_m, 2) + " mm (at most " +
           report::number(1e3 * most_hold_m, 2) + ")";
  }
  return {};
}

}  // namespace

std::string arm_verdict(const std::vector<ArmTappingRun>& runs) {
  if (runs.empty()) return "No tap came to its end.";
  if (runs.size() == 1) {
    const ArmTappingMetrics& m = runs.front().metrics;
    const std::string failure = first_failure(m);
    return (m.settled_fraction >= settles_share ? "Settled: " : "Not settled: ") + of_all(m, m.settled_fraction) +
           " settled" + (failure.empty() ? "." : "; " + failure + ".");
  }
  std::vector<std::string> failures, others;
  for (const ArmTappingRun& run : runs) {
    const std::string failure = first_failure(run.metrics);
    if (failure.empty()) continue;
    (run.metrics.settled_fraction < settles_share ? failures : others)
        .push_back(settings_caption(run.settings) + " (" + failure + ")");
  }
  std::string text = settled_combinations(runs.size(), failures);
  constexpr std::size_t most = 3;  // that are named
  for (std::size_t i = 0; i < std::min(most, others.size()); ++i) {
    text += (i == 0 ? " Settled, but: " : "; ") + others[i];
  }
  if (others.size() > most) text += " and " + std::to_string(others.size() - most) + " more";
  return others.empty() ? text : text + ".";
}

report::Page arm_page(const Request& request, const std::string& verdict, const report::Table& table,
                      const std::vector<report::Figure>& figures) {
  report::Page page(request.name + ": " + std::string(arm_tapping_title));
  page.paragraph(verdict);
  page.paragraph(
      "An operator holds the leader's tool, moves to a stiff surface, and presses; the follower's tool meets it. Each "
      "row "
      "is an ensemble of taps that differ in speed, depth and errors of the controller's model. Simulated.");
  page.table(table);
  page.definitions(
      {{"settled", "Share of the taps that touch, and neither ring nor run away. A combination settles with 95 %."},
       {"ring",
        "After 150 ms from first touch some 50 ms hold more force above 15 Hz than a sine of a tenth of the peak."},
       {"run away",
        "The peak exceeds 1.6 times that of the same tap at gain 0 by more than 1 N, the force in the end twice that, "
        "or a tool left its place by 300 mm."},
       {"never touch", "Share of the taps in which the follower's tool never met the surface."},
       {"ring at gain 0",
        "Share of the taps that ring without any displayed force, which no force gain is the cause of."},
       {"contact lost", "Longest time without contact after 150 ms from first touch, of all taps; 50 ms at most."},
       {"peak, steady", "Contact force, largest and mean of the last 100 ms; medians over the taps."},
       {"felt", "Force above 15 Hz on the hand's spring and damper over that of the contact, RMS; median."},
       {"lag",
        "In free motion, a reach of 200 mm in 0.75 s that meets nothing: farthest of the follower's tool from where "
        "the "
        "leader leads it."},
       {"effort", "Force of the hand's spring and damper along that reach, RMS."},
       {"false force", "Force that the follower sends in it although nothing is touched, at the leader's tool, RMS."},
       {"drift", "Farthest in it of the command from where the leader is, by cancellation."},
       {"hold, hold drift",
        "The operator holds still in the air (task.hold_s): force of the hand's spring and damper, RMS, 1 N at most, "
        "and the farthest of either tool from where it began, 3 mm at most; the largest of up to four draws of the "
        "errors."}});
  for (const report::Figure& figure : figures) page.figure(figure);
  return page;
}

}  // namespace tactus::experiments
