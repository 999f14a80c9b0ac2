// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/table.hpp>
#include <tactus/data/report/text.hpp>

#include <cstdio>
#include <string>
#include <string_view>

#include <bench/sections.hpp>
#include <nlohmann/json.hpp>

namespace {

using tactus::bench::Finding;
using tactus::bench::Findings;

std::string goal_of(const Finding& finding) {
  if (finding.goal == Finding::Goal::none) return {};
  return (finding.goal == Finding::Goal::at_most ? "≤ " : "≥ ") + tactus::report::number(finding.bound, 2);
}

void print_tables(const Findings& findings) {
  using Align = tactus::report::Column::Align;
  for (auto first = findings.begin(); first != findings.end();) {
    tactus::report::Table table({{.title = "measured", .align = Align::left},
                                 {.title = "value"},
                                 {.title = "unit", .align = Align::left},
                                 {.title = "goal", .align = Align::left},
                                 {.title = "reached", .align = Align::left}},
                                first->section);
    auto finding = first;
    for (; finding != findings.end() && finding->section == first->section; ++finding) {
      const bool judged = finding->goal != Finding::Goal::none;
      table.add_row({finding->name, tactus::report::number(finding->value, 3), finding->unit, goal_of(*finding),
                     judged ? (finding->reached() ? "yes" : "no") : ""});
    }
    std::printf("%s\n", table.to_text().c_str());
    first = finding;
  }
  std::puts("Only ratios within one run mean anything: the clock of a shared machine drifts.");
}

void print_json(const Findings& findings) {
  auto list = nlohmann::ordered_json::array();
  for (const Finding& finding : findings) {
    nlohmann::ordered_json entry{
        {"section", finding.section}, {"name", finding.name}, {"value", finding.value}, {"unit", finding.unit}};
    if (finding.goal != Finding::Goal::none) {
      entry[finding.goal == Finding::Goal::at_most ? "at_most" : "at_least"] = finding.bound;
      entry["reached"] = finding.reached();
    }
    list.push_back(std::move(entry));
  }
  std::printf("%s\n", nlohmann::ordered_json{{"findings", std::move(list)}}.dump(2).c_str());
}

}  // namespace

/// bench_tactus [--json] [--quick]: prints what tactus reaches on this machine beside its goals. A goal that is not
/// reached is no failure of the program.
int main(int count, char** arguments) {
  bool json = false;
  bool quick = false;
  for (int i = 1; i < count; ++i) {
    const std::string_view argument = arguments[i];
    if (argument == "--json") {
      json = true;
    } else if (argument == "--quick") {
      quick = true;
    } else {
      std::fprintf(stderr, "bench_tactus: unknown argument '%s'; use: bench_tactus [--json] [--quick]\n", arguments[i]);
      return 2;
    }
  }
  tactus::bench::add_model_tick();
  tactus::bench::add_force_estimators();
  tactus::bench::add_virtual_time();
  tactus::bench::add_joints();
  const auto times = tactus::bench::run_cases(quick ? 5 : 21, quick ? 0.005 : 0.02);

  Findings findings = tactus::bench::model_tick(times);
  for (const auto& more :
       {tactus::bench::grip_tick(quick), tactus::bench::tick_tail(), tactus::bench::force_estimators(times),
        tactus::bench::virtual_time(times), tactus::bench::joints(times), tactus::bench::isolation(),
        tactus::bench::servo_step(quick)}) {
    findings.insert(findings.end(), more.begin(), more.end());
  }
  if (json) {
    print_json(findings);
  } else {
    print_tables(findings);
  }
  return 0;
}
