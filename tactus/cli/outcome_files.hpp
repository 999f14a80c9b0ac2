#pragma once

#include <tactus/core/result.hpp>
#include <tactus/simulation/experiment.hpp>

#include <filesystem>
#include <optional>
#include <string>

namespace tactus::cli {

/// Proves that results could be written to `folder`, before long work, without making it: a request that turns out to
/// be wrong leaves nothing behind.
Check check_writable(const std::string& folder);

/// Writes report.html, results.json and the figures; the folder is made.
Check write_results(const std::filesystem::path& folder, const simulation::Outcome& outcome);

/// Writes the results to the folder `out` if there is one, and prints the outcome, as a table or as JSON. In this order,
/// so that the report is there whoever reads what is printed. Where the report is it says after a table on standard
/// output and else on standard error.
Check write_outcome(const std::optional<std::string>& out, const simulation::Outcome& outcome, bool json);

}  // namespace tactus::cli
