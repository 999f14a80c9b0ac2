// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/core/units.hpp>

#include <cstddef>
#include <vector>

/// What fits to recordings of one axis share.
namespace tactus::identification {

/// One axis, sample by sample, in N and m or, for a rotary axis, in N m and rad.
struct AxisSignals {
  std::vector<double> position = {};
  std::vector<double> force = {};  ///< toward +position; whose it is the fit states
  Seconds sample_time{0.0};
};

/// A value with the ends of its 95 % interval.
struct Estimate {
  double value = 0;
  double lower = 0;
  double upper = 0;
};

/// Errors: `out_of_bounds` for a sample time outside 10 us to 50 ms, a value that is not finite; `inconsistent` for
/// signals of different length, too short (fewer than 200 samples or half a second), constant, with a jump that looks
/// like lost samples.
Check check_axis(const AxisSignals& signals);

/// Every second sample from `first` (0 or 1) on kept, the others put on the straight line between their neighbours. The
/// two halves have the same motion and independent quantisation and noise: one gives regressors, the other instruments.
std::vector<double> every_second(const std::vector<double>& values, std::size_t first);

}  // namespace tactus::identification
