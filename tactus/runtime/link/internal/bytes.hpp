// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

namespace tactus::link {

/// Writes numbers one after the other, lowest byte first. That there is room is up to the caller.
class Writer {
 public:
  explicit Writer(std::byte* at) : at_(at) {}
  template <class Unsigned>
  void put(Unsigned value) noexcept {
    for (std::size_t i = 0; i < sizeof(value); ++i) *at_++ = static_cast<std::byte>(value >> (8 * i));
  }
  void put_signed(std::int64_t value) noexcept { put(static_cast<std::uint64_t>(value)); }
  void put_double(double value) noexcept { put(std::bit_cast<std::uint64_t>(value)); }

 private:
  std::byte* at_;
};

/// Reads them back. That there are so many bytes is up to the caller.
class Reader {
 public:
  explicit Reader(const std::byte* at) : at_(at) {}
  template <class Unsigned>
  Unsigned get() noexcept {
    Unsigned value = 0;
    for (std::size_t i = 0; i < sizeof(value); ++i) {
      value = static_cast<Unsigned>(value | static_cast<Unsigned>(std::to_integer<Unsigned>(*at_++) << (8 * i)));
    }
    return value;
  }
  std::int64_t get_signed() noexcept { return static_cast<std::int64_t>(get<std::uint64_t>()); }
  double get_double() noexcept { return std::bit_cast<double>(get<std::uint64_t>()); }

 private:
  const std::byte* at_;
};

}  // namespace tactus::link
