#include <tactus/link/inbound.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

using namespace tactus::link;

namespace {

void demand(bool holds) {
  if (!holds) std::abort();
}

}  // namespace

/// The input is a row of datagrams, the last one of any size, each followed by the time at which it comes. None may do
/// harm, and what is applied is finite, newer than before and of the other site.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::uint64_t own_session = 0x0101010101010101;
  std::span<const std::byte> rest = std::as_bytes(std::span(data, size));
  Inbound inbound(SiteName::master, own_session, 0.5);
  std::int64_t now_ns = 1;
  while (!rest.empty()) {
    const auto bytes = rest.first(std::min(rest.size(), datagram_bytes));
    rest = rest.subspan(bytes.size());
    Datagram datagram;
    if (decode(bytes, datagram) != Refusal::none) {
      demand(datagram.session == 0);  // untouched
      continue;
    }
    if (!rest.empty()) {
      now_ns += std::int64_t{std::to_integer<std::int64_t>(rest.front())} << 24;
      rest = rest.subspan(1);
    }
    const auto before = inbound.newest();
    const auto verdict = inbound.take(datagram, now_ns);
    const auto& newest = inbound.newest();
    demand(inbound.clock().age_ns(newest.sent_ns, now_ns) >= 0);
    if (verdict == Inbound::Verdict::applied) {
      demand(newest.site == SiteName::slave && newest.peer_session == own_session);
      demand(newest.session != before.session || newest.sequence > before.sequence);
      demand(tactus::control::is_finite(newest.message));
    } else {
      demand(newest.session == before.session && newest.sequence == before.sequence);
    }
  }
  return 0;
}
