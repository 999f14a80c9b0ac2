// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tactus::devices {

/// Bytes of one packet to servos, in the order in which they go out. Its room is that of a command to sixteen servos;
/// what is put beyond it is left out. Real-time safe.
class ServoPacket {
 public:
  static constexpr std::size_t room = 192;

  constexpr void put(std::uint8_t byte) noexcept {
    if (size_ < room) bytes_[size_++] = byte;
  }
  /// The low `size` bytes of a number, the lowest first; two's complement.
  constexpr void put(std::int64_t value, std::size_t size) noexcept {
    for (std::size_t i = 0; i < size; ++i) put(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i)));
  }
  constexpr void put(std::span<const std::uint8_t> bytes) noexcept {
    for (const std::uint8_t byte : bytes) put(byte);
  }
  [[nodiscard]] constexpr std::size_t size() const noexcept { return size_; }
  [[nodiscard]] constexpr std::span<const std::uint8_t> bytes() const noexcept { return {bytes_.data(), size_}; }

 private:
  std::array<std::uint8_t, room> bytes_{};
  std::size_t size_ = 0;
};

/// A number without sign, the lowest byte first. At most eight bytes.
constexpr std::int64_t little_endian(std::span<const std::uint8_t> bytes) noexcept {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) value |= std::uint64_t{bytes[i]} << (8 * i);
  return static_cast<std::int64_t>(value);
}

/// The bytes that came and are not read yet, from the place on where a packet may begin. `Format` reports what a packet
/// is; `next` finds it, or the next place where one may begin. A packet that is damaged or only looked like one costs
/// its first byte: what is behind that is looked at again. Real-time safe.
///
///     struct Format {
///       static constexpr std::size_t most;                                // bytes of the longest packet
///       static std::size_t size(std::span<const std::uint8_t> begun);     // of the packet that begins here: 0 where
///     };                                                                  // none does, more than there are: not yet
template <class Format>
class PacketFinder {
 public:
  /// Hands each whole packet to `take(std::span<const std::uint8_t>)`.
  template <class Take>
  constexpr void hear(std::span<const std::uint8_t> bytes, Take&& take) noexcept {
    for (const std::uint8_t byte : bytes) {
      begun_[size_++] = byte;
      find(take);
    }
  }
  /// Nothing more will come of the packet that began: what is behind its first byte counts.
  template <class Take>
  constexpr void give_up(Take&& take) noexcept {
    while (size_ > 0) {
      drop(1);
      find(take);
    }
  }

 private:
  template <class Take>
  constexpr void find(Take&& take) noexcept {
    while (size_ > 0) {
      const std::size_t size = Format::size({begun_.data(), size_});
      if (size == 0) {
        drop(1);
      } else if (size > size_) {
        return;
      } else {
        take(std::span<const std::uint8_t>(begun_.data(), size));
        drop(size);
      }
    }
  }
  constexpr void drop(std::size_t bytes) noexcept {
    std::copy(begun_.begin() + static_cast<std::ptrdiff_t>(bytes), begun_.begin() + static_cast<std::ptrdiff_t>(size_),
              begun_.begin());
    size_ -= bytes;
  }

  std::array<std::uint8_t, Format::most> begun_{};
  std::size_t size_ = 0;
};

}  // namespace tactus::devices
