// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/signal/random.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <thread>
#include <vector>

#include <tests/link/pair.hpp>

namespace tactus::link::testing {

/// Two sites that shake hands while somebody on the way, who sends from each one's peer's address and has no key, does
/// his worst.
class HandshakeAttack {
 public:
  enum class Kind : std::uint8_t { alert, junk_records, replayed, reflected, damaged, messages, noise, all };
  static constexpr std::array names{"alerts",
                                    "junk hand-shake records",
                                    "recorded, again",
                                    "recorded, sent back",
                                    "recorded, damaged",
                                    "forged messages",
                                    "noise",
                                    "all of them"};
  struct Plan {
    Kind kind = Kind::all;
    bool to_master = true;
    bool to_slave = true;
    double per_second = 10'000.0;  ///< toward each
  };

  explicit HandshakeAttack(std::uint64_t seed) : random_(seed) {}

  /// How long a hand-shake of two sites that are both started now takes, in seconds; none where it takes longer than
  /// `longest_s`. What is heard in it is sent again in later ones.
  std::optional<double> shake_hands(const Plan& plan, double longest_s) {
    const std::uint16_t master_port = free_port(), slave_port = free_port();
    const std::uint16_t for_master = free_port(), for_slave = free_port();
    Socket master_side = Socket::open(loopback(for_master), loopback(master_port)).value();
    Socket slave_side = Socket::open(loopback(for_slave), loopback(slave_port)).value();
    Endpoint master = open(SiteRole::master, {.master = master_port, .slave = for_master}, test_key());
    Endpoint slave = open(SiteRole::slave, {.master = for_slave, .slave = slave_port}, test_key());
    const std::int64_t began_ns = monotonic_ns();
    double sent = 0.0;
    while (true) {
      const double elapsed_s = 1e-9 * static_cast<double>(monotonic_ns() - began_ns);
      if (master.counters().inbound.counted > 3 && slave.counters().inbound.counted > 3) return elapsed_s;
      if (elapsed_s > longest_s) return std::nullopt;
      pass_on(master_side, slave_side, from_master_);
      pass_on(slave_side, master_side, from_slave_);
      // No more at once than a site takes in two ticks, for a machine that was busy.
      for (int burst = 0; sent < elapsed_s * plan.per_second && burst < 100; ++burst) {
        if (plan.to_slave) slave_side.send(next(plan.kind, from_master_, from_slave_));
        if (plan.to_master) master_side.send(next(plan.kind, from_slave_, from_master_));
        ++sent;
      }
      sent = std::max(sent, elapsed_s * plan.per_second - 1000.0);
      tick(master, 1.0);
      tick(slave, 2.0);
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
  }

 private:
  using Bytes = std::vector<std::byte>;
  /// The last ones of each site that are no messages.
  struct Recording {
    std::array<Bytes, 256> packets;
    std::size_t count = 0;
    void hear(std::span<const std::byte> packet) {
      packets[count++ % packets.size()].assign(packet.begin(), packet.end());
    }
  };

  static void pass_on(Socket& from, Socket& to, Recording& recording) {
    for (const Received& packet : from.receive()) {
      if (packet.data[0] != std::byte{23}) recording.hear(packet.bytes());
      to.send(packet.bytes());
    }
  }

  std::size_t below(std::size_t bound) { return static_cast<std::size_t>(random_.bits() % bound); }
  const Bytes& one_of(const Recording& recording) {
    static const Bytes nothing(1);
    if (recording.count == 0) return nothing;
    return recording.packets[below(std::min(recording.count, recording.packets.size()))];
  }
  /// A record of DTLS 1.2 with noise in it.
  void record(std::uint8_t type, std::uint16_t epoch, std::size_t content_bytes) {
    packet_.resize(13 + content_bytes);
    for (std::byte& byte : packet_) byte = static_cast<std::byte>(random_.bits());
    const std::array head{std::byte{type}, std::byte{0xfe}, std::byte{0xfd}, std::byte{0},
                          static_cast<std::byte>(epoch)};
    std::copy(head.begin(), head.end(), packet_.begin());
    packet_[11] = static_cast<std::byte>(content_bytes >> 8);
    packet_[12] = static_cast<std::byte>(content_bytes);
  }

  std::span<const std::byte> next(Kind kind, const Recording& toward, const Recording& away) {
    switch (kind) {
      case Kind::alert:
        record(21, 0, 2);
        std::fill(packet_.begin() + 3, packet_.begin() + 11, std::byte{0});
        packet_[10] = static_cast<std::byte>(below(256));
        packet_[13] = std::byte{2};  // fatal
        packet_[14] = std::byte{40};
        break;
      case Kind::junk_records:
        record(static_cast<std::uint8_t>(below(2) == 0 ? 22 : 20), 0, 1 + below(300));
        std::fill(packet_.begin() + 3, packet_.begin() + 10, std::byte{0});
        if (packet_.size() > 13) packet_[13] = static_cast<std::byte>(below(21));  // of a message that there is
        break;
      case Kind::replayed:
        packet_ = one_of(toward);
        break;
      case Kind::reflected:
        packet_ = one_of(away);
        break;
      case Kind::damaged:
        packet_ = one_of(toward);
        packet_[below(packet_.size())] ^= static_cast<std::byte>(1U << below(8));
        break;
      case Kind::messages:
        record(23, 1, datagram_bytes + 16);
        std::fill(packet_.begin() + 5, packet_.begin() + 7, std::byte{0});
        break;
      case Kind::noise:
        packet_.resize(1 + below(600));
        for (std::byte& byte : packet_) byte = static_cast<std::byte>(random_.bits());
        break;
      case Kind::all:
        return next(static_cast<Kind>(below(static_cast<std::size_t>(Kind::all))), toward, away);
    }
    return packet_;
  }

  signal::Random random_;
  Recording from_master_, from_slave_;
  Bytes packet_;
};

}  // namespace tactus::link::testing
