#pragma once

#include <tactus/link/datagram.hpp>

#include <bit>
#include <cmath>
#include <cstdint>

#include <rapidcheck.h>

namespace tactus::link::testing {

inline Datagram ordinary() {
  Datagram datagram;
  datagram.session = 7;
  datagram.peer_session = 9;
  datagram.sequence = 1;
  datagram.sent_ns = 1000;
  datagram.message.position_m = 0.5;
  return datagram;
}

/// Any datagram that the format can carry.
inline rc::Gen<Datagram> any_datagram() {
  return rc::gen::exec([] {
    const auto bits = [] { return *rc::gen::resize(100, rc::gen::arbitrary<std::uint64_t>()); };
    const auto time = [&] { return static_cast<std::int64_t>(bits() >> 1); };
    const auto number = [&] {
      const double value = std::bit_cast<double>(bits());
      return std::isfinite(value) ? value : -0.0;
    };
    Datagram datagram;
    datagram.site = (bits() & 1) != 0 ? SiteName::master : SiteName::slave;
    datagram.standing = (bits() & 1) != 0 ? Standing::active : Standing::hold;
    datagram.armings = static_cast<std::uint32_t>(bits());
    datagram.session = bits() | 1;
    datagram.peer_session = bits();
    datagram.sequence = bits() | 1;
    datagram.sent_ns = time();
    datagram.echo_sent_ns = time();
    datagram.echo_hold_ns = time();
    datagram.message = {number(), number(), number(), number(), number()};
    return datagram;
  });
}

/// Bit for bit.
inline bool alike(const Datagram& a, const Datagram& b) {
  const auto same = [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  };
  return a.site == b.site && a.standing == b.standing && a.armings == b.armings && a.session == b.session &&
         a.peer_session == b.peer_session && a.sequence == b.sequence && a.sent_ns == b.sent_ns &&
         a.echo_sent_ns == b.echo_sent_ns && a.echo_hold_ns == b.echo_hold_ns &&
         same(a.message.position_m, b.message.position_m) &&
         same(a.message.velocity_m_per_s, b.message.velocity_m_per_s) && same(a.message.force_N, b.message.force_N) &&
         same(a.message.wave, b.message.wave) && same(a.message.energy_J, b.message.energy_J);
}

}  // namespace tactus::link::testing
