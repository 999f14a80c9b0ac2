// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/emulation/servo_faults.hpp>
#include <tactus/hardware/wire/outbox.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tactus::emulation {

/// The replies of emulated servos, with what may be wrong with it. Allocates when made only.
class ServoLine {
 public:
  ServoLine(const LineFaults& faults, std::uint64_t seed) : faults_(faults), random_(seed), outbox_(1 << 14) {}

  /// An answer that begins at this time, of a servo with this fault. What has no room is lost, as in an adapter.
  void answer(std::span<const std::uint8_t> packet, std::int64_t at_ns, ServoFault fault = ServoFault::none) noexcept {
    std::array<std::uint8_t, 512> bytes{};
    if (packet.empty() || packet.size() > bytes.size()) return;
    if (fault == ServoFault::clash) {
      // Two talk at once, one a little later: whoever pulls the line low is received, which are bits of 0.
      for (std::size_t i = 0; i < packet.size(); ++i) {
        const std::uint8_t later = i == 0 ? std::uint8_t{0xff} : packet[i - 1];
        bytes[i] = static_cast<std::uint8_t>(packet[i] & later);
      }
      outbox_.put({bytes.data(), packet.size()}, at_ns);
      return;
    }
    if (random_.uniform() < faults_.garbage) {
      const std::size_t size = 1 + random_.bits() % 12;
      // Half of them are what headers are made of.
      for (std::size_t i = 0; i < size; ++i) {
        bytes[i] = random_.bits() % 2 == 0 ? std::uint8_t{0xff} : static_cast<std::uint8_t>(random_.bits());
      }
      outbox_.put({bytes.data(), size}, at_ns);
    }
    std::copy(packet.begin(), packet.end(), bytes.begin());
    if (random_.uniform() < faults_.corrupt) {
      std::uint8_t& byte = bytes[random_.bits() % packet.size()];
      byte = static_cast<std::uint8_t>(byte ^ (1U << (random_.bits() % 8)));
    }
    std::size_t first = packet.size();
    if (random_.uniform() < faults_.split) first = 1 + random_.bits() % packet.size();
    outbox_.put({bytes.data(), first}, at_ns);
    if (first < packet.size()) outbox_.put({bytes.data() + first, packet.size() - first}, at_ns + pause_ns);
    if (fault == ServoFault::twin) outbox_.put(packet, at_ns + pause_ns);
  }
  void echo(std::span<const std::uint8_t> bytes, std::int64_t now_ns) noexcept {
    if (faults_.echo != 0) outbox_.put(bytes, now_ns);
  }

  std::span<const std::uint8_t> say(std::int64_t now_ns) noexcept { return outbox_.take(now_ns); }
  [[nodiscard]] std::int64_t wakes_ns() const noexcept { return outbox_.due_ns(); }

 private:
  static constexpr std::int64_t pause_ns = 300'000;

  LineFaults faults_;
  signal::Random random_;
  wire::Outbox outbox_;
};

}  // namespace tactus::emulation
