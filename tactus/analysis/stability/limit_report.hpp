// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/margins_report.hpp>
#include <tactus/simulation/experiments/experiment.hpp>

namespace tactus::stability {

/// The gain limit from the linear loop to the taps of the file, one thing after the other: `limit_ladder` as tables and
/// a picture, alongside the linear limit with friction as a describing function over its velocity amplitude. Errors:
/// those of `report_margins` and of `limit_ladder`.
Result<experiments::Outcome> report_limit(const experiments::Request& request, const ReportOptions& options,
                                          const experiments::Progress& progress);

}  // namespace tactus::stability
