// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/map_axis.hpp>
#include <tactus/analysis/stability/map_point.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/simulation/tasks/task.hpp>

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

/// Maps of stability: a closed-loop run at every point of a grid over any described parameters.
namespace tactus::stability {

enum class MapPrecision {
  lanes_of_double,  ///< every point in double
  lanes_of_float,   ///< in float, and again in double until no verdict in float is next to a different one
};

struct MapRequest {
  MapParams base;
  std::vector<MapAxis> axes;  ///< the first slowest
  MapPrecision precision = MapPrecision::lanes_of_double;
  tasks::Place place = {};  ///< where it runs; its folder has the blocks from which a killed run continues
};

struct MapResult {
  std::vector<MapAxis> axes;
  std::vector<PointResult> points;  ///< row-major in the axes
  std::size_t resumed = 0;          ///< points that an earlier run had left
  std::size_t redone = 0;           ///< points of a float map that were run again in double
  double ticks = 0.0;               ///< loop ticks that this run computed, in all processes
  double lane_ticks = 0.0;          ///< and as many as there would be without lanes that wait for the last of a block
  std::string instruction_set;
};

/// Points per block. A block is one task.
inline constexpr std::size_t block_points = 512;

/// Number of points. Errors: `inconsistent` without an axis, for a key that is varied twice, and for more than ten
/// million points.
Result<std::size_t> count_points(const std::vector<MapAxis>& axes);

/// Runs every point that no earlier run has left in the folder. Equal requests give equal results, bit for bit,
/// whatever the engine, the number of its processes and threads, the order of the blocks, the instruction set, and
/// however often the run was killed. In a process that does not lead, computes blocks for the one that does, and
/// returns no points. The finished blocks stay in the folder until `tasks::remove_finished_tasks`.
///
/// Errors: those of `make_point`, checked at the corners of the grid before anything is run; those of `tasks::Work`.
Result<MapResult> run_map(const MapRequest& request, const std::function<void(double)>& progress);

/// The largest value of axis `along` (an index) below which every verdict is settled or ringing, for each combination
/// of the others in row-major order: 0 steps gives NaN, all steps the last value.
std::vector<double> settled_limit(const MapResult& map, std::size_t along);

/// The table of all points: a line of column names with units, then one line a point. Numbers read back to equal bits.
std::string to_csv(const MapResult& map);

}  // namespace tactus::stability
