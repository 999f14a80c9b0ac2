#pragma once

#include <tactus/control/site.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

/// Two sites over a network: what they send, how they know each other, and when they stop trusting what came.
namespace tactus::link {

/// Which end of the link a program is.
enum class SiteName : std::uint8_t { master = 1, slave = 2 };

/// What a site tells the other about itself with every datagram. `hold` covers all in which it does not follow.
enum class Standing : std::uint8_t { hold = 0, active = 1 };

/// One message on the network with all that its receiver needs to judge it. Times are nanoseconds of the monotonic
/// clock of the host that wrote them and mean nothing to another host; `PeerClock` makes sense of them.
struct Datagram {
  SiteName site = SiteName::master;
  Standing standing = Standing::hold;
  std::uint32_t armings = 0;       ///< how often the master was armed; the slave repeats what it followed
  std::uint64_t session = 0;       ///< drawn at the start of the sending program, never 0
  std::uint64_t peer_session = 0;  ///< the session that the sender hears, 0 before it has heard any
  std::uint64_t sequence = 0;      ///< from 1, one more for each datagram of a session
  std::int64_t sent_ns = 0;        ///< when this was sent, sender's clock
  std::int64_t echo_sent_ns = 0;   ///< `sent_ns` of the newest that the sender has heard, 0 for none
  std::int64_t echo_hold_ns = 0;   ///< how long ago that arrived
  control::Message message;        ///< what the architecture says
};

/// Why bytes are not a datagram.
enum class Refusal : std::uint8_t {
  none,
  size,        ///< other than `datagram_bytes`
  magic,       ///< does not begin as a datagram of tactus
  version,     ///< of another version of the format
  site,        ///< neither master nor slave
  standing,    ///< a standing that there is not
  session,     ///< session or sequence 0
  time,        ///< a time before 0
  not_finite,  ///< a number of the message that is not finite
};

/// Bytes of every datagram: all have the same size.
inline constexpr std::size_t datagram_bytes = 104;
/// The version of the format that this library speaks.
inline constexpr std::uint16_t datagram_version = 1;
using DatagramBytes = std::array<std::byte, datagram_bytes>;

/// The bytes of a datagram, little endian on every host: docs/reference/wire-format.md. Real-time safe.
DatagramBytes encode(const Datagram& datagram) noexcept;

/// What bytes from anywhere say. `datagram` is filled where the result is `none` and untouched otherwise. Every input
/// is answered: nothing else can happen. Real-time safe.
Refusal decode(std::span<const std::byte> bytes, Datagram& datagram) noexcept;

}  // namespace tactus::link
