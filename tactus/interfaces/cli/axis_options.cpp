// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/axis_options.hpp>
#include <tactus/interfaces/cli/streams.hpp>

#include <string>

#include <CLI/CLI.hpp>

namespace tactus::cli {

void add_axis_options(CLI::App& verb, AxisOptions& options, const std::string& command) {
  identification::AxisRoles& roles = options.roles;
  verb.add_option("RECORDING", options.file, "Recording: .csv, .tsv, .txt or .mat (version 5)")->required();
  verb.add_option("--position", roles.position, "Position column; in a MATLAB file NAME:COLUMN")->type_name("NAME");
  verb.add_option("--force", roles.force, "Column of the actuator force or torque")->type_name("NAME");
  verb.add_option("--external", roles.external, "Column of a further force on the axis, such as a hand's; it is added")
      ->type_name("NAME");
  verb.add_option("--time", roles.time, "Time column, or two as sec,nanosec")->type_name("NAME");
  verb.add_option("--time-unit", roles.time_unit, "Unit of the times, if the file does not state it")
      ->type_name("UNIT")
      ->check(CLI::IsMember({"s", "ms", "us", "ns"}));
  verb.add_option("--sample-time-s", roles.sample_time_s, "Time between samples, if the file has no times")
      ->type_name("S");
  verb.add_option("--position-sign", roles.position_sign, "-1 reverses the position")
      ->type_name("SIGN")
      ->check(CLI::IsMember({-1.0, 1.0}));
  verb.add_option("--force-sign", roles.force_sign, "-1 reverses the actuator force")
      ->type_name("SIGN")
      ->check(CLI::IsMember({-1.0, 1.0}));
  add_output_options(verb, options.output, command, "Folder for report.html, results.json and the model");
}

Result<identification::AxisRecording> read_axis(const AxisOptions& options, bool needs_measured) {
  if (const auto output = OutputFolder::open(options.output); !output) return output.error();
  identification::AxisRoles roles = options.roles;
  roles.file = options.file;
  auto axis = identification::read_axis(roles, needs_measured);
  if (axis) {
    for (const std::string& note : axis->notes) message_stream() << "Note: " << note << "\n";
    return axis;
  }
  Error error = axis.error();
  if (error.place.empty()) error.place = options.file;
  return error;
}

}  // namespace tactus::cli
