// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/linearisation.hpp>
#include <tactus/simulation/experiments/experiment.hpp>

/// What the commands of `tactus stability` print, from an experiment file of the kind `tapping`.
namespace tactus::stability {

/// What an operator may choose alongside the file.
struct ReportOptions {
  Linearisation linearisation;
  double uncertainty = 0.2;  ///< share by which the controller's model may be wrong, for the small-gain bound
};

/// Margins, poles and gain limit of the linear loop, with Bode, Nyquist and Nichols figures. Errors: those of reading
/// the file and of `make_loop`, with the place of the value that caused them. No variations are looked at.
Result<experiments::Outcome> report_margins(const experiments::Request& request, const ReportOptions& options);

}  // namespace tactus::stability
