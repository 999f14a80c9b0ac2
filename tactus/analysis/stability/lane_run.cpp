// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/lane_block.hpp>
#include <tactus/analysis/stability/lane_run.hpp>
#include <tactus/analysis/stability/lane_targets.hpp>

#include <algorithm>

namespace tactus::stability {

const LaneRunner& scalar_runner() {
  static constexpr LaneRunner runner{"scalar", 1, false, &lane_block::run<double>};
  return runner;
}

LaneRunners lane_runners() {
  LaneRunners runners{{&scalar_runner(), &lane_sse2_double, &lane_sse2_single}, 3};
  const auto add = [&runners](const LaneRunner& wide, const LaneRunner& single) {
    runners.all[runners.count++] = &wide;
    runners.all[runners.count++] = &single;
  };
  if (__builtin_cpu_supports("avx2")) add(lane_avx2_double, lane_avx2_single);
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512bw")) {
    add(lane_avx512_double, lane_avx512_single);
  }
  return runners;
}

std::size_t lane_room(const LanePoint* points, std::size_t count, std::size_t lanes) {
  std::size_t to_slave = 0, to_master = 0, reaction = 0;
  for (std::size_t i = 0; i < count; ++i) {
    to_slave = std::max(to_slave, points[i].to_slave_ticks);
    to_master = std::max(to_master, points[i].to_master_ticks);
    reaction = std::max(reaction, points[i].reaction_ticks);
  }
  return (to_slave + to_master + reaction + 3) * lanes;
}

const LaneRunner& lane_runner(bool single) {
  const LaneRunners runners = lane_runners();
  return *runners.all[single ? runners.count - 1 : runners.count - 2];
}

}  // namespace tactus::stability
