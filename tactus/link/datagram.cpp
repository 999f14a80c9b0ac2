#include <tactus/link/datagram.hpp>

#include <bit>

namespace tactus::link {

namespace {

constexpr std::uint32_t magic = 0x31544354;  // "TCT1" in the order of the bytes

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

/// Reads them back. The size was checked before.
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
  DatagramBytes bytes;
  Writer out(bytes);
  out.put(magic);
  out.put(datagram_version);
  out.put(static_cast<std::uint8_t>(datagram.site));
  out.put(static_cast<std::uint8_t>(datagram.standing));
  out.put(datagram.armings);
  out.put(std::uint32_t{0});
  out.put(datagram.session);
  out.put(datagram.peer_session);
  out.put(datagram.sequence);
  out.put_signed(datagram.sent_ns);
  out.put_signed(datagram.echo_sent_ns);
  out.put_signed(datagram.echo_hold_ns);
  out.put_double(datagram.message.position_m);
  out.put_double(datagram.message.velocity_m_per_s);
  out.put_double(datagram.message.force_N);
  out.put_double(datagram.message.wave);
  out.put_double(datagram.message.energy_J);
  return bytes;
}

Refusal decode(std::span<const std::byte> bytes, Datagram& datagram) noexcept {
  if (bytes.size() != datagram_bytes) return Refusal::size;
  Reader in(bytes);
  if (in.get<std::uint32_t>() != magic) return Refusal::magic;
  if (in.get<std::uint16_t>() != datagram_version) return Refusal::version;
  const auto site = in.get<std::uint8_t>();
  if (site != static_cast<std::uint8_t>(SiteName::master) && site != static_cast<std::uint8_t>(SiteName::slave)) {
    return Refusal::site;
  }
  const auto standing = in.get<std::uint8_t>();
  if (standing > static_cast<std::uint8_t>(Standing::active)) return Refusal::standing;
  Datagram read;
  read.site = static_cast<SiteName>(site);
  read.standing = static_cast<Standing>(standing);
  read.armings = in.get<std::uint32_t>();
  in.get<std::uint32_t>();  // reserved
  read.session = in.get<std::uint64_t>();
  read.peer_session = in.get<std::uint64_t>();
  read.sequence = in.get<std::uint64_t>();
  if (read.session == 0 || read.sequence == 0) return Refusal::session;
  read.sent_ns = in.get_signed();
  read.echo_sent_ns = in.get_signed();
  read.echo_hold_ns = in.get_signed();
  if (read.sent_ns < 0 || read.echo_sent_ns < 0 || read.echo_hold_ns < 0) return Refusal::time;
  read.message.position_m = in.get_double();
  read.message.velocity_m_per_s = in.get_double();
  read.message.force_N = in.get_double();
  read.message.wave = in.get_double();
  read.message.energy_J = in.get_double();
  if (!control::is_finite(read.message)) return Refusal::not_finite;
  datagram = read;
  return Refusal::none;
}

}  // namespace tactus::link
