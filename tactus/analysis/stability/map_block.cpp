// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/map_block.hpp>
#include <tactus/simulation/tasks/bytes.hpp>

#include <cstdint>

namespace tactus::stability {

namespace {

Error no_block(const char* message) {
  return {.code = ErrorCode::failed, .parameter = {}, .message = message, .place = {}};
}

}  // namespace

// Most blocks are neighbours in the grid, so a key has runs of successive points: the first, and how many.
std::string to_bytes(const MapBlockKey& key) {
  tasks::ByteWriter bytes;
  bytes.put(key.single);
  for (std::size_t i = 0; i < key.points.size();) {
    std::size_t length = 1;
    while (i + length < key.points.size() && key.points[i + length] == key.points[i] + length) ++length;
    bytes.put(static_cast<std::uint32_t>(key.points[i])).put(static_cast<std::uint32_t>(length));
    i += length;
  }
  return bytes.take();
}

std::string to_bytes(const MapBlock& block) {
  tasks::ByteWriter bytes;
  bytes.put(block.ticks).put(block.lane_ticks);
  for (const PointResult& point : block.points) {
    bytes.put(static_cast<std::uint8_t>(point.verdict))
        .put(point.settling_time_s)
        .put(point.contacts)
        .put(point.peak_force_N)
        .put(point.residual_rms_N);
  }
  return bytes.take();
}

Result<MapBlockKey> map_block_key(std::string_view bytes, std::size_t grid_points) {
  tasks::ByteReader reader(bytes);
  MapBlockKey key{.single = reader.get<bool>(), .points = {}};
  while (!reader.rest().empty()) {
    const std::size_t first = reader.get<std::uint32_t>(), length = reader.get<std::uint32_t>();
    if (first + length > grid_points) return no_block("a block has points outside of this map: start the job again");
    for (std::size_t i = 0; i < length; ++i) key.points.push_back(first + i);
  }
  if (!reader.complete() || key.points.empty()) return no_block("a block has no points: start the job again");
  return key;
}

Result<MapBlock> map_block(std::string_view bytes, std::size_t points) {
  tasks::ByteReader reader(bytes);
  MapBlock block{.ticks = reader.get<double>(), .lane_ticks = reader.get<double>(), .points = {}};
  for (std::size_t i = 0; i < points; ++i) {
    PointResult& point = block.points.emplace_back();
    point.verdict = static_cast<experiments::Verdict>(reader.get<std::uint8_t>());
    reader.get(point.settling_time_s);
    reader.get(point.contacts);
    reader.get(point.peak_force_N);
    reader.get(point.residual_rms_N);
  }
  if (!reader.complete()) return no_block("a finished block has another size than this map's: remove the file of them");
  return block;
}

}  // namespace tactus::stability
