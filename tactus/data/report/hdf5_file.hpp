// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace tactus::report {

/// An HDF5 file that is put together in memory and written all or nothing. Equal contents give equal bytes: no times
/// are kept. Groups of a path such as "axes/0-gain" are made where they are missing. Of one thread, never on the servo
/// path.
class Hdf5File {
 public:
  /// Name and text of an attribute.
  using Attributes = std::vector<std::pair<std::string, std::string>>;

  Hdf5File();
  ~Hdf5File();
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;

  /// Doubles as an array of `shape`, the last axis the fastest; as many as the shape asks for.
  void add_numbers(const std::string& path, std::span<const std::size_t> shape, std::span<const double> numbers,
                   const Attributes& attributes);
  /// Attributes of a group that is there.
  void describe_group(const std::string& path, const Attributes& attributes);
  void add_text(const std::string& path, const std::string& content);

  /// Errors: `unwritable`, with path, reason and remedy in the message; `failed` where something could not be added,
  /// which takes memory that has run out or a name that is there twice.
  [[nodiscard]] Check write(const std::filesystem::path& file) const;

 private:
  class Handle;
  std::unique_ptr<Handle> file_;
  bool sound_ = false;
};

}  // namespace tactus::report
