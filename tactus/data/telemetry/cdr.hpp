// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/telemetry/description.hpp>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace tactus::telemetry {

/// Records as CDR, the bytes of ROS 2 and DDS (OMG DDSI-RTPS 2.3 §10, XCDR version 1): a header of four bytes that
/// states little-endian plain CDR, then the members in order, each at a multiple of its size counted after the header.
inline constexpr std::array<unsigned char, 4> cdr_header{0x00, 0x01, 0x00, 0x00};

/// Where a member of `size` bytes begins that may not begin before `offset`.
constexpr std::size_t aligned(std::size_t offset, std::size_t size) { return (offset + size - 1) / size * size; }

/// Bytes of a record, header included.
template <Recordable Record>
constexpr std::size_t cdr_size() {
  std::size_t offset = 0;
  for_each_signal<Record>([&offset](const auto& signal) {
    using Value = typename std::remove_cvref_t<decltype(signal)>::value_type;
    constexpr std::size_t size = std::is_same_v<Value, bool> ? 1 : 8;
    offset = aligned(offset, size) + size;
  });
  return cdr_header.size() + offset;
}

/// A record as CDR. Does not allocate.
template <Recordable Record>
std::array<unsigned char, cdr_size<Record>()> to_cdr(const Record& record) noexcept {
  std::array<unsigned char, cdr_size<Record>()> bytes{};
  std::size_t offset = 0;
  for (std::size_t i = 0; i < cdr_header.size(); ++i) bytes[i] = cdr_header[i];
  for_each_signal<Record>([&](const auto& signal) {
    using Value = typename std::remove_cvref_t<decltype(signal)>::value_type;
    if constexpr (std::is_same_v<Value, bool>) {
      bytes[cdr_header.size() + offset++] = record.*signal.member ? 1 : 0;
    } else {
      offset = aligned(offset, 8);
      const auto bits = std::bit_cast<std::uint64_t>(record.*signal.member);
      for (std::size_t i = 0; i < 8; ++i) {
        bytes[cdr_header.size() + offset++] = static_cast<unsigned char>(bits >> (8 * i));
      }
    }
  });
  return bytes;
}

/// The values of a message in the order of its columns, as numbers (a bool is 0 or 1; a whole number beyond 2^53 is
/// rounded). Errors: `syntax` for a message that is not little-endian plain CDR or too short.
Result<std::vector<double>> from_cdr(std::span<const unsigned char> message, const std::vector<Column>& columns);

}  // namespace tactus::telemetry
