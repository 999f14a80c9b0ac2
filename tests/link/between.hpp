// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/runtime/link/endpoint.hpp>

#include <chrono>
#include <cstdint>
#include <optional>
#include <thread>

#include <tests/link/hostile.hpp>
#include <tests/link/pair.hpp>

namespace tactus::link::testing {

/// Both sites on the loopback, encrypted, and an attacker on the way between them.
class Between {
 public:
  Between() {
    const std::uint16_t master_port = free_port(), slave_port = free_port();
    const std::uint16_t for_master = free_port(), for_slave = free_port();
    master_side_.emplace(Socket::open(loopback(for_master), loopback(master_port)).value());
    slave_side_.emplace(Socket::open(loopback(for_slave), loopback(slave_port)).value());
    master.emplace(open(SiteRole::master, {.master = master_port, .slave = for_master}, test_key()));
    slave.emplace(open(SiteRole::slave, {.master = for_slave, .slave = slave_port}, test_key()));
    const std::uint16_t elsewhere_port = free_port();
    elsewhere_.emplace(Socket::open(loopback(elsewhere_port), loopback(free_port())).value());
    to_elsewhere_.emplace(Socket::open(loopback(free_port()), loopback(elsewhere_port)).value());
  }

  /// Passes on what both sites have sent; the attacker hears it.
  void pass_on() {
    for (const Received& packet : master_side_->receive()) {
      attacker.hear(packet.bytes());
      slave_side_->send(packet.bytes());
      if (packet.data[0] == std::byte{23}) ++passed_to_slave;
    }
    for (const Received& packet : slave_side_->receive()) {
      attacker.hear(packet.bytes());
      master_side_->send(packet.bytes());
    }
  }
  /// One tick of both sites, and everything passed on.
  void tick_both() {
    tick(*master, 1.0);
    pass_on();
    if (const auto came = tick(*slave, 2.0)) last = *came;
    pass_on();
  }
  bool meet() {
    const std::int64_t end_ns = monotonic_ns() + 20'000'000'000;
    while (monotonic_ns() < end_ns && slave->counters().inbound.counted < 50) {
      tick_both();
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
    return slave->counters().inbound.counted >= 50;
  }
  void attack(int kind = -1) { slave_side_->send(attacker.next(kind)); }
  void send_to_slave(std::span<const std::byte> packet) { slave_side_->send(packet); }
  /// The same packets to a port that has nothing to do with the link.
  void attack_elsewhere() { to_elsewhere_->send(attacker.next()); }

  std::optional<Endpoint> master, slave;
  Attacker attacker{1};
  std::uint64_t passed_to_slave = 0;  ///< messages, not hand-shakes
  control::Packet last;               ///< that came to the slave

 private:
  std::optional<Socket> master_side_, slave_side_, elsewhere_, to_elsewhere_;
};

}  // namespace tactus::link::testing
