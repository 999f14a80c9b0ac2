// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace tactus::bench {

/// Forces as taps on a stiff wall display them, in N, one for each servo tick of 200 µs: a second of impacts that ring
/// at 100 to 200 Hz, decay within 10 to 30 ms, lean on the wall for a while and let go. Up to 1 N, where the display
/// saturates; friction sticks and slips many times.
std::vector<double> impact_forces();

inline constexpr double tick_s = 200e-6;

}  // namespace tactus::bench
