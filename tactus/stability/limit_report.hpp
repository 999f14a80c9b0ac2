#pragma once

#include <tactus/stability/margins_report.hpp>

namespace tactus::stability {

/// The gain limit five times: of the linear loop; of the same linear rig in time; of the linear loop with the worst of
/// the models that taps draw; of taps on the wall with friction, hysteresis and sensors still ideal; of the taps as the
/// file has them. What comes in from each to the next is the reason for the gap between the two. The ensemble of taps
/// and its judge are those of `task`. Errors: those of `report_margins` and of `TappingEnsemble::make`.
Result<simulation::Outcome> report_limit(const simulation::Request& request, const ReportOptions& options,
                                         const simulation::Progress& progress);

}  // namespace tactus::stability
