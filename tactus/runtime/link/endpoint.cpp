// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/link/endpoint.hpp>
#include <tactus/runtime/link/handshake_frame.hpp>

#include <utility>

#include <sys/random.h>

namespace tactus::link {

template <class Payload>
Result<EndpointOf<Payload>> EndpointOf<Payload>::make(const Settings& settings, std::size_t joints) {
  constexpr double most = has_joints<Payload> ? most_joints : 1.0;
  if (const Bounds bounds = between(1.0, most); !bounds.contain(static_cast<double>(joints))) {
    return out_of_bounds("joints", static_cast<double>(joints), bounds, units::none);
  }
  Payload nothing{};
  if constexpr (has_joints<Payload>) nothing = Payload(joints);
  auto socket = Socket::open(settings.listen, settings.peer);
  if (!socket) return socket.error();
  if (!settings.key && !socket->on_loopback()) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = {},
                 .message =
                     "plain text may not leave this host's loopback: give both sites the same key, made by "
                     "`tactus key FILE`",
                 .place = settings.peer.text()};
  }
  std::int64_t session = 0;
  if (getrandom(&session, sizeof(session), 0) != static_cast<ssize_t>(sizeof(session)) || session == 0) {
    return Error{.code = ErrorCode::failed,
                 .parameter = {},
                 .message = "the operating system gave no random number for the session",
                 .place = {}};
  }
  EndpointOf endpoint(settings, std::make_unique<Socket>(*std::move(socket)), session, nothing);
  if (settings.key) {
    auto secure = SecureChannel::make(settings.site, *settings.key, *endpoint.socket_, joints);
    if (!secure) return secure.error();
    endpoint.secure_ = *std::move(secure);
  }
  return endpoint;
}

template <class Payload>
std::span<const control::PacketOf<Payload>> EndpointOf<Payload>::receive(std::int64_t now_ns) noexcept {
  std::size_t count = 0;
  std::array<std::byte, longest_datagram_bytes> opened;
  const std::size_t size = datagram_bytes_of(joints_of(nothing_));
  for (std::size_t taken = 0; taken < packets_a_tick;) {
    const auto packets = socket_->receive();
    for (const Received& packet : packets) {
      if (secure_ && !secure_->open(packet, opened)) continue;
      const auto bytes = secure_ ? std::span<const std::byte>(opened).first(size) : packet.bytes();
      DatagramOf<Payload> datagram;
      datagram.packet.message = nothing_;
      if (const Refusal refusal = decode(bytes, datagram); refusal != Refusal::none) {
        ++malformed_;
        if (refusal == Refusal::magic && !secure_ && is_a_frame(bytes)) ++keyed_;
        if (refusal == Refusal::version) other_version_ = version_of(bytes);
        if (refusal == Refusal::joints) other_joints_ = joints_in(bytes);
      } else if (inbound_.take(datagram, now_ns) == Inbound::Verdict::counted) {
        packets_[count++] = datagram.packet;
      }
    }
    taken += packets.size();
    if (packets.size() < Socket::packets_at_once) break;
  }
  return {packets_.data(), count};
}

template <class Payload>
void EndpointOf<Payload>::send(const Packet& packet, std::int64_t now_ns) noexcept {
  const bool echoes = inbound_.echo_received_ns() != 0;
  const auto encoded = encode(DatagramOf<Payload>{.site = site_,
                                                  .packet = packet,
                                                  .peer_session = inbound_.answered_session(),
                                                  .sent_ns = now_ns,
                                                  .echo_sent_ns = inbound_.echo_sent_ns(),
                                                  .echo_hold_ns = echoes ? now_ns - inbound_.echo_received_ns() : 0});
  const auto bytes = bytes_of(encoded);
  ++((secure_ ? secure_->send(bytes) : socket_->send(bytes)) ? sent_ : unsent_);
}

template <class Payload>
LinkCondition EndpointOf<Payload>::condition(std::int64_t now_ns) const noexcept {
  const auto seconds = [](std::int64_t ns) { return static_cast<double>(ns) * 1e-9; };
  const bool heard = inbound_.received_ns() != 0;
  return {.heard = heard,
          .silence_s = heard ? seconds(now_ns - inbound_.received_ns()) : 0.0,
          .round_trip_s = seconds(inbound_.clock().round_trip_ns()),
          .clock_offset_s = seconds(inbound_.clock().offset_ns())};
}

template <class Payload>
LinkCounters EndpointOf<Payload>::counters() const noexcept {
  const auto secure = secure_ ? secure_->counters() : SecureChannel::Counters{};
  return {.inbound = inbound_.counters(),
          .secure = secure,
          .sent = sent_,
          .unsent = unsent_,
          .malformed = malformed_,
          .keyed = keyed_,
          .other_version = other_version_ != 0 ? other_version_ : secure.other_version,
          .other_joints = other_joints_ != 0 ? other_joints_ : secure.other_joints,
          .expected = inbound_.expected(),
          .arrived = inbound_.arrived()};
}

template class EndpointOf<control::Message>;
template class EndpointOf<Joints<control::Message>>;

static_assert(Endpoint::packets_a_tick % Socket::packets_at_once == 0, "so that what is looked at fits");

}  // namespace tactus::link
