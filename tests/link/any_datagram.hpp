// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/runtime/link/datagram.hpp>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

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

/// The same of so many joints.
inline rc::Gen<JointDatagram> any_joint_datagram(std::size_t joints) {
  return rc::gen::map(rc::gen::container<std::vector<Datagram>>(joints, any_datagram()),
                      [](const std::vector<Datagram>& each) {
                        const Datagram& first = each.front();
                        JointDatagram datagram{.site = first.site,
                                               .packet = {.session = first.packet.session,
                                                          .sequence = first.packet.sequence,
                                                          .state = first.packet.state,
                                                          .armings = first.packet.armings,
                                                          .message = Joints<control::Message>(each.size()),
                                                          .agreement = first.packet.agreement},
                                               .peer_session = first.peer_session,
                                               .sent_ns = first.sent_ns,
                                               .echo_sent_ns = first.echo_sent_ns,
                                               .echo_hold_ns = first.echo_hold_ns};
                        for (std::size_t i = 0; i < each.size(); ++i)
                          datagram.packet.message[i] = each[i].packet.message;
                        return datagram;
                      });
}
/// Room for one of so many joints.
inline JointDatagram room_for(std::size_t joints) {
  JointDatagram datagram;
  datagram.packet.message = Joints<control::Message>(joints);
  return datagram;
}

/// One joint of a datagram, as that of one axis.
inline Datagram joint_of(const JointDatagram& all, std::size_t joint) {
  const control::JointPacket& packet = all.packet;
  return {.site = all.site,
          .packet = {.session = packet.session,
                     .sequence = packet.sequence,
                     .state = packet.state,
                     .armings = packet.armings,
                     .message = packet.message[joint],
                     .agreement = packet.agreement},
          .peer_session = all.peer_session,
          .sent_ns = all.sent_ns,
          .echo_sent_ns = all.echo_sent_ns,
          .echo_hold_ns = all.echo_hold_ns};
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
