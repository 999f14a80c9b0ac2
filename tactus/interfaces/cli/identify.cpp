// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/commands.hpp>
#include <tactus/interfaces/cli/identify.hpp>

#include <string>

#include <CLI/CLI.hpp>

namespace tactus::cli {

void add_identify(CLI::App& app, const std::string& command, int& status) {
  CLI::App* verb = app.add_subcommand("identify", "Identify a model from experiments or recordings");
  verb->require_subcommand(1);
  const std::string name = app.get_name();
  add_identify_arm(*verb, name, command, status);
  add_identify_excitation(*verb, name, command, status);
  add_identify_frf(*verb, name, command, status);
  add_identify_inverse(*verb, name, command, status);
  add_identify_bench(*verb, name, command, status);
  add_identify_operator(*verb, name, command, status);
  add_identify_prediction(*verb, name, command, status);
}

}  // namespace tactus::cli
