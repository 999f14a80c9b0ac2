// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/interfaces/cli/line_writer.hpp>
#include <tactus/interfaces/cli/output_folder.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/simulation/experiments/experiment.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace tactus::cli {

/// A file that a command leaves alongside report.html, results.json and the figures, and has named as its own.
struct NamedText {
  std::string name;
  std::string text;
};

/// Writes report.html, results.json, the figures and these files to the folder.
Check write_results(OutputFolder& output, const experiments::Outcome& outcome,
                    const std::vector<NamedText>& files = {});

/// Writes the results to the folder, if there is one, and prints the outcome, as a table or as JSON. In this order, so
/// that the report is there whoever reads what is printed. Where the report is it states after a table on standard
/// output and else on standard error.
Check write_outcome(OutputFolder& output, const experiments::Outcome& outcome,
                    const std::vector<NamedText>& files = {});

/// The same to the folder that the options name.
Check write_outcome(const OutputOptions& options, const experiments::Outcome& outcome,
                    const std::vector<NamedText>& files = {});

/// The same of a run at the real clock that printed a line a second, and left a log. Files first: a terminal that
/// nobody reads keeps nothing from them, and with them what it misses is no loss. `log_error` is what went wrong with
/// the log, of which `removed` records went for its limit.
Check leave_outcome(const experiments::Outcome& outcome, OutputFolder& folder, Check log_error, std::uint64_t removed,
                    LineWriter& output, LineWriter& errors);

/// The error of a run whose outcome was left and that ended in this fault; other failures are reported before.
Error ended_in_a_fault(const std::string& fault, Check unwritten, LineWriter& errors);

}  // namespace tactus::cli
