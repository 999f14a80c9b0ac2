// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/wire/wire_end.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tactus::wire {

/// Packets that wait for their time, sent in the order in which they were put in. Allocates when made only; real-time
/// safe after that.
class Outbox {
 public:
  /// Room for so many bytes, with 16 more for each packet.
  explicit Outbox(std::size_t bytes) : room_(bytes) {}

  /// False, and nothing happened, where there is no room. A packet without bytes is refused.
  bool put(std::span<const std::uint8_t> packet, std::int64_t due_ns) noexcept;
  /// The first packet, where its time has come; empty where not. It is valid until the next call.
  std::span<const std::uint8_t> take(std::int64_t now_ns) noexcept;
  /// When the first packet is due; `never_ns` without one.
  [[nodiscard]] std::int64_t due_ns() const noexcept;
  void clear() noexcept { begin_ = end_ = 0; }

 private:
  struct Head {
    std::int64_t due_ns;
    std::uint64_t size;
  };
  [[nodiscard]] Head head() const noexcept;

  std::vector<std::uint8_t> room_;
  std::size_t begin_ = 0, end_ = 0;
};

}  // namespace tactus::wire
