#pragma once

#include <tactus/link/datagram.hpp>

#include <bit>
#include <cstdint>

#include <rapidcheck.h>

namespace tactus::link::testing {

inline Datagram ordinary() {
  Datagram datagram;
  datagram.packet.session = 7;
  datagram.packet.sequence = 1;
  datagram.packet.message.position_m = 0.5;
  datagram.peer_session = 9;
  datagram.sent_ns = 1000;
  return datagram;
}

/// Any datagram that the format can carry.
inline rc::Gen<Datagram> any_datagram() {
  return rc::gen::exec([] {
    const auto bits = [] { return *rc::gen::resize(100, rc::gen::arbitrary<std::uint64_t>()); };
    const auto time = [&] { return static_cast<std::int64_t>(bits() >> 1); };
    const auto whole = [&] { return static_cast<std::int64_t>(bits()); };
    const auto number = [&] { return std::bit_cast<double>(bits()); };
    Datagram datagram;
    datagram.site = (bits() & 1) != 0 ? SiteRole::master : SiteRole::slave;
    datagram.packet.session = whole() | 1;
    datagram.packet.sequence = time() | 1;
    datagram.packet.state = static_cast<control::SiteState>(bits() % 6);
    datagram.packet.armings = whole();
    datagram.packet.message = {number(), number(), number(), number(), number()};
    datagram.packet.agreement = {.digest = bits(), .cell = bits(), .value = bits()};
    datagram.peer_session = whole();
    datagram.sent_ns = time();
    datagram.echo_sent_ns = time();
    datagram.echo_hold_ns = time();
    return datagram;
  });
}

/// Bit for bit.
inline bool alike(const Datagram& a, const Datagram& b) {
  const auto same = [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  };
  const control::Packet &p = a.packet, &q = b.packet;
  return a.site == b.site && p.state == q.state && p.armings == q.armings && p.session == q.session &&
         p.sequence == q.sequence && a.peer_session == b.peer_session && a.sent_ns == b.sent_ns &&
         a.echo_sent_ns == b.echo_sent_ns && a.echo_hold_ns == b.echo_hold_ns &&
         same(p.message.position_m, q.message.position_m) &&
         same(p.message.velocity_m_per_s, q.message.velocity_m_per_s) && same(p.message.force_N, q.message.force_N) &&
         same(p.message.wave, q.message.wave) && same(p.message.energy_J, q.message.energy_J) &&
         p.agreement.digest == q.agreement.digest && p.agreement.cell == q.agreement.cell &&
         p.agreement.value == q.agreement.value;
}

}  // namespace tactus::link::testing
