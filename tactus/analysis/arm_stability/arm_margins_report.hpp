// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/margins_report.hpp>

/// What `tactus stability margins` prints of two arms.
namespace tactus::arm_stability {

/// Margins, limit and what rings, of an experiment of the kind arm-tapping. Of the options `friction_speed` counts, in
/// rad/s; errors: `inconsistent` for the others, those of reading the file and of `make_arm_point`, with the place of
/// the value that caused them.
Result<experiments::Outcome> report_arm_margins(const experiments::Request& request,
                                                const stability::ReportOptions& options);

}  // namespace tactus::arm_stability
