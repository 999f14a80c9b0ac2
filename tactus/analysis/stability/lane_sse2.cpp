// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/lane_block.hpp>
#include <tactus/analysis/stability/lane_targets.hpp>

namespace tactus::stability {

const LaneRunner lane_sse2_double{"sse2", 2, false, &lane_block::run<Lane<double, 2>>};
const LaneRunner lane_sse2_single{"sse2", 4, true, &lane_block::run<Lane<float, 4>>};

}  // namespace tactus::stability
