// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/link/inbound.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

using namespace tactus::link;
using tactus::control::PacketJudge;
using tactus::control::PacketVerdict;

namespace {

void demand(bool holds) {
  if (!holds) std::abort();
}

}  // namespace

namespace {

/// A row of datagrams of as many joints as `room` has, the last one of any size, each followed by the time at which it
/// comes.
template <class Payload, class Judge>
void take(std::span<const std::byte> rest, const DatagramOf<Payload>& room, Judge judge) {
  constexpr std::int64_t own_session = 0x0101010101010101;
  const std::size_t size = datagram_bytes_of(tactus::joints_of(room.packet.message));
  Inbound inbound(SiteRole::master, own_session);
  tactus::control::PacketOf<Payload> newest;
  std::int64_t now_ns = 1;
  while (!rest.empty()) {
    const auto bytes = rest.first(std::min(rest.size(), size));
    rest = rest.subspan(bytes.size());
    DatagramOf<Payload> datagram = room;
    if (decode(bytes, datagram) != Refusal::none) {
      demand(datagram.packet.session == 0);  // untouched
      continue;
    }
    demand(bytes.size() == size);
    demand(tactus::joints_of(datagram.packet.message) == tactus::joints_of(room.packet.message));
    if (!rest.empty()) {
      now_ns += std::int64_t{std::to_integer<std::int64_t>(rest.front())} << 24;
      rest = rest.subspan(1);
    }
    if (inbound.take(datagram, now_ns) != Inbound::Verdict::counted) continue;
    const auto& packet = datagram.packet;
    demand(datagram.site == SiteRole::slave && datagram.peer_session == own_session);
    demand(packet.age_s >= 0.0);
    if (judge.step(packet) != PacketVerdict::applied) continue;
    demand(tactus::control::is_finite(packet.message));
    demand(packet.armings >= 0);
    demand(packet.session != newest.session || packet.sequence > newest.sequence);
    newest = packet;
  }
}

}  // namespace

/// The input is a row of datagrams for a site of one axis, and the same bytes are one for sites of several joints: what
/// is a datagram for one of them is none for the others, by its size. None may do harm; what counts is of the other
/// site and answers the own session, and what is then applied is finite and newer than before.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = std::as_bytes(std::span(data, size));
  constexpr tactus::Seconds tick{1e-3};
  take(bytes, Datagram{}, PacketJudge::make({}, tick).value());
  for (const std::size_t joints : {std::size_t{2}, tactus::most_joints}) {
    JointDatagram room;
    room.packet.message = tactus::Joints<tactus::control::Message>(joints);
    const tactus::Joints<tactus::control::PacketJudgeParams> params(joints);
    take(bytes, room,
         tactus::control::PacketJudgeOf<tactus::Joints<tactus::control::Message>>::make(params, tick).value());
  }
  return 0;
}
