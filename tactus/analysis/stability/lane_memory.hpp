// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace tactus::stability {

/// Numbers at an address that every lane type can load from.
class LaneMemory {
 public:
  explicit LaneMemory(std::size_t count) : chunks_(count / chunk + 1) {}
  [[nodiscard]] double* numbers() { return chunks_.front().numbers; }

 private:
  static constexpr std::size_t chunk = 8;
  struct alignas(64) Chunk {
    double numbers[chunk];
  };
  std::vector<Chunk> chunks_;
};

}  // namespace tactus::stability
