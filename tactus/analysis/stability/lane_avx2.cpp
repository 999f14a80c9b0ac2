// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/lane_block.hpp>
#include <tactus/analysis/stability/lane_targets.hpp>

namespace tactus::stability {

const LaneRunner lane_avx2_double{"avx2", 4, false, &lane_block::run<Lane<double, 4>>};
const LaneRunner lane_avx2_single{"avx2", 8, true, &lane_block::run<Lane<float, 8>>};

}  // namespace tactus::stability
