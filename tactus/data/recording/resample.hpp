// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/recording/recording.hpp>
#include <tactus/kernel/core/units.hpp>

#include <span>
#include <vector>

namespace tactus::recording {

/// The signal at another sample time, from its first sample to its last and not beyond.
///
/// Between samples runs the cubic Hermite curve through them whose slopes are central differences (Catmull-Rom), at the
/// ends the slope of the parabola through the three nearest samples. Original samples are kept exactly, and so are
/// constants, straight lines and parabolas; a sine at a tenth of the recording's rate keeps its amplitude
/// within 0.5 %. A step overshoots by less than 8 % of its height (13 % in the first and last interval). Nothing is
/// filtered.
///
/// The new sample time must be positive and must not be longer than that of the recording: a slower rate folds
/// everything above half of it back into the signal, so a recording has to be low-pass filtered first, knowingly.
/// Sample times that differ by less than one part in a million count as equal, and the values come back untouched.
///
/// Errors: a signal without a sample time; a sample time out of bounds; a result of more than 1e8 samples. Not
/// real-time safe. Source: Catmull and Rom, A class of local interpolating splines, 1974.
Result<Signal> resample(const Signal& signal, Seconds sample_time);

/// Samples that were taken at unequal times, at as many equal steps from the first to the last of them, on a cubic
/// curve whose slope at each sample is that of the parabola through it and its neighbours. `time_s` must increase
/// strictly. Not real-time safe.
std::vector<double> at_equal_steps(std::span<const double> time_s, std::span<const double> values);

/// The same at `count` steps of `step_s` from `first_s` on, which lie between the first and the last sample; beyond
/// them the value of the nearest. At least two samples.
std::vector<double> at_steps(std::span<const double> time_s, std::span<const double> values, double first_s,
                             double step_s, std::size_t count);

}  // namespace tactus::recording
