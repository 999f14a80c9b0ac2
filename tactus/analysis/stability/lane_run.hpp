// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/lane_loop.hpp>

#include <cstddef>

namespace tactus::stability {

/// One loop ready to run, as plain numbers: what a map makes of one point.
struct LanePoint {
  LaneLoop<double> loop;
  std::size_t to_slave_ticks = 0, to_master_ticks = 0, reaction_ticks = 0;
  double slave_start_m = 0.0;
};

/// How long loops run, the same for all of a block.
struct LanePlan {
  LoopClock clock;
  std::size_t approach_ticks = 0;     ///< a slave that has not met the wall by then never will
  std::size_t observation_ticks = 1;  ///< from first touch
  [[nodiscard]] std::size_t longest() const { return approach_ticks + observation_ticks; }
};

/// How one run went.
struct LaneResult {
  std::size_t ticks = 0;        ///< that were run, or until it diverged
  std::size_t first_touch = 0;  ///< tick
  bool touched = false;
  bool diverged = false;  ///< the master or the slave left its workspace of 1 m, or a number was none
  double touches = 0.0;
  double peak_force_N = 0.0;  ///< largest substep's contact force
};

/// How many numbers of memory the delays of a block need, at most: for any choice of `lanes` of these points.
std::size_t lane_room(const LanePoint* points, std::size_t count, std::size_t lanes);

/// Runs `lanes` points at once. `points` and `results` have that many entries; entries of `points` may repeat. The mean
/// contact force of lane i at tick n is left in `force_N[n * lanes + i]`, `longest()` ticks of room; `lines` is memory
/// for the delays, `lane_room` numbers, aligned to 64 bytes.
/// Denormals are flushed to zero. Real-time safe but for its length.
struct LaneRunner {
  const char* name;  ///< of the instruction set
  std::size_t lanes;
  bool single;  ///< in float
  void (*run)(const LanePoint* const* points, const LanePlan& plan, double* lines, double* force_N,
              LaneResult* results);
};

/// The runner for the widest registers that this machine has. `single`: in float.
const LaneRunner& lane_runner(bool single);
/// One point at a time, in double: what every lane of the others must equal.
const LaneRunner& scalar_runner();

/// All that this build has and this machine can run, the scalar one first.
struct LaneRunners {
  const LaneRunner* all[8];
  std::size_t count;
};
LaneRunners lane_runners();

}  // namespace tactus::stability
