// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/packet.hpp>
#include <tactus/kernel/control/site_supervisor.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

/// Two sites over a network: what they send, how they know each other, and how old it is.
namespace tactus::link {

using control::SiteRole;

/// One packet on the network, with its sender and its age. Times are nanoseconds of the monotonic clock of
/// the host that wrote them and mean nothing to another host; `PeerClock` makes sense of them.
template <class Payload>
struct DatagramOf {
  SiteRole site = SiteRole::master;   ///< which sends
  control::PacketOf<Payload> packet;  ///< its age does not travel
  std::int64_t peer_session = 0;      ///< the session that the sender receives, 0 before it has received any
  std::int64_t sent_ns = 0;           ///< when this was sent, sender's clock
  std::int64_t echo_sent_ns = 0;      ///< `sent_ns` of the newest that the sender has received, 0 for none
  std::int64_t echo_hold_ns = 0;      ///< how long ago that arrived
};
using Datagram = DatagramOf<control::Message>;
using JointDatagram = DatagramOf<Joints<control::Message>>;

/// Why bytes are not a datagram.
enum class Refusal : std::uint8_t {
  none,
  magic,    ///< does not begin as a datagram of tactus
  version,  ///< of another version of the format, whatever its size
  joints,   ///< of another number of joints, whatever its size
  size,     ///< other than `datagram_bytes_of` its joints
  site,     ///< neither master nor slave
  state,    ///< a state that there is not
  session,  ///< session 0, or a sequence that is not positive
  time,     ///< a time before 0
};

/// Bytes of every datagram of so many joints: all of them have the same size.
constexpr std::size_t datagram_bytes_of(std::size_t joints) noexcept { return 88 + 40 * joints; }
inline constexpr std::size_t datagram_bytes = datagram_bytes_of(1);
inline constexpr std::size_t longest_datagram_bytes = datagram_bytes_of(most_joints);
/// The version of the format that this library speaks.
inline constexpr std::uint16_t datagram_version = 3;
/// "TCT", with which every datagram begins, and a place for the digit behind it, in the order of the bytes.
inline constexpr std::uint32_t datagram_magic = 0x00544354;
/// What stands for a site on the wire.
constexpr std::uint8_t site_byte(SiteRole site) noexcept { return site == SiteRole::master ? 1 : 2; }
using DatagramBytes = std::array<std::byte, datagram_bytes>;

/// The bytes of a datagram of several joints.
struct JointDatagramBytes {
  std::array<std::byte, longest_datagram_bytes> data;
  std::size_t size = 0;
  [[nodiscard]] std::span<const std::byte> bytes() const noexcept { return {data.data(), size}; }
};

/// The bytes of a datagram, little endian on every host: docs/reference/wire-format.md. One of one joint has the bytes
/// of one axis. It has 1 to `most_joints`. Real-time safe.
DatagramBytes encode(const Datagram& datagram) noexcept;
JointDatagramBytes encode(const JointDatagram& datagram) noexcept;
inline std::span<const std::byte> bytes_of(const DatagramBytes& bytes) noexcept { return bytes; }
inline std::span<const std::byte> bytes_of(const JointDatagramBytes& bytes) noexcept { return bytes.bytes(); }

/// What bytes from anywhere contain, of as many joints as the packet of `datagram` has. `datagram` is filled where the
/// result is `none` and untouched otherwise. Every input is answered: nothing else can happen. Whether the message
/// makes sense is for `control::PacketJudge`. Real-time safe.
template <class Payload>
Refusal decode(std::span<const std::byte> bytes, DatagramOf<Payload>& datagram) noexcept;

/// Whether bytes begin as a datagram in plain text, of any version and number of joints. Real-time safe.
bool looks_like_a_datagram(std::span<const std::byte> bytes) noexcept;
/// The version of the format that bytes are of which `decode` refused for it. Real-time safe.
std::uint16_t version_of(std::span<const std::byte> bytes) noexcept;
/// How many joints bytes are of which `decode` refused for that. Real-time safe.
std::size_t joints_in(std::span<const std::byte> bytes) noexcept;

}  // namespace tactus::link
