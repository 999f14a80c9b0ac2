// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/runtime/link/endpoint.hpp>

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace tactus::link::testing {

/// A port of the loopback that was free a moment ago, another one at each call. Each process has its own 32 below those
/// that the kernel gives away, so that tests which run side by side do not take one another's.
inline std::uint16_t free_port() {
  constexpr int first = 16000, of_a_process = 32, processes = 500;
  static int calls = 0;
  for (int tried = 0; tried < of_a_process; ++tried) {
    const int port = first + getpid() % processes * of_a_process + calls++ % of_a_process;
    const int descriptor = socket(AF_INET, SOCK_DGRAM, 0);
    sockaddr_in there{};
    there.sin_family = AF_INET;
    there.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    there.sin_port = htons(static_cast<std::uint16_t>(port));
    const bool free = bind(descriptor, reinterpret_cast<const sockaddr*>(&there), sizeof(there)) == 0;
    close(descriptor);
    if (free) return static_cast<std::uint16_t>(port);
  }
  throw std::runtime_error("no free port");
}

inline Address loopback(std::uint16_t port) { return Address::parse("127.0.0.1:" + std::to_string(port)).value(); }

inline Key test_key(unsigned char first = 1) {
  Key key;
  for (std::size_t i = 0; i < Key::bytes; ++i) key.secret[i] = static_cast<unsigned char>(first + i);
  return key;
}

/// Two ends of a link on the loopback, and the ports they use.
struct Ports {
  std::uint16_t master = free_port();
  std::uint16_t slave = free_port();
};

inline Endpoint open(SiteRole site, const Ports& ports, const std::optional<Key>& key) {
  const bool master = site == SiteRole::master;
  auto endpoint = Endpoint::make({.site = site,
                                  .peer = loopback(master ? ports.slave : ports.master),
                                  .listen = loopback(master ? ports.master : ports.slave),
                                  .key = key});
  if (!endpoint) throw std::runtime_error(describe(endpoint.error()));
  return *std::move(endpoint);
}

/// Sends the next packet of a site, which tells `position_m`.
inline void send(Endpoint& endpoint, double position_m, std::int64_t now_ns) {
  const auto counters = endpoint.counters();
  endpoint.send({.session = endpoint.session(),
                 .sequence = static_cast<std::int64_t>(counters.sent + counters.unsent) + 1,
                 .message = {.position_m = position_m}},
                now_ns);
}

/// One tick of a site that tells `position_m`; what came last, if anything.
inline std::optional<control::Packet> tick(Endpoint& endpoint, double position_m) {
  const std::int64_t now_ns = monotonic_ns();
  const auto packets = endpoint.receive(now_ns);
  const auto last = packets.empty() ? std::nullopt : std::optional(packets.back());
  send(endpoint, position_m, now_ns);
  return last;
}

/// Ticks both ends every 200 µs until `done` says so. False after `longest_s`.
inline bool tick_until(Endpoint& master, Endpoint& slave, const std::function<bool()>& done, double longest_s = 10.0) {
  const std::int64_t end_ns = monotonic_ns() + static_cast<std::int64_t>(longest_s * 1e9);
  while (monotonic_ns() < end_ns) {
    tick(master, 1.0);
    tick(slave, 2.0);
    if (done()) return true;
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  return false;
}

inline bool meet(Endpoint& master, Endpoint& slave) {
  return tick_until(master, slave,
                    [&] { return master.counters().inbound.counted > 3 && slave.counters().inbound.counted > 3; });
}

}  // namespace tactus::link::testing
