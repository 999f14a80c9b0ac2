// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <array>
#include <cstddef>
#include <filesystem>

namespace tactus::link {

/// A secret that both sites share. Wiped from memory when it goes.
class Key {
 public:
  static constexpr std::size_t bytes = 32;
  Key() = default;
  Key(const Key&) = default;
  Key& operator=(const Key&) = default;
  ~Key();

  std::array<unsigned char, bytes> secret{};
};

/// Draws a key from the operating system and writes it as 64 hexadecimal digits into a new file that only its owner may
/// read. Errors: `unwritable`, also where the file is there already: a key is never overwritten.
Check make_key_file(const std::filesystem::path& file);

/// Reads such a file. Errors: `missing`; `inconsistent` where it is no regular file of the user who asks, or others may
/// touch it, or where it holds a key that was plainly not drawn at random, as zeros; `syntax` where it holds
/// something else.
Result<Key> read_key_file(const std::filesystem::path& file);

}  // namespace tactus::link
