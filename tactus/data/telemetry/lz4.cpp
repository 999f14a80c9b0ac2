// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/lz4.hpp>
#include <tactus/data/telemetry/mcap_format.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace tactus::telemetry {
namespace {

using mcap::Cursor;

/// A length whose first part is the token's four bits; 15 goes on in further bytes until one is not 255.
std::uint64_t length_from(unsigned bits, Cursor& block) {
  std::uint64_t length = bits;
  for (unsigned char more = bits == 15 ? 255 : 0; more == 255 && block.ok();) {
    more = block.take<unsigned char>();
    length += more;
  }
  return length;
}

/// Unpacks one block behind what is there already; `filled` moves behind it. The block may refer to all before it.
bool unpack_block(std::string_view bytes, std::string& into, std::size_t& filled) {
  Cursor block(bytes);
  while (block.ok()) {
    const unsigned token = block.take<unsigned char>();
    const std::string_view literals = block.take_bytes(length_from(token >> 4U, block));
    if (!block.ok() || literals.size() > into.size() - filled) return false;
    std::copy(literals.begin(), literals.end(), into.begin() + static_cast<std::ptrdiff_t>(filled));
    filled += literals.size();
    if (block.rest().empty()) return true;  // the last sequence is literals alone
    const std::size_t offset = block.take<std::uint16_t>();
    constexpr std::uint64_t shortest_match = 4;
    const std::uint64_t length = shortest_match + length_from(token & 15U, block);
    if (!block.ok() || offset == 0 || offset > filled || length > into.size() - filled) return false;
    // Byte by byte, for a match may overlap what it makes.
    for (std::uint64_t i = 0; i < length; ++i, ++filled) into[filled] = into[filled - offset];
  }
  return false;
}

}  // namespace

bool unpack_lz4(std::string_view frames, std::string& into) {
  constexpr std::uint32_t magic = 0x184D2204, uncompressed = 0x80000000;
  constexpr unsigned version_bits = 0xC0, version_1 = 0x40, block_checksums = 0x10, states_size = 0x08,
                     content_checksum = 0x04, needs_dictionary = 0x01;
  Cursor cursor(frames);
  std::size_t filled = 0;
  while (!cursor.rest().empty()) {
    if (cursor.take<std::uint32_t>() != magic) return false;
    const unsigned flags = cursor.take<unsigned char>();
    if ((flags & version_bits) != version_1 || (flags & needs_dictionary) != 0) return false;
    cursor.take_bytes(1);  // the greatest size of a block
    if ((flags & states_size) != 0) cursor.take<std::uint64_t>();
    cursor.take_bytes(1);  // checksum of the head
    while (true) {
      const auto size = cursor.take<std::uint32_t>();
      if (!cursor.ok()) return false;
      if (size == 0) break;
      const std::string_view block = cursor.take_bytes(size & ~uncompressed);
      if ((flags & block_checksums) != 0) cursor.take_bytes(4);
      if (!cursor.ok()) return false;
      if ((size & uncompressed) == 0) {
        if (!unpack_block(block, into, filled)) return false;
        continue;
      }
      if (block.size() > into.size() - filled) return false;
      std::copy(block.begin(), block.end(), into.begin() + static_cast<std::ptrdiff_t>(filled));
      filled += block.size();
    }
    if ((flags & content_checksum) != 0) cursor.take_bytes(4);
    if (!cursor.ok()) return false;
  }
  return filled == into.size();
}

}  // namespace tactus::telemetry
