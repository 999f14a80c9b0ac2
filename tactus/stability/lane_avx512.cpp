#include <tactus/stability/lane_block.hpp>
#include <tactus/stability/lane_targets.hpp>

namespace tactus::stability {

const LaneRunner lane_avx512_double{"avx512", 8, false, &lane_block::run<Lane<double, 8>>};
const LaneRunner lane_avx512_single{"avx512", 16, true, &lane_block::run<Lane<float, 16>>};

}  // namespace tactus::stability
