#pragma once

#include <tactus/cli/output_folder.hpp>
#include <tactus/core/result.hpp>
#include <tactus/experiments/experiment.hpp>

namespace tactus::cli {

/// Writes report.html, results.json and the figures to the folder.
Check write_results(OutputFolder& output, const experiments::Outcome& outcome);

/// Writes the results to the folder, if there is one, and prints the outcome, as a table or as JSON. In this order, so
/// that the report is there whoever reads what is printed. Where the report is it says after a table on standard output
/// and else on standard error.
Check write_outcome(OutputFolder& output, const experiments::Outcome& outcome);

}  // namespace tactus::cli
