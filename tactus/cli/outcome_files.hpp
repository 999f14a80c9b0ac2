#pragma once

#include <tactus/core/result.hpp>
#include <tactus/simulation/experiment.hpp>

#include <optional>
#include <string>

namespace tactus::cli {

/// Proves that results could be written to `folder`, before long work, without making it: a request that turns out to
/// be wrong leaves nothing behind.
Check check_writable(const std::string& folder);

/// Prints the outcome, as a table or as JSON, and writes report.html, results.json and the figures to the folder `out`
/// if there is one, which it says after a table on standard output and else on standard error.
Check write_outcome(const std::optional<std::string>& out, const simulation::Outcome& outcome, bool json);

}  // namespace tactus::cli
