#include <tactus/cli/internal/json_text.hpp>
#include <tactus/cli/site_report.hpp>
#include <tactus/experiments/presentation.hpp>
#include <tactus/report/figure.hpp>
#include <tactus/report/page.hpp>
#include <tactus/report/table.hpp>
#include <tactus/report/text.hpp>
#include <tactus/runtime/servo_presentation.hpp>

#include <array>
#include <cstdio>

#include <nlohmann/json.hpp>

namespace tactus::cli {

namespace {

double loss_of(const SiteTotals& totals) {
  const auto& link = totals.link;
  return link.expected > 0 ? 1.0 - static_cast<double>(link.arrived) / static_cast<double>(link.expected) : 0.0;
}

template <class Word>
nlohmann::ordered_json json_of_each(const CountOfEach<Word>& counts) {
  nlohmann::ordered_json object = nlohmann::ordered_json::object();
  for (const auto& [word, name] : enumerators(Word{})) object[name] = counts[word];
  return object;
}

}  // namespace

std::string second_head(control::SiteRole role) {
  const std::string words = role == control::SiteRole::master
                                ? "Type arm (or Enter), press, release, clutch, unclutch, stop or clear; "
                                : "It is armed from the master; type stop, or clear to leave a fault; ";
  return "The " + std::string(name_of(role)) + " runs. " + words +
         "Ctrl-C ends.\n  time  state      cause          limit      fault           round trip      age    loss   "
         "force"
         "\n     s                                                                ms       ms       %       N\n";
}

std::string second_line(const SiteSecond& second) {
  std::array<char, 160> line{};
  std::snprintf(line.data(), line.size(), "%6.0f  %-10s %-14s %-10s %-14s %11.3f %8.3f %7.2f %7.3f\n", second.time_s,
                name_of(second.state), name_of(second.cause), name_of(second.limit), name_of(second.fault),
                1e3 * second.round_trip_s, 1e3 * second.age_s, 100.0 * second.loss_fraction, second.peak_force_N);
  return line.data();
}

namespace {

report::Table site_table(const SiteRun& run) {
  using Align = report::Column::Align;
  const SiteTotals& totals = run.totals;
  const auto count = [](auto value) { return std::to_string(value); };
  const auto ms = [](double seconds) { return report::number(1e3 * seconds, 3); };
  const double tick_s = totals.ticks > 0 ? totals.duration_s / static_cast<double>(totals.ticks) : 0.0;
  report::Table table({{"", "", Align::left}, {"value"}, {"unit", "", Align::left}},
                      "The " + std::string(name_of(run.role)));
  const auto add_counts = [&](const std::string& what, const auto& counts, auto none) {
    for (const auto& [word, name] : enumerators(none)) {
      if (word != none && counts[word] > 0) table.add_row({what + name, count(counts[word]), ""});
    }
  };
  table.add_row({"ran", report::number(totals.duration_s, 4), "s"});
  table.add_row({"ended by", run.ended_by, ""});
  for (const auto& [state, name] : enumerators(control::SiteState{})) {
    const double time_s = static_cast<double>(totals.ticks_in[state]) * tick_s;
    table.add_row({std::string("in ") + name, report::number(time_s, 4), "s"});
  }
  table.add_row({"armings", count(totals.armings), ""});
  add_counts("holds: ", totals.holds, control::SiteCause::none);
  add_counts("faults: ", totals.faults, control::GateFault::none);
  add_counts("ticks limited: ", totals.ticks_limited, control::ActiveLimit::none);
  table.add_row({"longest silence before a hold", ms(totals.longest_silence_at_hold_s), "ms"});
  table.add_row({"round trip, mean", ms(totals.round_trip_mean_s), "ms"});
  table.add_row({"round trip, longest", ms(totals.round_trip_max_s), "ms"});
  table.add_row({"age of packets, mean", ms(totals.age_mean_s), "ms"});
  table.add_row({"age of packets, oldest", ms(totals.age_max_s), "ms"});
  table.add_row({"packets sent", count(totals.link.sent), ""});
  for (const auto& [verdict, name] : enumerators(control::PacketVerdict{})) {
    table.add_row({std::string("packets: ") + name, count(totals.packets[verdict]), ""});
  }
  table.add_row({"packets: repeated", count(totals.link.inbound.repeated), ""});
  table.add_row({"lost on the way here", report::number(100.0 * loss_of(totals), 3), "%"});
  table.add_row({"dropped by the kernel", count(totals.dropped_by_kernel), ""});
  table.add_row({"not authentic or malformed", count(totals.link.secure.refused + totals.link.malformed), ""});
  table.add_row({"hand-shakes", count(totals.link.secure.handshakes), ""});
  table.add_row({"old packets applied", count(totals.stale_applied), ""});
  table.add_row({"numbers not finite", count(totals.not_finite), ""});
  table.add_row({"peak force", report::number(totals.peak_force_N, 3), "N"});
  table.add_row({"largest force step in a tick", report::number(totals.largest_force_step_N, 3), "N"});
  table.add_row(
      {"the same, in the first second of being active", report::number(totals.largest_resuming_force_step_N, 3), "N"});
  table.add_row({"force steps above the gate's limit", count(totals.steps_above_limit), ""});
  if (run.log_dropped) table.add_row({"records missing in the log", count(*run.log_dropped), ""});
  table.add_row({"lines that nobody read", count(run.lines_dropped), ""});
  return table;
}

/// The first and the last second, and every one that ended otherwise than the one before.
report::Table states_table(const std::vector<SiteSecond>& seconds) {
  using Align = report::Column::Align;
  report::Table table({{"time", "s"},
                       {"state", "", Align::left},
                       {"cause", "", Align::left},
                       {"active limit", "", Align::left},
                       {"fault of the gate", "", Align::left}},
                      "What the site did");
  const auto alike = [](const SiteSecond& a, const SiteSecond& b) {
    return a.state == b.state && a.cause == b.cause && a.limit == b.limit && a.fault == b.fault;
  };
  for (std::size_t i = 0; i < seconds.size(); ++i) {
    const SiteSecond& one = seconds[i];
    if (i > 0 && i + 1 < seconds.size() && alike(one, seconds[i - 1])) continue;
    table.add_row({report::number(one.time_s, 4), name_of(one.state), name_of(one.cause), name_of(one.limit),
                   name_of(one.fault)});
  }
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
              "What the packets of each second took, how many were lost on the way here, and the largest force of the "
              "motor. Where the site is not active it follows nobody.",
          .columns = 1,
          .panels = {{.title = {},
                      .x = time,
                      .y = {.label = "mean", .unit = "ms", .lower = 0.0},
                      .lines = {line("round trip", 0, [](const SiteSecond& one) { return 1e3 * one.round_trip_s; }),
                                line("age of packets", 1, [](const SiteSecond& one) { return 1e3 * one.age_s; })},
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
                          [](const SiteSecond& one) { return one.state == control::SiteState::active ? 1.0 : 0.0; })},
                      .rules = {}}},
          .share_x = report::Sharing::in_line};
}

