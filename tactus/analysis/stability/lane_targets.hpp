// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/lane_run.hpp>

/// The runners of each instruction set, each defined in a source that is compiled for it.
namespace tactus::stability {

extern const LaneRunner lane_avx512_double, lane_avx512_single;
extern const LaneRunner lane_avx2_double, lane_avx2_single;
extern const LaneRunner lane_sse2_double, lane_sse2_single;

}  // namespace tactus::stability
