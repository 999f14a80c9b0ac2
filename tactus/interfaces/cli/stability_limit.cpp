// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/limit_report.hpp>
#include <tactus/interfaces/cli/stability.hpp>
#include <tactus/interfaces/cli/stability_command.hpp>

namespace tactus::cli {

void add_stability_limit(CLI::App& stability, const std::string& name, const std::string& command, int& status) {
  add_stability_command(stability, "limit",
                        "Find the gain limit of the linear loop, of its simulation, and of simulated taps",
                        stability::report_limit, name, command, status);
}

}  // namespace tactus::cli
