// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/scorecard_report.hpp>
#include <tactus/interfaces/cli/stability.hpp>
#include <tactus/interfaces/cli/stability_command.hpp>

namespace tactus::cli {

void add_stability_scorecard(CLI::App& stability, const std::string& name, const std::string& command, int& status) {
  add_stability_command(stability, "scorecard", "Rate a leader device by the induced motion that it allows",
                        stability::report_scorecard, name, command, status);
}

}  // namespace tactus::cli
