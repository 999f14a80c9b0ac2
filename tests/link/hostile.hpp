// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/signal/random.hpp>
#include <tactus/runtime/link/endpoint.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace tactus::link::testing {

/// Somebody on the way who has heard packets, has no key and sends what may hurt: recorded packets again, damaged,
/// truncated and lengthened, with another number or epoch, records of every type, plain datagrams, and noise.
class Attacker {
 public:
  static constexpr int kinds = 8;

  /// All memory is taken here, so that what grows later is not the attacker's.
  explicit Attacker(std::uint64_t seed) : random_(seed), heard_(4096, std::vector<std::byte>(256)) {
    packet_.reserve(2 * Received::longest);
  }

  void hear(std::span<const std::byte> packet) { heard_[next_++ % heard_.size()].assign(packet.begin(), packet.end()); }

  /// One hostile packet of the kind asked for; of any kind without a number.
  std::span<const std::byte> next(int kind = -1) {
    packet_ = heard_[below(std::clamp<std::size_t>(next_, 1, heard_.size()))];
    switch (kind < 0 ? static_cast<int>(below(kinds)) : kind) {
      case 0:
        break;  // again
      case 1:
        flip(13);
        break;  // damaged behind the head
      case 2:
        packet_.resize(below(packet_.size() + 1));
        break;  // truncated
      case 3:
        packet_.resize(packet_.size() + below(200) + 1);
        break;  // lengthened
      case 4:
        noise(3, std::min<std::size_t>(11, packet_.size()));
        break;  // another epoch and number
      case 5:   // a record of another type
        if (packet_.size() > 13) packet_[0] = static_cast<std::byte>(below(256));
        break;
      case 6: {  // a plain datagram that says it is the newest
        Datagram datagram;
        datagram.site = below(2) == 0 ? SiteRole::master : SiteRole::slave;
        datagram.packet.session = static_cast<std::int64_t>(random_.bits() | 1);
        datagram.packet.sequence = std::numeric_limits<std::int64_t>::max();
        datagram.sent_ns = monotonic_ns();
        datagram.packet.message.position_m = 1e3;
        const auto bytes = encode(datagram);
        packet_.assign(bytes.begin(), bytes.end());
        break;
      }
      default:  // noise, some of it with the head of a record
        packet_.resize(1 + below(Received::longest));
        noise(0, packet_.size());
        if (below(2) == 0 && packet_.size() > 13) {
          packet_[0] = static_cast<std::byte>(20 + below(5));
          packet_[1] = std::byte{0xfe};
          packet_[2] = std::byte{0xfd};
        }
    }
    return packet_;
  }

 private:
  std::size_t below(std::size_t bound) { return static_cast<std::size_t>(random_.bits() % bound); }
  void flip(std::size_t first) {
    if (packet_.size() <= first) return;
    packet_[first + below(packet_.size() - first)] ^= static_cast<std::byte>(1U << below(8));
  }
  void noise(std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) packet_[i] = static_cast<std::byte>(random_.bits());
  }

  signal::Random random_;
  std::vector<std::vector<std::byte>> heard_;
  std::size_t next_ = 0;
  std::vector<std::byte> packet_;
};

}  // namespace tactus::link::testing
