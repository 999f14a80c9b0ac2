// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

namespace tactus::mechanics {

/// The smoothest way for a hand from one place to another: the minimum-jerk reach
///
///     x(s) = start + (end − start)·(10 s³ − 15 s⁴ + 6 s⁵),   s = (t − start time) / duration in [0, 1]
///
/// Rests before and after. The speed peaks half-way at 1.875·(end − start)/duration.
/// Source: Flash and Hogan 1985, J. Neuroscience 5(7), eq. 3.
struct MinimumJerk {
  double start_m = 0.0;
  double end_m = 0.0;
  double start_time_s = 0.0;
  double duration_s = 1.0;

  /// Duration for which the reach over `stroke_m` peaks at `peak_speed_m_per_s`.
  static constexpr double duration_for(double stroke_m, double peak_speed_m_per_s) {
    return 1.875 * stroke_m / peak_speed_m_per_s;
  }

  [[nodiscard]] constexpr double position_m(double time_s) const noexcept {
    const double s = std::clamp((time_s - start_time_s) / duration_s, 0.0, 1.0);
    return start_m + (end_m - start_m) * s * s * s * (10.0 + s * (-15.0 + 6.0 * s));
  }
};

}  // namespace tactus::mechanics
