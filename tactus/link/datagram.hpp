#pragma once

#include <tactus/control/packet.hpp>
#include <tactus/control/site_supervisor.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

/// Two sites over a network: what they send, how they know each other, and how old it is.
namespace tactus::link {

using control::SiteRole;

/// One packet on the network, with what tells whose it is and how old. Times are nanoseconds of the monotonic clock of
/// the host that wrote them and mean nothing to another host; `PeerClock` makes sense of them.
struct Datagram {
  SiteRole site = SiteRole::master;  ///< which sends
  control::Packet packet;            ///< its age does not travel
  std::int64_t peer_session = 0;     ///< the session that the sender hears, 0 before it has heard any
  std::int64_t sent_ns = 0;          ///< when this was sent, sender's clock
  std::int64_t echo_sent_ns = 0;     ///< `sent_ns` of the newest that the sender has heard, 0 for none
  std::int64_t echo_hold_ns = 0;     ///< how long ago that arrived
};

/// Why bytes are not a datagram.
enum class Refusal : std::uint8_t {
  none,
  magic,    ///< does not begin as a datagram of tactus
  version,  ///< of another version of the format, whatever its size
  size,     ///< other than `datagram_bytes`
  site,     ///< neither master nor slave
  state,    ///< a state that there is not
  session,  ///< session 0, or a sequence that is not positive
  time,     ///< a time before 0
};

/// Bytes of every datagram: all have the same size.
inline constexpr std::size_t datagram_bytes = 128;
/// The version of the format that this library speaks.
inline constexpr std::uint16_t datagram_version = 3;
/// What stands for a site on the wire.
constexpr std::uint8_t site_byte(SiteRole site) noexcept { return site == SiteRole::master ? 1 : 2; }
using DatagramBytes = std::array<std::byte, datagram_bytes>;

/// The bytes of a datagram, little endian on every host: docs/reference/wire-format.md. Real-time safe.
DatagramBytes encode(const Datagram& datagram) noexcept;

/// What bytes from anywhere say. `datagram` is filled where the result is `none` and untouched otherwise. Every input
/// is answered: nothing else can happen. Whether the message makes sense is for `control::PacketJudge`. Real-time safe.
Refusal decode(std::span<const std::byte> bytes, Datagram& datagram) noexcept;

/// The version of the format that bytes are of which `decode` refused for it. Real-time safe.
std::uint16_t version_of(std::span<const std::byte> bytes) noexcept;

}  // namespace tactus::link
