#pragma once

#include <tactus/cli/output_folder.hpp>
#include <tactus/core/result.hpp>
#include <tactus/simulation/experiment.hpp>

namespace tactus::cli {

/// Prints the outcome, as a table or as JSON, and writes report.html, results.json and the figures to the folder if
/// there is one, which it says after a table on standard output and else on standard error.
Check write_outcome(OutputFolder& output, const simulation::Outcome& outcome);

}  // namespace tactus::cli
