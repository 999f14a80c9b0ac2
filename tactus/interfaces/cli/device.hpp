// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <string>

// Only declared: headers are installed, and a user of the package need not have CLI11.
namespace CLI {  // NOLINT: the name is not ours
class App;
}

namespace tactus::cli {

/// The commands below `device`. `app` states the program's name in errors; `status` becomes the exit status.
/// `command` is the whole command line.
void add_device_check(CLI::App& device, const CLI::App& app, const std::string& command, int& status);
void add_device_list(CLI::App& device, const CLI::App& app, int& status);
void add_device_watch(CLI::App& device, const CLI::App& app, int& status);
void add_device_zero(CLI::App& device, const CLI::App& app, int& status);
void add_device_limits(CLI::App& device, const CLI::App& app, int& status);
void add_device_guard(CLI::App& device, const CLI::App& app, int& status);

/// Prints an error and sets the exit status; where `well` is false, 1.
void end_command(const CLI::App& app, const Result<bool>& well, int& status);

}  // namespace tactus::cli
