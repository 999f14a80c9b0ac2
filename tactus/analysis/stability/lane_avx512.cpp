// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/lane_block.hpp>
#include <tactus/analysis/stability/lane_targets.hpp>

namespace tactus::stability {

const LaneRunner lane_avx512_double{"avx512", 16, false, &lane_block::run<LanePair<Lane<double, 8>>>};
const LaneRunner lane_avx512_single{"avx512", 32, true, &lane_block::run<LanePair<Lane<float, 16>>>};

}  // namespace tactus::stability
