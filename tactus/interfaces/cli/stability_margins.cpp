// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/arm_stability/arm_margins_report.hpp>
#include <tactus/interfaces/cli/stability.hpp>
#include <tactus/interfaces/cli/stability_command.hpp>

namespace tactus::cli {

void add_stability_margins(CLI::App& stability, const std::string& name, const std::string& command, int& status) {
  const auto report = [](const auto& request, const auto& options, const auto&) {
    return experiments::is_of_arms(request.document) ? arm_stability::report_arm_margins(request, options)
                                                     : stability::report_margins(request, options);
  };
  add_stability_command(stability, "margins",
                        "Compute margins, poles and gain limit of the linear loop in contact, of one axis or two arms",
                        report, name, command, status);
}

}  // namespace tactus::cli
