// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/map_point.hpp>
#include <tactus/kernel/core/result.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <utility>
#include <vector>

namespace tactus::stability {

/// What runs of one map have finished so far: files `blocks-RANK.partial` of one folder, one for each process.
///
/// A file begins with the identity of the map; then come blocks, each written at once and with its checksum (CRC-32).
/// What a killed process left half written does not match its checksum and is cut off.
class MapStore {
 public:
  /// Opens the file of this rank and cuts off what is no whole block. `identity` is a hash of everything that the
  /// results depend on. Errors: `inconsistent` for a file of another map, `unwritable`.
  static Result<MapStore> open(const std::filesystem::path& folder, std::uint64_t identity, std::size_t rank);
  MapStore(MapStore&& other) noexcept;
  MapStore& operator=(MapStore&&) = delete;
  ~MapStore();

  struct Block {
    std::uint64_t number = 0;
    std::vector<PointResult> points;
  };

  /// The whole blocks of all ranks so far, in any order, some perhaps twice. Errors: `inconsistent` for a file of
  /// another map.
  [[nodiscard]] Result<std::vector<Block>> read_all() const;
  /// Appends one block with one write. Errors: `unwritable`.
  Check append(std::uint64_t number, const PointResult* points, std::size_t count);
  /// Whether nobody has removed the file of this rank.
  [[nodiscard]] bool is_there() const;
  /// Removes the files of all ranks: the map is complete and its results are written.
  static void remove_all(const std::filesystem::path& folder);

 private:
  MapStore(std::filesystem::path folder, std::uint64_t identity, std::size_t rank, int file)
      : folder_(std::move(folder)), identity_(identity), rank_(rank), file_(file) {}
  std::filesystem::path folder_;
  std::uint64_t identity_;
  std::size_t rank_;
  int file_;
};

}  // namespace tactus::stability
