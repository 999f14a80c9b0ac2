// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/telemetry/cdr.hpp>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace tactus::live {

/// Messages with lists and texts as CDR, member after member (the same encoding as `telemetry::to_cdr`: little-endian,
/// each member at a multiple of its size counted after the header; a list or text is preceded by its length, and a text
/// ends with a zero byte that its length counts). Allocates.
class CdrWriter {
 public:
  CdrWriter() {
    for (const unsigned char byte : telemetry::cdr_header) bytes_ += static_cast<char>(byte);
  }

  void add(double value) { add_bits(std::bit_cast<std::uint64_t>(value)); }
  void add(std::uint64_t value) { add_bits(value); }
  void add(bool value) { bytes_ += value ? '\1' : '\0'; }
  void add(std::string_view text) {
    add_bits(static_cast<std::uint32_t>(text.size() + 1));
    bytes_ += text;
    bytes_ += '\0';
  }
  void add(std::span<const float> values) {
    add_bits(static_cast<std::uint32_t>(values.size()));
    for (const float value : values) add_bits(std::bit_cast<std::uint32_t>(value));
  }

  [[nodiscard]] std::string take() && { return std::move(bytes_); }

 private:
  template <class Bits>
  void add_bits(Bits bits) {
    const std::size_t offset = bytes_.size() - telemetry::cdr_header.size();
    bytes_.append(telemetry::aligned(offset, sizeof(Bits)) - offset, '\0');
    for (std::size_t i = 0; i < sizeof(Bits); ++i) {
      bytes_ += static_cast<char>(static_cast<unsigned char>(bits >> (8 * i)));
    }
  }

  std::string bytes_;
};

}  // namespace tactus::live
