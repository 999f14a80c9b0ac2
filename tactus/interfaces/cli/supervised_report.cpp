// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/figure.hpp>
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/page.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/interfaces/cli/internal/link_json.hpp>
#include <tactus/interfaces/cli/supervised_report.hpp>
#include <tactus/runtime/servo/servo_presentation.hpp>
#include <tactus/simulation/experiments/presentation.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <functional>

#include <nlohmann/json.hpp>

namespace tactus::cli {

namespace {

using control::SiteRole;
using runtime::CountOfEach;
using runtime::LinkTotals;
using runtime::SiteSecond;
using runtime::SiteTotals;
using Align = report::Column::Align;

double loss_of(const LinkTotals& totals) {
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

std::string SitesHere::name() const { return one ? std::string("the ") + name_of(*one) : "both sites"; }

std::string second_head(const SitesHere& here) {
  const std::string words = here.has(SiteRole::master)
                                ? "Type arm (or Enter), press, release, clutch, unclutch, stop or clear; "
                                : "It is armed from the master; type stop, or clear to leave a fault; ";
  if (!here.one) {
    return "Both sites run. " + words +
           "Ctrl-C ends.\n  time  site    state      cause          limit      fault            force"
           "\n     s                                                                   N\n";
  }
  return "The " + std::string(name_of(*here.one)) + " runs. " + words +
         "Ctrl-C ends.\n  time  state      cause          limit      fault           round trip      age    loss   "
         "force"
         "\n     s                                                                ms       ms       %       N\n";
}

std::string second_line(const SitesHere& here, const SiteSecond& second) {
  std::array<char, 160> line{};
  if (!here.one) {
    std::snprintf(line.data(), line.size(), "%6.0f  %-7s %-10s %-14s %-10s %-14s %7.3f\n", second.time_s,
                  name_of(second.role), name_of(second.state), name_of(second.cause), name_of(second.limit),
                  name_of(second.fault), second.peak_force_N);
    return line.data();
  }
  std::snprintf(line.data(), line.size(), "%6.0f  %-10s %-14s %-10s %-14s %11.3f %8.3f %7.2f %7.3f\n", second.time_s,
                name_of(second.state), name_of(second.cause), name_of(second.limit), name_of(second.fault),
                1e3 * second.round_trip_s, 1e3 * second.age_s, 100.0 * second.loss_fraction, second.peak_force_N);
  return line.data();
}

namespace {

std::string capitalised(std::string text) {
  text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

std::string milliseconds(double seconds) { return report::number(1e3 * seconds, 3); }
std::string count(auto value) { return std::to_string(value); }

/// A table with a column for each site.
class SitesTable {
 public:
  explicit SitesTable(const SupervisedRun& run) : run_(run), table_(columns(run), capitalised(run.here.name())) {}

  using Figure = std::function<std::string(const SiteTotals&)>;
  void add(const std::string& what, const Figure& figure, const char* unit = "") {
    std::vector<std::string> row{what};
    for (const auto& site : run_.sites) row.push_back(figure(site.totals));
    row.emplace_back(unit);
    table_.add_row(std::move(row));
  }
  /// What all sites share.
  void add_shared(const std::string& what, const std::string& value, const char* unit = "") {
    std::vector<std::string> row{what, value};
    row.resize(run_.sites.size() + 1);
    row.emplace_back(unit);
    table_.add_row(std::move(row));
  }
  /// A row for each word but `none` that was counted at any site.
  template <class Word>
  void add_counts(const std::string& what, CountOfEach<Word> SiteTotals::*counts, Word none) {
    for (const auto& [word, name] : enumerators(none)) {
      bool any = false;
      for (const auto& site : run_.sites) any = any || (site.totals.*counts)[word] > 0;
      if (word == none || !any) continue;
      add(what + name, [counts, word = word](const SiteTotals& totals) { return count((totals.*counts)[word]); });
    }
  }
  [[nodiscard]] report::Table take() && { return std::move(table_); }

 private:
  static std::vector<report::Column> columns(const SupervisedRun& run) {
    std::vector<report::Column> columns{{"", "", Align::left}};
    for (const auto& site : run.sites) columns.push_back({run.here.one ? "value" : name_of(site.role)});
    columns.push_back({"unit", "", Align::left});
    return columns;
  }

  const SupervisedRun& run_;
  report::Table table_;
};

void add_link(SitesTable& table, const LinkTotals& link) {
  table.add_shared("round trip, mean", milliseconds(link.round_trip_mean_s), "ms");
  table.add_shared("round trip, longest", milliseconds(link.round_trip_max_s), "ms");
  table.add_shared("age of packets, mean", milliseconds(link.age_mean_s), "ms");
  table.add_shared("age of packets, oldest", milliseconds(link.age_max_s), "ms");
  table.add_shared("packets sent", count(link.link.sent));
  for (const auto& [verdict, name] : enumerators(control::PacketVerdict{})) {
    table.add_shared(std::string("packets: ") + name, count(link.packets[verdict]));
  }
  table.add_shared("packets: repeated", count(link.link.inbound.repeated));
  table.add_shared("lost on the link to this site", report::number(100.0 * loss_of(link), 3), "%");
  table.add_shared("dropped by the kernel", count(link.dropped_by_kernel));
  table.add_shared("not authentic or malformed", count(link.link.secure.refused + link.link.malformed));
  table.add_shared("hand-shakes", count(link.link.secure.handshakes));
  table.add_shared("old packets applied", count(link.stale_applied));
}

report::Table sites_table(const SupervisedRun& run) {
  SitesTable table(run);
  table.add(
      "ran", [](const SiteTotals& totals) { return report::number(totals.duration_s, 4); }, "s");
  table.add_shared("ended by", run.ended_by);
  for (const auto& [state, name] : enumerators(control::SiteState{})) {
    table.add(
        std::string("in ") + name,
        [state = state](const SiteTotals& totals) {
          const double tick_s = totals.ticks > 0 ? totals.duration_s / static_cast<double>(totals.ticks) : 0.0;
          return report::number(static_cast<double>(totals.ticks_in[state]) * tick_s, 4);
        },
        "s");
  }
  table.add("armings", [](const SiteTotals& totals) { return count(totals.armings); });
  table.add_counts("holds: ", &SiteTotals::holds, control::SiteCause::none);
  table.add_counts("faults: ", &SiteTotals::faults, control::GateFault::none);
  table.add_counts("control cycles limited: ", &SiteTotals::ticks_limited, control::ActiveLimit::none);
  table.add(
      "longest silence before a hold",
      [](const SiteTotals& totals) { return milliseconds(totals.longest_silence_at_hold_s); }, "ms");
  if (run.link) add_link(table, *run.link);
  table.add("numbers not finite", [](const SiteTotals& totals) { return count(totals.not_finite); });
  table.add(
      "peak force", [](const SiteTotals& totals) { return report::number(totals.peak_force_N, 3); }, "N");
  table.add(
      "largest force step in a control cycle",
      [](const SiteTotals& totals) { return report::number(totals.largest_force_step_N, 3); }, "N");
  table.add(
      "the same, in the first second of being active",
      [](const SiteTotals& totals) { return report::number(totals.largest_resuming_force_step_N, 3); }, "N");
  table.add("force steps above the gate's limit",
            [](const SiteTotals& totals) { return count(totals.steps_above_limit); });
  if (run.log_dropped) table.add_shared("records missing in the log", count(*run.log_dropped));
  table.add_shared("lines that nobody read", count(run.lines_dropped));
  return std::move(table).take();
}

std::vector<SiteSecond> seconds_of(const SupervisedRun& run, SiteRole role) {
  std::vector<SiteSecond> own;
  for (const SiteSecond& second : run.seconds) {
    if (second.role == role) own.push_back(second);
  }
  return own;
}

/// Of each site the first and the last second, and every one that ended otherwise than the one before.
report::Table states_table(const SupervisedRun& run) {
  std::vector<report::Column> columns{{"time", "s"}};
  if (!run.here.one) columns.push_back({"site", "", Align::left});
  for (const char* title : {"state", "cause", "active limit", "fault of the gate"}) {
    columns.push_back({title, "", Align::left});
  }
  report::Table table(columns, run.here.one ? "What the site did" : "What the sites did");
  const auto alike = [](const SiteSecond& a, const SiteSecond& b) {
    return a.state == b.state && a.cause == b.cause && a.limit == b.limit && a.fault == b.fault;
  };
  for (const auto& site : run.sites) {
    const std::vector<SiteSecond> seconds = seconds_of(run, site.role);
    for (std::size_t i = 0; i < seconds.size(); ++i) {
      const SiteSecond& one = seconds[i];
      if (i > 0 && i + 1 < seconds.size() && alike(one, seconds[i - 1])) continue;
      std::vector<std::string> row{report::number(one.time_s, 4)};
      if (!run.here.one) row.emplace_back(name_of(one.role));
      for (const char* word : {name_of(one.state), name_of(one.cause), name_of(one.limit), name_of(one.fault)}) {
        row.emplace_back(word);
      }
      table.add_row(std::move(row));
    }
  }
  return table;
}

/// The link where there is one, and the force, second by second.
report::Figure seconds_figure(const SupervisedRun& run) {
  int colour = 0;
  const auto line = [&](const std::string& name, SiteRole role, auto value) {
    report::Line drawn{.name = name, .x = {}, .y = {}, .colour = run.here.one ? colour++ : static_cast<int>(role)};
    for (const SiteSecond& second : seconds_of(run, role)) {
      drawn.x.push_back(second.time_s);
      drawn.y.push_back(value(second));
    }
    return drawn;
  };
  const auto of_each_site = [&](const std::string& name, auto value) {
    std::vector<report::Line> lines;
    for (const auto& site : run.sites)
      lines.push_back(line(run.here.one ? name : name_of(site.role), site.role, value));
    return lines;
  };
  const report::Axis time{.label = "time", .unit = "s"};
  std::vector<report::Panel> panels;
  if (run.link) {
    const SiteRole role = run.sites.front().role;
    panels.push_back({.title = {},
                      .x = time,
                      .y = {.label = "mean", .unit = "ms", .lower = 0.0},
                      .lines = {line("round trip", role, [](const SiteSecond& one) { return 1e3 * one.round_trip_s; }),
                                line("age of packets", role, [](const SiteSecond& one) { return 1e3 * one.age_s; })},
                      .rules = {}});
    panels.push_back({.title = {},
                      .x = time,
                      .y = {.label = "lost", .unit = "%", .lower = 0.0},
                      .lines = {line("lost", role, [](const SiteSecond& one) { return 100.0 * one.loss_fraction; })},
                      .rules = {}});
  }
  panels.push_back({.title = {},
                    .x = time,
                    .y = {.label = "peak force", .unit = "N", .lower = 0.0},
                    .lines = of_each_site("peak force", [](const SiteSecond& one) { return one.peak_force_N; }),
                    .rules = {}});
  panels.push_back(
      {.title = {},
       .x = time,
       .y = {.label = "active", .lower = 0.0, .upper = 1.0},
       .lines = of_each_site("active",
                             [](const SiteSecond& one) { return one.state == control::SiteState::active ? 1.0 : 0.0; }),
       .rules = {}});
  return {
      .title = "Second by second",
      .caption =
          std::string(run.link ? "What the packets of each second took, how many were lost on the link to this site, "
                                 "and the largest force of the motor."
                               : "The largest force of each motor.") +
          " Where a site is not active it follows nobody.",
      .columns = 1,
      .panels = std::move(panels),
      .share_x = report::Sharing::in_line};
}

nlohmann::ordered_json json_of(const SupervisedRun& run, const SiteSecond& second) {
  nlohmann::ordered_json object{{"time_s", second.time_s}};
  if (!run.here.one) object["site"] = name_of(second.role);
  object.update({{"state", name_of(second.state)},
                 {"cause", name_of(second.cause)},
                 {"limit", name_of(second.limit)},
                 {"fault", name_of(second.fault)}});
  if (run.link) {
    object.update(
        {{"round_trip_s", second.round_trip_s}, {"age_s", second.age_s}, {"loss_fraction", second.loss_fraction}});
  }
  object["peak_force_N"] = second.peak_force_N;
  return object;
}

nlohmann::ordered_json json_of(const SiteTotals& totals) {
  return {{"duration_s", totals.duration_s},
          {"ticks", totals.ticks},
          {"ticks_in", json_of_each(totals.ticks_in)},
          {"ticks_limited", json_of_each(totals.ticks_limited)},
          {"armings", totals.armings},
          {"holds", json_of_each(totals.holds)},
          {"faults", json_of_each(totals.faults)},
          {"longest_silence_at_hold_s", totals.longest_silence_at_hold_s},
          {"peak_force_N", totals.peak_force_N},
          {"largest_force_step_N", totals.largest_force_step_N},
          {"largest_resuming_force_step_N", totals.largest_resuming_force_step_N},
          {"force_step_limit_N", totals.force_step_limit_N},
          {"steps_above_limit", totals.steps_above_limit},
          {"not_finite", totals.not_finite}};
}

std::string json_of(const SupervisedRun& run) {
  nlohmann::ordered_json document{{"fault", fault_of(run)}};
  if (run.here.one) {
    document["site"] = name_of(*run.here.one);
    document.update(json_of(run.sites.front().totals));
  } else {
    for (const auto& site : run.sites) document["sites"][name_of(site.role)] = json_of(site.totals);
  }
  document["ended_by"] = run.ended_by;
  if (run.link) document.update(link_json(*run.link));
  document["lines_dropped"] = run.lines_dropped;
  document["seconds"] = nlohmann::ordered_json::array();
  for (const SiteSecond& second : run.seconds) document["seconds"].push_back(json_of(run, second));
  document["servo"] = report::parse_json<nlohmann::ordered_json>(runtime::servo_json(run.servo));
  if (run.log_dropped) document["log_dropped"] = *run.log_dropped;
  return report::json_text(document);
}

}  // namespace

nlohmann::ordered_json link_json(const LinkTotals& totals) {
  const auto& link = totals.link;
  return {{"round_trip_mean_s", totals.round_trip_mean_s},
          {"round_trip_max_s", totals.round_trip_max_s},
          {"age_mean_s", totals.age_mean_s},
          {"age_max_s", totals.age_max_s},
          {"loss_fraction", loss_of(totals)},
          {"stale_applied", totals.stale_applied},
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
            {"overflowed", link.secure.overflowed}}}};
}

std::string fault_of(const SupervisedRun& run) {
  std::string text;
  for (const auto& site : run.sites) {
    const auto last = std::find_if(run.seconds.rbegin(), run.seconds.rend(),
                                   [&site](const SiteSecond& second) { return second.role == site.role; });
    if (last == run.seconds.rend() || last->state != control::SiteState::fault) continue;
    text += (text.empty() ? "" : ", ") + std::string(name_of(site.role)) + " (" + name_of(last->cause);
    if (last->fault != control::GateFault::none) text += std::string(", ") + name_of(last->fault);
    text += ")";
  }
  return text;
}

experiments::Outcome supervised_outcome(const SupervisedRun& run, const experiments::Request& request,
                                        std::string_view configuration) {
  const report::Table table = sites_table(run), states = states_table(run);
  const std::vector<report::Figure> figures{seconds_figure(run), runtime::timing_figure(run.servo)};
  report::Page page(request.name + ": " + run.here.name());
  const std::string fault = fault_of(run);
  const std::string verdict = fault.empty() ? "" : "Ended in a fault: " + fault + ".";
  if (!verdict.empty()) page.paragraph(verdict);
  page.table(table);
  page.table(states);
  page.figure(figures[0]);
  runtime::add_timing(page, run.servo, figures[1]);
  experiments::add_provenance(page, request, configuration);
  return {.text = verdict + (verdict.empty() ? "" : "\n\n") + table.to_text() + "\n" + states.to_text() + "\n" +
                  runtime::timing_text(run.servo),
          .json = json_of(run),
          .html = page.to_html(),
          .figures = figures,
          .traces = {},
          .configuration = std::string(configuration)};
}

}  // namespace tactus::cli
