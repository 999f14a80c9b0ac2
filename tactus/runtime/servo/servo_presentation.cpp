// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/runtime/servo/servo_presentation.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>

#include <nlohmann/json.hpp>

namespace tactus::runtime {

namespace {

constexpr double us_per_ns = 1e-3;
using Align = report::Column::Align;

struct Share {
  std::string_view title;
  std::string_view key;
  double q;
};
constexpr std::array shares{Share{"median", "p50", 0.5}, Share{"p90", "p90", 0.9}, Share{"p99", "p99", 0.99},
                            Share{"p99.9", "p999", 0.999}, Share{"worst", "worst", 1.0}};

std::string_view explain(station::LateCause cause) {
  switch (cause) {
    case station::LateCause::none:
      return "in time";
    case station::LateCause::computing:
      return "the step computed too long";
    case station::LateCause::blocking:
      return "the step waited for a lock, a file or a sleep";
    case station::LateCause::paging:
      return "memory came from disk";
    case station::LateCause::waking:
      return "the thread was woken late";
    case station::LateCause::preempted:
      return "the kernel gave the core to somebody else";
    case station::LateCause::stalled:
      return "interrupts, or a hypervisor that took the processor away";
  }
  return "";
}

nlohmann::ordered_json quantiles_json(const DurationHistogram& histogram) {
  nlohmann::ordered_json object;
  for (const Share& share : shares) {
    object[std::string(share.key) + "_us"] = us_per_ns * histogram.quantile_ns(share.q);
  }
  return object;
}

/// Counts over a quarter of a doubling each: the histogram's own buckets are finer than a picture shows.
report::Line counts_line(const DurationHistogram& histogram, std::string name, int colour) {
  report::Line line{.name = std::move(name), .x = {}, .y = {}, .colour = colour, .width_px = 2.0};
  constexpr std::size_t together = DurationHistogram::per_doubling / 4;
  const auto add = [&line](double at_ns, double count) {
    line.x.push_back(us_per_ns * at_ns);
    line.y.push_back(count);
  };
  for (std::size_t i = DurationHistogram::per_doubling; i < DurationHistogram::buckets; i += together) {
    std::int64_t count = 0;
    for (std::size_t k = i; k < i + together; ++k) count += histogram.count_of(k);
    if (count == 0) continue;
    const auto lower = static_cast<double>(DurationHistogram::lower_ns(i));
    const auto upper = static_cast<double>(DurationHistogram::lower_ns(i + together));
    // A step with an edge down on both sides, so that a lone bucket shows.
    add(lower, std::nan(""));
    add(lower, static_cast<double>(count));
    add(upper, static_cast<double>(count));
  }
  return line;
}

}  // namespace

report::Table timing_table(const ServoReport& report) {
  std::vector<report::Column> columns{{"real time", "", Align::left}, {"ticks"}};
  for (const Share& share : shares) columns.push_back({std::string(share.title), "us"});
  report::Table table(columns, "Timing: a control cycle every " +
                                   report::number(us_per_ns * static_cast<double>(report.period_ns), 4) + " us");
  const auto add = [&](const char* name, const DurationHistogram& histogram) {
    std::vector<std::string> row{name, std::to_string(histogram.count())};
    for (const Share& share : shares) row.push_back(report::number(us_per_ns * histogram.quantile_ns(share.q), 3));
    table.add_row(row);
  };
  add("lateness, from deadline to begin", report.lateness);
  add("duration of the step", report.duration);
  return table;
}

report::Table late_ticks_table(const ServoReport& report) {
  report::Table table(
      {{"late control cycles", "", Align::left}, {"whose", "", Align::left}, {"count"}, {"", "", Align::left}});
  for (const station::LateCause cause : station::late_causes) {
    table.add_row({name_of(cause), station::is_ours(cause) ? "ours" : "the machine's",
                   std::to_string(report.late_for(cause)), std::string(explain(cause))});
  }
  table.add_row({"all", "", std::to_string(report.late_ours() + report.late_machine()),
                 std::to_string(report.missed) + " deadlines missed, at most " + std::to_string(report.longest_gap) +
                     " in a row"});
  return table;
}

report::Table rights_table(const ServoReport& report) {
  report::Table table({{"asked of the system", "", Align::left},
                       {"", "", Align::left},
                       {"what is lost", "", Align::left},
                       {"remedy", "", Align::left}});
  for (const Right& right : report.rights) {
    table.add_row({right.what, right.held ? "granted" : "refused: " + right.why, right.means, right.remedy});
  }
  return table;
}

report::Figure timing_figure(const ServoReport& report) {
  const double period_us = us_per_ns * static_cast<double>(report.period_ns);
  using Scale = report::Axis::Scale;
  return {
      .title = "How time was kept",
      .caption =
          "How many control cycles started how long after their deadline, and how many steps took how long, over "
          "quarters of a doubling. A control cycle that is late by a whole period has missed a deadline.",
      .columns = 1,
      .panels = {{.title = {},
                  .x = {.label = "time", .unit = "us", .scale = Scale::logarithmic},
                  .y = {.label = "ticks", .lower = 0.5, .scale = Scale::logarithmic},
                  .lines = {counts_line(report.lateness, "lateness", 0), counts_line(report.duration, "duration", 1)},
                  .rules = {{.direction = report::Rule::Direction::vertical, .at = period_us, .label = "one cycle"}}}}};
}

void add_timing(report::Page& page, const ServoReport& report, const report::Figure& figure) {
  page.heading("How time was kept");
  page.table(timing_table(report));
  page.figure(figure);
  page.table(late_ticks_table(report));
  page.table(rights_table(report));
}

std::string timing_text(const ServoReport& report) {
  return timing_table(report).to_text() + "\n" + late_ticks_table(report).to_text();
}

std::string servo_json(const ServoReport& report) {
  nlohmann::ordered_json late;
  for (const station::LateCause cause : station::late_causes) late[name_of(cause)] = report.late_for(cause);
  nlohmann::ordered_json rights = nlohmann::ordered_json::array();
  for (const Right& right : report.rights) {
    rights.push_back({{"what", right.what},
                      {"granted", right.held},
                      {"why", right.why},
                      {"means", right.means},
                      {"remedy", right.remedy}});
  }
  return report::json_line(nlohmann::ordered_json{{"period_us", us_per_ns * static_cast<double>(report.period_ns)},
                                                  {"ticks", report.ticks},
                                                  {"missed", report.missed},
                                                  {"longest_gap", report.longest_gap},
                                                  {"late_ours", report.late_ours()},
                                                  {"late_machine", report.late_machine()},
                                                  {"late", late},
                                                  {"minor_faults", report.minor_faults},
                                                  {"major_faults", report.major_faults},
                                                  {"involuntary_switches", report.involuntary_switches},
                                                  {"lateness", quantiles_json(report.lateness)},
                                                  {"duration", quantiles_json(report.duration)},
                                                  {"rights", rights}});
}

}  // namespace tactus::runtime
