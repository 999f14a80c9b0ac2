// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/two_port_report.hpp>
#include <tactus/interfaces/cli/stability.hpp>
#include <tactus/interfaces/cli/stability_command.hpp>

namespace tactus::cli {

void add_stability_two_port(CLI::App& stability, const std::string& name, const std::string& command, int& status) {
  const auto report = [](const auto& request, const auto& options, const auto&) {
    return stability::report_two_port(request, options);
  };
  add_stability_command(stability, "two-port", "Compute transparency over frequency, absolute stability and passivity",
                        report, name, command, status);
}

}  // namespace tactus::cli
