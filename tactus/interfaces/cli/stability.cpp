// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/commands.hpp>
#include <tactus/interfaces/cli/stability.hpp>

#include <string>

#include <CLI/CLI.hpp>

namespace tactus::cli {

void add_stability(CLI::App& app, const std::string& command, int& status) {
  CLI::App* verb = app.add_subcommand("stability", "Compute how much force gain is stable, and what limits it");
  verb->require_subcommand(1);
  const std::string name = app.get_name();
  add_stability_limit(*verb, name, command, status);
  add_stability_map(*verb, name, command, status);
  add_stability_margins(*verb, name, command, status);
  add_stability_scorecard(*verb, name, command, status);
  add_stability_two_port(*verb, name, command, status);
}

}  // namespace tactus::cli
