// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/report/figure.hpp>
#include <tactus/simulation/experiments/experiment.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>

#include <vector>

namespace tactus::experiments {

/// One combination of the varied parameters as it went.
struct TappingRun {
  Settings settings;
  TappingMetrics metrics;
  double observation_s = 0.0;
  double first_touch_s = 0.0;                           ///< of the tap that is shown
  std::vector<simulation::Teleoperator::Record> trace;  ///< of the tap that is shown
};

/// Paper A's Fig. 13 for these runs: displayed force and positions against time, a column for each combination of the
/// other varied parameters, cancellation off above and on below where it is varied. With more columns than fit, evenly
/// chosen ones. Then, where a number is varied, the settling time against it.
std::vector<report::Figure> tapping_figures(const std::vector<TappingRun>& runs);

}  // namespace tactus::experiments
