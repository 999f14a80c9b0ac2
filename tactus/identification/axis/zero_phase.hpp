// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/core/units.hpp>

#include <span>
#include <vector>

namespace tactus::identification {

/// The samples after a second-order Butterworth low-pass has run over them forward and then backward: no phase shift,
/// gain 1/2 at `cutoff_Hz`, a fourth-order fall above it.
///
/// At both ends the signal is continued by its point reflection for one and a half periods of the cutoff (or as long as
/// there are samples), and the filter starts settled, so that an offset or a ramp leaves no transient.
///
/// Errors: `out_of_bounds` for a cutoff that is not between 0 and half the sample rate; `inconsistent` for fewer than
/// two samples. Not real-time safe. Source: Gustafsson, Determining the initial states in forward-backward filtering,
/// IEEE Trans. Signal Processing 44(4), 1996 (the problem; here the padding does).
Result<std::vector<double>> zero_phase_low_pass(std::span<const double> samples, double cutoff_Hz, Seconds dt);

/// The first derivative by central differences, one-sided at both ends; at least two samples. [1/s of the samples'
/// unit]
std::vector<double> central_difference(std::span<const double> samples, Seconds dt);

}  // namespace tactus::identification
