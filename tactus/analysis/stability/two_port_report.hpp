// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/margins_report.hpp>
#include <tactus/simulation/experiments/experiment.hpp>

namespace tactus::stability {

/// The two-port between hand and tip: hybrid matrix, Llewellyn's index, passivity, transmitted impedance and
/// transparency, as a table at some frequencies, and over all of them as pictures and in the JSON document. Errors:
/// those of `report_margins`.
Result<experiments::Outcome> report_two_port(const experiments::Request& request, const ReportOptions& options);

}  // namespace tactus::stability
