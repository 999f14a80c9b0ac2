#include <tactus/cli/arm_options.hpp>

#include <CLI/CLI.hpp>

namespace tactus::cli {
namespace {

std::string joined_by_commas(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : ",") + word;
  return all;
}

}  // namespace

arm_identification::ArmColumns ArmOptions::columns() const {
  return {.time = joined_by_commas(time),
          .position = joined_by_commas(position),
          .velocity = joined_by_commas(velocity),
          .effort = joined_by_commas(effort)};
}

void add_arm_options(CLI::App& verb, ArmOptions& options, const std::string& command, const std::string& out_help) {
  const auto add = [&](const char* name, std::vector<std::string>& into, const char* help) {
    return verb.add_option(name, into, help)->type_name("COLUMNS")->allow_extra_args(false);
  };
  add("--time", options.time, "Column of the times: its name, or its number from 1")->required();
  add("--position", options.position, "Columns of the positions: q1,q2,... or a range as q1:q6 or 2:7")->required();
  add("--velocity", options.velocity, "Columns of the velocities; without it, from the positions");
  add("--effort", options.effort, "Columns of the motors' torques or currents")->required();
  add_output_options(verb, options.output, command, out_help);
}

}  // namespace tactus::cli
