#include <tactus/link/inbound.hpp>

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

/// The input is a row of datagrams, the last one of any size, each followed by the time at which it comes. None may do
/// harm; what counts is of the other site and answers the own session, and what is then applied is finite and newer
/// than before.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::int64_t own_session = 0x0101010101010101;
  std::span<const std::byte> rest = std::as_bytes(std::span(data, size));
  Inbound inbound(SiteRole::master, own_session);
  auto judge = PacketJudge::make({}, tactus::Seconds{1e-3}).value();
  tactus::control::Packet newest;
  std::int64_t now_ns = 1;
  while (!rest.empty()) {
    const auto bytes = rest.first(std::min(rest.size(), datagram_bytes));
    rest = rest.subspan(bytes.size());
    Datagram datagram;
    if (decode(bytes, datagram) != Refusal::none) {
      demand(datagram.packet.session == 0);  // untouched
      continue;
    }
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
  return 0;
}
