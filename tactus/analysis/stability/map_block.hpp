// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/map_point.hpp>
#include <tactus/kernel/core/result.hpp>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

/// A block of a map as a task: its key, which states which points to run, and its value, which states what came out.
namespace tactus::stability {

struct MapBlockKey {
  bool single = false;              ///< on lanes of float
  std::vector<std::size_t> points;  ///< indices into the grid
};

struct MapBlock {
  double ticks = 0.0;       ///< loop ticks of its points
  double lane_ticks = 0.0;  ///< and of all lanes, those that waited for the last one included
  std::vector<PointResult> points;
};

std::string to_bytes(const MapBlockKey& key);
std::string to_bytes(const MapBlock& block);
/// Reads a key of a grid with so many points. Errors: `failed` for bytes that are no such key.
Result<MapBlockKey> map_block_key(std::string_view bytes, std::size_t grid_points);
/// Reads a block of so many points. Errors: `failed` for bytes that are no such block.
Result<MapBlock> map_block(std::string_view bytes, std::size_t points);

}  // namespace tactus::stability
