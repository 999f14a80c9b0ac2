// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace tactus::experiments {

/// How a joint shook over a second or so: what is left about a moving mean of a quarter of a second, which takes away
/// what hands do, below about 3 Hz, and errs by a share of 1.3 Hz over the frequency.
struct Shaking {
  double rms_rad_per_s = 0.0;  ///< of its velocity
  double frequency_Hz = 0.0;   ///< where its velocity has most power, between 2 and 200 Hz; 0 of a joint that rests
  double amplitude_rad = 0.0;  ///< half of what it moves from end to end
};

/// From what a drive reports at a fixed rate, 400 Hz or more, over half a second or more; as many of each. Not
/// real-time safe.
Shaking shaking_of(std::span<const double> position_rad, std::span<const double> velocity_rad_per_s, double rate_Hz);

/// `Shaking::rms_rad_per_s` of the same alone, without the search for the frequency. Not real-time safe.
double shaking_rms_of(std::span<const double> velocity_rad_per_s, double rate_Hz);

}  // namespace tactus::experiments
