// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/advice/arm_advise.hpp>

namespace tactus::advice {

/// Adds to an advice with a start where a gain beyond its limit goes wrong first, and how far the start would settle
/// without what stands in its way, on the taps of `draws`. Nothing where the search ended before the limit. `progress`
/// is told 0.9 to 1. Errors: those of reading the document.
Check look_for_obstacles(const ArmBench& bench, const ArmDraws& draws, ArmAdvice& advice,
                         const experiments::Progress& progress);

}  // namespace tactus::advice
