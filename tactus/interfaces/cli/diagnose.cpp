// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/diagnosis/report.hpp>
#include <tactus/interfaces/cli/commands.hpp>
#include <tactus/interfaces/cli/outcome_files.hpp>
#include <tactus/interfaces/cli/streams.hpp>
#include <tactus/kernel/core/version.hpp>

#include <memory>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>

namespace tactus::cli {

namespace {

struct DiagnoseOptions {
  std::string file;
  diagnosis::SignalRoles roles;
  OutputOptions results;
};

Check diagnose(const DiagnoseOptions& options, const std::string& command) {
  auto output = OutputFolder::open(options.results);
  if (!output) return output.error();
  diagnosis::SignalRoles roles = options.roles;
  roles.file = options.file;
  const auto signals = diagnosis::read_signals(roles);
  if (!signals) {
    Error error = signals.error();
    if (error.place.empty()) error.place = options.file;
    return error;
  }
  const diagnosis::Diagnosis found = diagnosis::diagnose(*signals);
  report::Page page = diagnosis::to_page(*signals, found, options.file);
  page.footer("tactus " + std::string(version()), command);
  return write_outcome(*output, {.text = diagnosis::to_text(*signals, found),
                                 .json = diagnosis::to_json(*signals, found, options.file),
                                 .html = page.to_html(),
                                 .figures = {}});
}

/// How a signal of a bag is written that may have this role: the sensors' forces are wrenches, the motors' are efforts.
const char* in_a_bag(diagnosis::Role role) {
  if (diagnosis::is_position(role)) return "TOPIC/JOINT.position";
  const bool sensor = role == diagnosis::Role::tip_force || role == diagnosis::Role::hand_force;
  return sensor ? "TOPIC/force.x, force.y or force.z" : "TOPIC/JOINT.effort";
}

}  // namespace

void add_diagnose(CLI::App& app, const std::string& command, int& status) {
  auto options = std::make_shared<DiagnoseOptions>();
  CLI::App* verb = app.add_subcommand("diagnose", "Find oscillations in a recording, and the loop that causes them");
  verb->add_option("RECORDING", options->file,
                   "Recording: .csv, .tsv, .txt, .mat (version 5), a log of tactus or a ROS 2 bag (.mcap)")
      ->required();
  for (const diagnosis::Role role : diagnosis::all_roles) {
    const auto index = static_cast<std::size_t>(role);
    const std::string words(diagnosis::words_of(role));
    verb->add_option(diagnosis::option_of(role), options->roles.names[index],
                     "Column of the " + words + "; in a MATLAB file NAME:COLUMN, in a bag " + in_a_bag(role))
        ->type_name("NAME");
  }
  for (const diagnosis::Role role : diagnosis::all_roles) {
    const auto index = static_cast<std::size_t>(role);
    verb->add_option(diagnosis::option_of(role) + "-sign", options->roles.signs[index],
                     "-1 reverses the " + std::string(diagnosis::words_of(role)))
        ->type_name("SIGN")
        ->check(CLI::IsMember({-1.0, 1.0}));
  }
  verb->add_option("--joint", options->roles.joint,
                   "Joint of a ROS 2 bag or of a rig's log; by default the joint with the roughest motion")
      ->type_name("NAME");
  verb->add_option("--time", options->roles.time, "Time column, or two as sec,nanosec")->type_name("NAME");
  verb->add_option("--time-unit", options->roles.time_unit, "Unit of the times, if the file does not state it")
      ->type_name("UNIT")
      ->check(CLI::IsMember({"s", "ms", "us", "ns"}));
  verb->add_option("--sample-time-s", options->roles.sample_time_s, "Time between samples, if the file has no times")
      ->type_name("S");
  add_output_options(*verb, options->results, command, "Folder for report.html and results.json");
  verb->callback([options, name = app.get_name(), &command, &status] {
    if (const auto error = diagnose(*options, command)) {
      status = report_error(name, *error);
    }
  });
}

}  // namespace tactus::cli
