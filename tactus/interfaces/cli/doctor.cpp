// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/page.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/interfaces/cli/commands.hpp>
#include <tactus/interfaces/cli/outcome_files.hpp>
#include <tactus/interfaces/cli/servo_options.hpp>
#include <tactus/kernel/core/version.hpp>
#include <tactus/runtime/servo/doctor.hpp>
#include <tactus/runtime/servo/servo_presentation.hpp>

#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace tactus::cli {

namespace {

using runtime::Finding;

struct DoctorOptions {
  runtime::ServoThreadParams servo;
  double duration_s = 3.0;
  OutputOptions output;
};

report::Table table_of(const std::vector<Finding>& findings) {
  using Align = report::Column::Align;
  report::Table table({{"looked at", "", Align::left}, {"verdict", "", Align::left}, {"found", "", Align::left}},
                      "Can this machine keep time?");
  for (const Finding& finding : findings) table.add_row({finding.name, name_of(finding.verdict), finding.found});
  return table;
}

std::string answer(const std::vector<Finding>& findings) {
  return runtime::can_keep_time(findings)
             ? "Yes: a loop can be run here, as well as the verdicts state."
             : "No: fix what is bad. A loop runs here all the same, and counts its late control cycles.";
}

std::string text_of(const std::vector<Finding>& findings) {
  std::string explained;
  for (const Finding& finding : findings) {
    explained += finding.name + ": " + finding.means + ".\n";
    if (!finding.remedy.empty()) explained += "    remedy: " + finding.remedy + "\n";
  }
  return answer(findings) + "\n\n" + table_of(findings).to_text() + "\n" + explained;
}

std::string html_of(const std::vector<Finding>& findings, const report::Figure& timing,
                    const runtime::ServoReport& servo, const std::string& command) {
  report::Page page("Can this machine keep time?");
  page.paragraph(answer(findings));
  page.table(table_of(findings));
  std::vector<std::pair<std::string, std::string>> explained;
  for (const Finding& finding : findings) {
    explained.emplace_back(finding.name,
                           finding.means + "." + (finding.remedy.empty() ? "" : " Remedy: " + finding.remedy));
  }
  page.definitions(explained);
  runtime::add_timing(page, servo, timing);
  page.footer("tactus " + std::string(version()), command);
  return page.to_html();
}

std::string json_of(const std::vector<Finding>& findings, const runtime::Measurement& measurement) {
  nlohmann::ordered_json document{{"can_keep_time", runtime::can_keep_time(findings)},
                                  {"findings", nlohmann::ordered_json::array()}};
  for (const Finding& finding : findings) {
    document["findings"].push_back({{"name", finding.name},
                                    {"verdict", name_of(finding.verdict)},
                                    {"found", finding.found},
                                    {"means", finding.means},
                                    {"remedy", finding.remedy}});
  }
  document["servo"] = report::parse_json<nlohmann::ordered_json>(runtime::servo_json(measurement.report));
  return report::json_text(document);
}

/// Whether the machine can keep time.
Result<bool> examine(const DoctorOptions& options, const std::string& command) {
  constexpr Bounds durations = between(0.1, 3600.0);
  if (!durations.contain(options.duration_s)) {
    Error error = out_of_bounds({}, options.duration_s, durations, units::second);
    error.place = "--duration-s";
    return error;
  }
  auto output = OutputFolder::open(options.output);
  if (!output) return output.error();
  const auto measurement = runtime::measure_lateness(options.servo, options.duration_s);
  if (!measurement) return measurement.error();
  const auto findings =
      runtime::diagnose(runtime::read_machine_facts(static_cast<int>(options.servo.priority)), *measurement);
  const report::Figure timing = runtime::timing_figure(measurement->report);
  const experiments::Outcome outcome{.text = text_of(findings),
                                     .json = json_of(findings, *measurement),
                                     .html = html_of(findings, timing, measurement->report, command),
                                     .figures = {timing}};
  if (auto error = write_outcome(*output, outcome)) return *std::move(error);
  return runtime::can_keep_time(findings);
}

}  // namespace

void add_doctor(CLI::App& app, const std::string& command, int& status) {
  auto options = std::make_shared<DoctorOptions>();
  CLI::App* verb =
      app.add_subcommand("doctor", "Check whether this machine can run a control loop in real time, and suggest a fix");
  verb->add_option("--rate-Hz", options->servo.rate_Hz, "Rate of the control cycle to test")->type_name("HZ");
  verb->add_option("--duration-s", options->duration_s, "Time to measure")->type_name("S");
  add_servo_options(*verb, options->servo);
  add_output_options(*verb, options->output, command, "Folder for report.html, results.json and the figure");
  verb->callback([options, &app, &command, &status] {
    const auto can = examine(*options, command);
    if (!can) std::cerr << app.get_name() << ": " << describe(can.error()) << "\n";
    status = !can ? exit_status(can.error()) : (*can ? 0 : 1);
  });
}

}  // namespace tactus::cli
