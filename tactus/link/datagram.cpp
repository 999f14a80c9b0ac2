#include <tactus/link/datagram.hpp>

#include <bit>

namespace tactus::link {

namespace {

constexpr std::uint32_t magic = 0x31544354;  // "TCT1" in the order of the bytes
/// Of magic and version, which stand at the same place in every version.
constexpr std::size_t head_bytes = 6;
constexpr std::uint8_t master_byte = 1, slave_byte = 2;

/// Writes numbers one after the other, lowest byte first.
class Writer {
 public:
  explicit Writer(DatagramBytes& bytes) : at_(bytes.data()) {}
  template <class Unsigned>
  void put(Unsigned value) noexcept {
    for (std::size_t i = 0; i < sizeof(value); ++i) *at_++ = static_cast<std::byte>(value >> (8 * i));
  }
  void put_signed(std::int64_t value) noexcept { put(static_cast<std::uint64_t>(value)); }
  void put_double(double value) noexcept { put(std::bit_cast<std::uint64_t>(value)); }

 private:
  std::byte* at_;
};

/// Reads them back. Where there are so many bytes was checked before.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : at_(bytes.data()) {}
  template <class Unsigned>
  Unsigned get() noexcept {
    Unsigned value = 0;
    for (std::size_t i = 0; i < sizeof(value); ++i) {
      value = static_cast<Unsigned>(value | static_cast<Unsigned>(std::to_integer<Unsigned>(*at_++) << (8 * i)));
    }
    return value;
  }
  std::int64_t get_signed() noexcept { return static_cast<std::int64_t>(get<std::uint64_t>()); }
  double get_double() noexcept { return std::bit_cast<double>(get<std::uint64_t>()); }

 private:
  const std::byte* at_;
};

}  // namespace

DatagramBytes encode(const Datagram& datagram) noexcept {
  const control::Packet& packet = datagram.packet;
  DatagramBytes bytes;
  Writer out(bytes);
  out.put(magic);
  out.put(datagram_version);
  out.put(datagram.site == SiteRole::master ? master_byte : slave_byte);
  out.put(static_cast<std::uint8_t>(packet.state));
  out.put_signed(packet.armings);
  out.put_signed(packet.session);
  out.put_signed(datagram.peer_session);
  out.put_signed(packet.sequence);
  out.put_signed(datagram.sent_ns);
  out.put_signed(datagram.echo_sent_ns);
  out.put_signed(datagram.echo_hold_ns);
  out.put_double(packet.message.position_m);
  out.put_double(packet.message.velocity_m_per_s);
  out.put_double(packet.message.force_N);
  out.put_double(packet.message.wave);
  out.put_double(packet.message.energy_J);
  out.put(packet.agreement.digest);
  out.put(packet.agreement.cell);
  out.put(packet.agreement.value);
  return bytes;
}

Refusal decode(std::span<const std::byte> bytes, Datagram& datagram) noexcept {
  if (bytes.size() < head_bytes) return Refusal::size;
  Reader in(bytes);
  if (in.get<std::uint32_t>() != magic) return Refusal::magic;
  if (in.get<std::uint16_t>() != datagram_version) return Refusal::version;
  if (bytes.size() != datagram_bytes) return Refusal::size;
  const auto site = in.get<std::uint8_t>();
  if (site != master_byte && site != slave_byte) return Refusal::site;
  const auto state = in.get<std::uint8_t>();
  if (state > static_cast<std::uint8_t>(control::SiteState::fault)) return Refusal::state;
  Datagram read;
  control::Packet& packet = read.packet;
  read.site = site == master_byte ? SiteRole::master : SiteRole::slave;
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
  packet.message.position_m = in.get_double();
  packet.message.velocity_m_per_s = in.get_double();
  packet.message.force_N = in.get_double();
  packet.message.wave = in.get_double();
  packet.message.energy_J = in.get_double();
  packet.agreement.digest = in.get<std::uint64_t>();
  packet.agreement.cell = in.get<std::uint64_t>();
  packet.agreement.value = in.get<std::uint64_t>();
  datagram = read;
  return Refusal::none;
}

std::uint16_t version_of(std::span<const std::byte> bytes) noexcept {
  return Reader(bytes.subspan(sizeof(magic))).get<std::uint16_t>();
}

}  // namespace tactus::link
