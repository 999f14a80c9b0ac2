// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace tactus::experiments {

/// The largest gain up to which everything that was tried settled.
struct GainLimit {
  double gain = 0.0;           ///< 0 when not even the lowest gain of the search settled
  bool beyond_search = false;  ///< the highest gain of the search settled too: the limit is at least `gain`
  /// Whether the search cut the limit off: it lies above its highest gain, or below its lowest.
  [[nodiscard]] bool censored() const { return beyond_search || gain == 0.0; }
};

/// Ratio of the bracket's ends at which a search ends that is not reported another.
inline constexpr double gain_resolution = 1.02;

/// Searches from `lowest` to `highest`, 0 < `lowest` < `highest`. It begins at 1, or at the nearer end, and goes in
/// steps of √2: upward from a gain that settles until one does not, downward from one that does not until one does.
/// Then it bisects the ratio until the largest gain that settled and the smallest that did not are within `resolution`
/// of one another, a ratio above 1.
///
/// Settling need not be monotone in the gain, so what lies beyond the first failure is not tried: a device that rings
/// at 3 and settles at 10 has a limit below 3. Between two steps of √2 a failure may go unseen.
GainLimit find_gain_limit(double lowest, double highest, const std::function<bool(double gain)>& settles,
                          double resolution = gain_resolution);

}  // namespace tactus::experiments
