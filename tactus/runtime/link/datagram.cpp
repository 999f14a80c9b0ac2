// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/link/datagram.hpp>
#include <tactus/runtime/link/internal/bytes.hpp>

namespace tactus::link {

namespace {

/// "TCT1" in the order of the bytes, and so on to "TCT8": the last one is the number of joints.
constexpr std::uint32_t magic = datagram_magic;
constexpr int joints_at_bit = 24;
/// Of magic and version, which stand at the same place in every version.
constexpr std::size_t head_bytes = 6;

constexpr std::uint32_t magic_of(std::size_t joints) noexcept {
  return magic | static_cast<std::uint32_t>('0' + joints) << joints_at_bit;
}
static_assert(magic_of(1) == 0x31544354);

template <class Payload>
void lay_out(const DatagramOf<Payload>& datagram, std::byte* to) noexcept {
  const control::PacketOf<Payload>& packet = datagram.packet;
  Writer out(to);
  out.put(magic_of(joints_of(packet.message)));
  out.put(datagram_version);
  out.put(site_byte(datagram.site));
  out.put(static_cast<std::uint8_t>(packet.state));
  out.put_signed(packet.armings);
  out.put_signed(packet.session);
  out.put_signed(datagram.peer_session);
  out.put_signed(packet.sequence);
  out.put_signed(datagram.sent_ns);
  out.put_signed(datagram.echo_sent_ns);
  out.put_signed(datagram.echo_hold_ns);
  for_each_joint(
      [&out](const control::Message& message) noexcept {
        for_each_signal<control::Message>([&](const auto& each) { out.put_double(message.*each.member); });
      },
      packet.message);
  out.put(packet.agreement.digest);
  out.put(packet.agreement.cell);
  out.put(packet.agreement.value);
}

}  // namespace

DatagramBytes encode(const Datagram& datagram) noexcept {
  DatagramBytes bytes;
  lay_out(datagram, bytes.data());
  return bytes;
}

JointDatagramBytes encode(const JointDatagram& datagram) noexcept {
  JointDatagramBytes bytes;
  lay_out(datagram, bytes.data.data());
  bytes.size = datagram_bytes_of(datagram.packet.message.size());
  return bytes;
}

template <class Payload>
Refusal decode(std::span<const std::byte> bytes, DatagramOf<Payload>& datagram) noexcept {
  if (bytes.size() < head_bytes) return Refusal::size;
  Reader in(bytes.data());
  const auto begin = in.get<std::uint32_t>();
  const std::size_t joints = joints_in(bytes);
  if (joints < 1 || joints > most_joints || begin != magic_of(joints)) return Refusal::magic;
  if (in.get<std::uint16_t>() != datagram_version) return Refusal::version;
  if (joints != joints_of(datagram.packet.message)) return Refusal::joints;
  if (bytes.size() != datagram_bytes_of(joints)) return Refusal::size;
  const auto site = in.get<std::uint8_t>();
  if (site != site_byte(SiteRole::master) && site != site_byte(SiteRole::slave)) return Refusal::site;
  const auto state = in.get<std::uint8_t>();
  if (state > static_cast<std::uint8_t>(control::SiteState::fault)) return Refusal::state;
  DatagramOf<Payload> read;
  control::PacketOf<Payload>& packet = read.packet;
  read.site = site == site_byte(SiteRole::master) ? SiteRole::master : SiteRole::slave;
  packet.state = static_cast<control::SiteState>(state);
  packet.armings = in.get_signed();
  packet.session = in.get_signed();
  read.peer_session = in.get_signed();
  packet.sequence = in.get_signed();
  if (packet.session == 0 || packet.sequence <= 0) return Refusal::session;
  read.sent_ns = in.get_signed();
  read.echo_sent_ns = in.get_signed();
  read.echo_hold_ns = in.get_signed();
  if (read.sent_ns < 0 || read.echo_sent_ns < 0 || read.echo_hold_ns < 0) return Refusal::time;
  packet.message = same_for_each(datagram.packet.message, control::Message{});
  for_each_joint(
      [&in](control::Message& message) noexcept {
        for_each_signal<control::Message>([&](const auto& each) { message.*each.member = in.get_double(); });
      },
      packet.message);
  packet.agreement.digest = in.get<std::uint64_t>();
  packet.agreement.cell = in.get<std::uint64_t>();
  packet.agreement.value = in.get<std::uint64_t>();
  datagram = read;
  return Refusal::none;
}
template Refusal decode(std::span<const std::byte>, Datagram&) noexcept;
template Refusal decode(std::span<const std::byte>, JointDatagram&) noexcept;

bool looks_like_a_datagram(std::span<const std::byte> bytes) noexcept {
  if (bytes.size() < head_bytes) return false;
  const std::size_t joints = joints_in(bytes);
  return joints >= 1 && joints <= most_joints && Reader(bytes.data()).get<std::uint32_t>() == magic_of(joints);
}

std::uint16_t version_of(std::span<const std::byte> bytes) noexcept {
  return Reader(bytes.data() + sizeof(magic)).get<std::uint16_t>();
}

std::size_t joints_in(std::span<const std::byte> bytes) noexcept {
  constexpr std::size_t digit_at = 3;
  return std::to_integer<std::size_t>(bytes[digit_at]) - '0';
}

}  // namespace tactus::link
