#include <tactus/cli/site_report.hpp>
#include <tactus/report/figure.hpp>
#include <tactus/report/page.hpp>
#include <tactus/report/table.hpp>
#include <tactus/report/text.hpp>
#include <tactus/runtime/servo_presentation.hpp>
#include <tactus/simulation/presentation.hpp>

#include <array>
#include <cstdio>

#include <nlohmann/json.hpp>

namespace tactus::cli {

namespace {

double loss_of(const SiteTotals& totals) {
  const auto& link = totals.link;
  return link.expected > 0 ? 1.0 - static_cast<double>(link.arrived) / static_cast<double>(link.expected) : 0.0;
}

std::string standing_of(link::Standing standing, link::HoldCause cause) {
  return standing == link::Standing::active ? "active" : std::string("hold: ").append(name_of(cause));
}

}  // namespace

std::string second_head(const std::string& site) {
  return "The " + site + " runs. " +
         (site == "master" ? "Enter arms it, once the slave is heard; " : "It is armed from the master; ") +
         "Ctrl-C ends.\n  time  standing              round trip      age    loss   force\n"
         "     s                              ms       ms       %       N\n";
}

std::string second_line(const SiteSecond& second) {
  std::array<char, 128> line{};
  std::snprintf(line.data(), line.size(), "%6.0f  %-20s %11.3f %8.3f %7.2f %7.3f\n", second.time_s,
                standing_of(second.standing, second.cause).c_str(), 1e3 * second.round_trip_s, 1e3 * second.age_s,
                100.0 * second.loss_fraction, second.peak_force_N);
  return line.data();
}

namespace {

report::Table site_table(const std::string& site, const SiteTotals& totals) {
  using Align = report::Column::Align;
  const auto count = [](auto value) { return std::to_string(value); };
  const auto ms = [](double seconds) { return report::number(1e3 * seconds, 3); };
  report::Table table({{"", "", Align::left}, {"value"}, {"unit", "", Align::left}}, "The " + site);
  table.add_row({"ran", report::number(totals.duration_s, 4), "s"});
  table.add_row({"active",
                 report::number(static_cast<double>(totals.active_ticks) *
                                    (totals.ticks > 0 ? totals.duration_s / static_cast<double>(totals.ticks) : 0.0),
                                4),
                 "s"});
  table.add_row({"armings", count(totals.armings), ""});
  for (const auto& [cause, name] : enumerators(link::HoldCause{})) {
    const auto holds = totals.holds[static_cast<std::size_t>(cause)];
    if (holds > 0) table.add_row({std::string("holds: ") + name, count(holds), ""});
  }
  table.add_row({"longest silence before a hold", ms(totals.longest_silence_at_hold_s), "ms"});
  table.add_row({"round trip, mean", ms(totals.round_trip_mean_s), "ms"});
  table.add_row({"round trip, longest", ms(totals.round_trip_max_s), "ms"});
  table.add_row({"age of messages, mean", ms(totals.age_mean_s), "ms"});
  table.add_row({"age of messages, oldest", ms(totals.age_max_s), "ms"});
  table.add_row({"messages sent", count(totals.link.sent), ""});
  table.add_row({"messages applied", count(totals.link.inbound.applied), ""});
  table.add_row({"lost on the way here", report::number(100.0 * loss_of(totals), 3), "%"});
  table.add_row({"late, not applied", count(totals.link.inbound.late), ""});
  table.add_row({"repeated, not applied", count(totals.link.inbound.repeated), ""});
  table.add_row({"too old, not applied", count(totals.link.inbound.stale), ""});
  table.add_row({"dropped by the kernel", count(totals.link.dropped), ""});
  table.add_row({"not authentic or malformed", count(totals.link.secure.refused + totals.link.malformed), ""});
  table.add_row({"hand-shakes", count(totals.link.secure.handshakes), ""});
  table.add_row({"old messages applied", count(totals.stale_applied), ""});
  table.add_row({"numbers not finite", count(totals.not_finite), ""});
  table.add_row({"peak force", report::number(totals.peak_force_N, 3), "N"});
  table.add_row({"largest force step in a tick", report::number(totals.largest_force_step_N, 3), "N"});
  table.add_row({"the same, 1 s after arming", report::number(totals.largest_resuming_force_step_N, 3), "N"});
  table.add_row({"force steps above the gate's limit", count(totals.steps_above_limit), ""});
  return table;
}

/// The link and the force, second by second.
report::Figure seconds_figure(const std::vector<SiteSecond>& seconds) {
  const auto line = [&seconds](const char* name, int colour, auto value) {
    report::Line drawn{.name = name, .x = {}, .y = {}, .colour = colour};
    for (const SiteSecond& second : seconds) {
      drawn.x.push_back(second.time_s);
      drawn.y.push_back(value(second));
    }
    return drawn;
  };
  const report::Axis time{.label = "time", .unit = "s"};
  return {.title = "Second by second",
          .caption =
              "What the messages of each second took, how many were lost on the way here, and the largest force of the "
              "motor. Where the site is not active it follows nobody.",
          .columns = 1,
          .panels = {{.title = {},
                      .x = time,
                      .y = {.label = "mean", .unit = "ms", .lower = 0.0},
                      .lines = {line("round trip", 0, [](const SiteSecond& one) { return 1e3 * one.round_trip_s; }),
                                line("age of messages", 1, [](const SiteSecond& one) { return 1e3 * one.age_s; })},
                      .rules = {}},
                     {.title = {},
                      .x = time,
                      .y = {.label = "lost", .unit = "%", .lower = 0.0},
                      .lines = {line("lost", 2, [](const SiteSecond& one) { return 100.0 * one.loss_fraction; })},
                      .rules = {}},
                     {.title = {},
                      .x = time,
                      .y = {.label = "peak force", .unit = "N", .lower = 0.0},
                      .lines = {line("peak force", 3, [](const SiteSecond& one) { return one.peak_force_N; })},
                      .rules = {}},
                     {.title = {},
                      .x = time,
                      .y = {.label = "active", .lower = 0.0, .upper = 1.0},
                      .lines = {line(
                          "active", 4,
                          [](const SiteSecond& one) { return one.standing == link::Standing::active ? 1.0 : 0.0; })},
                      .rules = {}}},
          .share_x = report::Sharing::in_line};
}

std::string json_of(const std::string& site, const SiteTotals& totals, const runtime::ServoReport& servo) {
  nlohmann::ordered_json holds = nlohmann::ordered_json::object();
  for (const auto& [cause, name] : enumerators(link::HoldCause{})) {
    holds[name] = totals.holds[static_cast<std::size_t>(cause)];
  }
  const auto& link = totals.link;
  const nlohmann::ordered_json document{{"site", site},
                                        {"duration_s", totals.duration_s},
                                        {"ticks", totals.ticks},
                                        {"active_ticks", totals.active_ticks},
                                        {"armings", totals.armings},
                                        {"holds", holds},
                                        {"longest_silence_at_hold_s", totals.longest_silence_at_hold_s},
                                        {"round_trip_mean_s", totals.round_trip_mean_s},
                                        {"round_trip_max_s", totals.round_trip_max_s},
                                        {"age_mean_s", totals.age_mean_s},
                                        {"age_max_s", totals.age_max_s},
                                        {"loss_fraction", loss_of(totals)},
                                        {"peak_force_N", totals.peak_force_N},
                                        {"largest_force_step_N", totals.largest_force_step_N},
                                        {"largest_resuming_force_step_N", totals.largest_resuming_force_step_N},
                                        {"force_step_limit_N", totals.force_step_limit_N},
                                        {"steps_above_limit", totals.steps_above_limit},
                                        {"stale_applied", totals.stale_applied},
                                        {"not_finite", totals.not_finite},
                                        {"link",
                                         {{"sent", link.sent},
                                          {"unsent", link.unsent},
                                          {"applied", link.inbound.applied},
                                          {"greetings", link.inbound.greeting},
                                          {"late", link.inbound.late},
                                          {"repeated", link.inbound.repeated},
                                          {"stale", link.inbound.stale},
                                          {"reflected", link.inbound.reflected},
                                          {"foreign", link.inbound.foreign},
                                          {"sessions", link.inbound.sessions},
                                          {"malformed", link.malformed},
                                          {"dropped", link.dropped},
                                          {"authentic", link.secure.opened},
                                          {"refused", link.secure.refused},
                                          {"handshake_packets", link.secure.handshake_packets},
                                          {"handshakes", link.secure.handshakes},
                                          {"overflowed", link.secure.overflowed}}},
                                        {"servo", nlohmann::ordered_json::parse(runtime::servo_json(servo))}};
  return document.dump(2) + "\n";
}

}  // namespace

simulation::Outcome site_outcome(const std::string& site, const SiteTotals& totals,
                                 const std::vector<SiteSecond>& seconds, const runtime::ServoReport& servo,
                                 const simulation::Request& request, std::string_view configuration) {
  const report::Table table = site_table(site, totals);
  const std::vector<report::Figure> figures{seconds_figure(seconds), runtime::timing_figure(servo)};
  report::Page page(request.name + ": the " + site);
  page.table(table);
  page.figure(figures[0]);
  runtime::add_timing(page, servo, figures[1]);
  simulation::add_provenance(page, request, configuration);
  return {.text = table.to_text() + "\n" + runtime::timing_text(servo),
          .json = json_of(site, totals, servo),
          .html = page.to_html(),
          .figures = figures};
}

}  // namespace tactus::cli