nlohmann::ordered_json json_of(const SiteSecond& second) {
  return {
      {"time_s", second.time_s},        {"state", name_of(second.state)},        {"cause", name_of(second.cause)},
      {"limit", name_of(second.limit)}, {"fault", name_of(second.fault)},        {"round_trip_s", second.round_trip_s},
      {"age_s", second.age_s},          {"loss_fraction", second.loss_fraction}, {"peak_force_N", second.peak_force_N}};
}

std::string json_of(const SiteRun& run) {
  const SiteTotals& totals = run.totals;
  nlohmann::ordered_json seconds = nlohmann::ordered_json::array();
  for (const SiteSecond& second : run.seconds) seconds.push_back(json_of(second));
  const auto& link = totals.link;
  nlohmann::ordered_json document{{"site", name_of(run.role)},
                                  {"duration_s", totals.duration_s},
                                  {"ended_by", run.ended_by},
                                  {"ticks", totals.ticks},
                                  {"ticks_in", json_of_each(totals.ticks_in)},
                                  {"ticks_limited", json_of_each(totals.ticks_limited)},
                                  {"armings", totals.armings},
                                  {"holds", json_of_each(totals.holds)},
                                  {"faults", json_of_each(totals.faults)},
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
                                  {"packets", json_of_each(totals.packets)},
                                  {"link",
                                   {{"sent", link.sent},
                                    {"unsent", link.unsent},
                                    {"counted", link.inbound.counted},
                                    {"greetings", link.inbound.greeting},
                                    {"repeated", link.inbound.repeated},
                                    {"reflected", link.inbound.reflected},
                                    {"foreign", link.inbound.foreign},
                                    {"sessions", link.inbound.sessions},
                                    {"malformed", link.malformed},
                                    {"dropped", totals.dropped_by_kernel},
                                    {"authentic", link.secure.opened},
                                    {"refused", link.secure.refused},
                                    {"handshake_packets", link.secure.handshake_packets},
                                    {"handshakes", link.secure.handshakes},
                                    {"overflowed", link.secure.overflowed}}},
                                  {"lines_dropped", run.lines_dropped},
                                  {"seconds", seconds},
                                  {"servo", nlohmann::ordered_json::parse(runtime::servo_json(run.servo))}};
  if (run.log_dropped) document["log_dropped"] = *run.log_dropped;
  return json_text(document);
}

}  // namespace

experiments::Outcome site_outcome(const SiteRun& run, const experiments::Request& request,
                                  std::string_view configuration) {
  const report::Table table = site_table(run), states = states_table(run.seconds);
  const std::vector<report::Figure> figures{seconds_figure(run.seconds), runtime::timing_figure(run.servo)};
  report::Page page(request.name + ": the " + name_of(run.role));
  page.table(table);
  page.table(states);
  page.figure(figures[0]);
  runtime::add_timing(page, run.servo, figures[1]);
  experiments::add_provenance(page, request, configuration);
  return {.text = table.to_text() + "\n" + states.to_text() + "\n" + runtime::timing_text(run.servo),
          .json = json_of(run),
          .html = page.to_html(),
          .figures = figures};
}

}  // namespace tactus::cli
