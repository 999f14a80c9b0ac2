// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/commands.hpp>
#include <tactus/interfaces/cli/device.hpp>

#include <iostream>

#include <CLI/CLI.hpp>

namespace tactus::cli {

void end_command(const CLI::App& app, const Result<bool>& well, int& status) {
  if (!well) std::cerr << app.get_name() << ": " << describe(well.error()) << "\n";
  status = !well ? exit_status(well.error()) : (*well ? 0 : 1);
}

void add_device(CLI::App& app, const std::string& command, int& status) {
  CLI::App* verb = app.add_subcommand("device", "List, check, calibrate and watch your motors and handles");
  verb->require_subcommand(1);
  add_device_list(*verb, app, status);
  add_device_check(*verb, app, command, status);
  add_device_watch(*verb, app, status);
  add_device_zero(*verb, app, status);
  add_device_limits(*verb, app, status);
  add_device_guard(*verb, app, status);
}

}  // namespace tactus::cli
