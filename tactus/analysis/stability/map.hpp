// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/map_axis.hpp>
#include <tactus/analysis/stability/map_point.hpp>
#include <tactus/kernel/core/result.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

/// Maps of stability: a closed-loop run at every point of a grid over any described parameters.
namespace tactus::stability {

enum class MapPrecision {
  lanes_of_double,  ///< every point in double
  lanes_of_float,   ///< in float, and again in double until no verdict in float is next to a different one
};

/// A share of the work: process `rank` of `ranks`, which all write to one folder.
struct MapShare {
  std::size_t rank = 0, ranks = 1;
};

struct MapRequest {
  MapParams base;
  std::vector<MapAxis> axes;  ///< the first slowest
  MapPrecision precision = MapPrecision::lanes_of_double;
  std::filesystem::path folder;  ///< for partial results, from where a killed run continues; empty: none
  MapShare share;
  std::size_t threads = 0;  ///< 0: as many as the machine has cores
};

struct MapResult {
  std::vector<MapAxis> axes;
  std::vector<PointResult> points;  ///< row-major in the axes
  std::size_t resumed = 0;          ///< points that an earlier run had left
  std::size_t redone = 0;           ///< points of a float map that were run again in double
  double ticks = 0.0;               ///< loop ticks that this process ran
  double lane_ticks = 0.0;          ///< and as many as there would be without lanes that wait for the last of a block
  std::string instruction_set;
};

/// Points per block: what a thread takes, a partial file gains, and a killed run loses at most.
inline constexpr std::size_t block_points = 512;

/// Number of points. Errors: `inconsistent` without an axis, for a key that is varied twice, and for more than ten
/// million points.
Result<std::size_t> count_points(const std::vector<MapAxis>& axes);

/// Runs every point that no earlier run has left in the folder. Equal requests give equal results, bit for bit,
/// whatever the number of threads and ranks, the order of the blocks, the instruction set, and however often the run
/// was killed. A rank above 0 returns with what it knows when its own share is done; rank 0 waits for the others. The
/// finished blocks stay in the folder until `remove_partial`.
///
/// Errors: those of `make_point`, checked at the corners of the grid before anything is run; `inconsistent` for a
/// folder that holds a part of another map; `unwritable`.
Result<MapResult> run_map(const MapRequest& request, const std::function<void(double)>& progress);

/// Removes the finished blocks of all ranks: what rank 0 does once the results are written.
void remove_partial(const std::filesystem::path& folder);

/// The largest value of axis `along` (an index) below which every verdict is settled or ringing, for each combination
/// of the others in row-major order: 0 steps gives NaN, all steps the last value.
std::vector<double> settled_limit(const MapResult& map, std::size_t along);

/// The table of all points: a line of column names with units, then one line a point. Numbers read back to equal bits.
std::string to_csv(const MapResult& map);

}  // namespace tactus::stability
