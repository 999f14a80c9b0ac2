#include <tactus/link/datagram.hpp>
#include <tactus/link/internal/bytes.hpp>

namespace tactus::link {

namespace {

constexpr std::uint32_t magic = 0x31544354;  // "TCT1" in the order of the bytes
/// Of magic and version, which stand at the same place in every version.
constexpr std::size_t head_bytes = 6;

}  // namespace

DatagramBytes encode(const Datagram& datagram) noexcept {
  const control::Packet& packet = datagram.packet;
  DatagramBytes bytes;
  Writer out(bytes.data());
  out.put(magic);
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
  for_each_signal<control::Message>([&](const auto& each) { out.put_double(packet.message.*each.member); });
  out.put(packet.agreement.digest);
  out.put(packet.agreement.cell);
  out.put(packet.agreement.value);
  return bytes;
}

Refusal decode(std::span<const std::byte> bytes, Datagram& datagram) noexcept {
  if (bytes.size() < head_bytes) return Refusal::size;
  Reader in(bytes.data());
  if (in.get<std::uint32_t>() != magic) return Refusal::magic;
  if (in.get<std::uint16_t>() != datagram_version) return Refusal::version;
  if (bytes.size() != datagram_bytes) return Refusal::size;
  const auto site = in.get<std::uint8_t>();
  if (site != site_byte(SiteRole::master) && site != site_byte(SiteRole::slave)) return Refusal::site;
  const auto state = in.get<std::uint8_t>();
  if (state > static_cast<std::uint8_t>(control::SiteState::fault)) return Refusal::state;
  Datagram read;
  control::Packet& packet = read.packet;
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
  for_each_signal<control::Message>([&](const auto& each) { packet.message.*each.member = in.get_double(); });
  packet.agreement.digest = in.get<std::uint64_t>();
  packet.agreement.cell = in.get<std::uint64_t>();
  packet.agreement.value = in.get<std::uint64_t>();
  datagram = read;
  return Refusal::none;
}

std::uint16_t version_of(std::span<const std::byte> bytes) noexcept {
  return Reader(bytes.data() + sizeof(magic)).get<std::uint16_t>();
}

}  // namespace tactus::link
