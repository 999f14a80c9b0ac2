// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <span>

/// Bytes between a computer and a device, and their time. Nothing here knows what they mean.
namespace tactus::wire {

/// A time that never comes.
inline constexpr std::int64_t never_ns = std::numeric_limits<std::int64_t>::max();

/// One end of a wire, without the wire: what it reports to what it receives, and when. A driver's bus is one, the
/// emulated peer of a motor is one. It opens nothing and reads no clock, so the same object runs in virtual time,
/// against its peer, and at the real clock, at a port.
///
/// All calls come from one thread, with times that never go back. None allocates, locks, throws or blocks.
class WireEnd {
 public:
  virtual ~WireEnd() = default;
  /// Bytes that arrived, in pieces of any size: a packet may be cut anywhere, and garbage may be between two.
  virtual void hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) noexcept = 0;
  /// The next packet that it reports at this time, whole; empty without one. It is valid until the next call of
  /// any member. Whoever drives the end calls this until it is empty.
  virtual std::span<const std::uint8_t> say(std::int64_t now_ns) noexcept = 0;
  /// When it wants `say` called again where nothing arrives before: a deadline, or the time of an answer. `never_ns`
  /// where only what it receives moves it.
  [[nodiscard]] virtual std::int64_t wakes_ns() const noexcept = 0;
};

}  // namespace tactus::wire
