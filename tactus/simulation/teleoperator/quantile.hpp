// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace tactus::simulation {

/// The quantile `q` in [0, 1] of at least one value, interpolated linearly between order statistics (type 7 of Hyndman
/// and Fan 1996, the default of NumPy and R).
double quantile(std::vector<double> values, double q);

}  // namespace tactus::simulation
