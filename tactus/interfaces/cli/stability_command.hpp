// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/margins_report.hpp>

#include <functional>
#include <string>

namespace CLI {  // NOLINT: the name is not ours
class App;
}

namespace tactus::cli {

/// What a subcommand of `stability` does with a file and its options.
using StabilityReport = std::function<Result<experiments::Outcome>(
    const experiments::Request&, const stability::ReportOptions&, const experiments::Progress&)>;

/// Adds a subcommand of `stability` that reads an experiment file, with the options that all of them share, and prints
/// what `report` makes of it. `name`, `command` and `status` as in stability.hpp.
void add_stability_command(CLI::App& stability, const std::string& verb, const std::string& summary,
                           const StabilityReport& report, const std::string& name, const std::string& command,
                           int& status);

}  // namespace tactus::cli
