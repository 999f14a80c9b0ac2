// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/wire/outbox.hpp>
#include <tactus/hardware/wire/wire_end.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tactus::wire {

/// What a byte takes on a serial line of 8 data bits, no parity and one stop bit: ten bits.
constexpr std::int64_t byte_ns(std::int64_t bits_per_s) { return (10'000'000'000 + bits_per_s / 2) / bits_per_s; }

/// An end whose bytes take the time that they would on a serial line: it receives each byte when its last bit has come,
/// and what it reports is there when the last bit of the packet has gone. To be put around an emulated peer, in virtual
/// time and at a pseudo-terminal alike; the peer behind it lives at the exact times, however late a real clock calls.
///
/// The line takes one byte after the other. Where it is half duplex, that holds for both directions together: who comes
/// while the line is taken waits, so two never talk at once as on a real bus they could. Bytes that come when 16 KiB
/// wait are lost, as they are in an adapter.
class Paced final : public WireEnd {
 public:
  enum class Line { full_duplex, half_duplex };

  /// `end` must outlive it. `byte_ns` of at least 1.
  Paced(WireEnd& end, std::int64_t byte_ns, Line line);

  void hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) noexcept override;
  std::span<const std::uint8_t> say(std::int64_t now_ns) noexcept override;
  [[nodiscard]] std::int64_t wakes_ns() const noexcept override;

 private:
  struct Coming {
    std::int64_t there_ns;
    std::uint8_t byte;
  };
  /// When that many bytes are through, put on a line that is free again then.
  std::int64_t through_ns(std::int64_t& free_ns, std::size_t bytes, std::int64_t now_ns) const noexcept;
  [[nodiscard]] std::int64_t next_ns() const noexcept;
  void live_until(std::int64_t now_ns) noexcept;

  WireEnd* end_;
  std::int64_t byte_ns_;
  Line line_;
  std::vector<Coming> coming_;  ///< a ring
  std::size_t first_ = 0, count_ = 0;
  Outbox going_;
  bool began_ = false;  ///< it was called
  std::int64_t lived_until_ns_ = -1;
  std::int64_t there_free_ns_ = 0, back_free_ns_ = 0;
};

}  // namespace tactus::wire
