// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace CLI {  // NOLINT: the name is not ours
class App;
}

/// What `tactus stability` can determine: each adds one subcommand to `stability`, in a file of its own
/// (`stability_<what>.cpp`). When chosen, it does its work and leaves its exit status in `status`; messages begin with
/// `name`, which is what the program calls itself; `command` is the whole command line, for the report.
namespace tactus::cli {

void add_stability_limit(CLI::App& stability, const std::string& name, const std::string& command, int& status);
void add_stability_map(CLI::App& stability, const std::string& name, const std::string& command, int& status);
void add_stability_margins(CLI::App& stability, const std::string& name, const std::string& command, int& status);
void add_stability_scorecard(CLI::App& stability, const std::string& name, const std::string& command, int& status);
void add_stability_two_port(CLI::App& stability, const std::string& name, const std::string& command, int& status);

}  // namespace tactus::cli
