// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/margins_report.hpp>

namespace tactus::stability {

/// The scorecard of the master in the file, its two-port over frequency in a figure, and the closed-form bounds on a
/// virtual wall. Errors: those of `report_margins`.
Result<experiments::Outcome> report_scorecard(const experiments::Request& request, const ReportOptions& options,
                                              const experiments::Progress& progress);

}  // namespace tactus::stability
