#include <tactus/link/endpoint.hpp>
#include <tactus/link/packet_filter.hpp>

#include <utility>

#include <sys/random.h>

namespace tactus::link {

Result<Endpoint> Endpoint::make(const Settings& settings) {
  if (!(settings.longest_age_s > 0.0 && settings.longest_age_s <= 60.0)) {
    return Error{.code = ErrorCode::out_of_bounds,
                 .parameter = "longest_age_s",
                 .message = "the longest age of a message must be more than 0 and at most 60 s",
                 .place = {}};
  }
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
  std::uint64_t session = 0;
  if (getrandom(&session, sizeof(session), 0) != static_cast<ssize_t>(sizeof(session)) || session == 0) {
    return Error{.code = ErrorCode::failed,
                 .parameter = {},
                 .message = "the operating system gave no random number for the session",
                 .place = {}};
  }
  Endpoint endpoint(settings, std::make_unique<Socket>(*std::move(socket)), session);
  if (settings.key) {
    const auto role = settings.site == SiteName::master ? HandshakeRole::client : HandshakeRole::server;
    auto secure = SecureChannel::make(role, *settings.key, *endpoint.socket_, datagram_bytes);
    if (!secure) return secure.error();
    endpoint.secure_ = *std::move(secure);
    // Without a filter more is judged here, that is all. Plain text stays on the loopback and needs none.
    static_cast<void>(admit_records(endpoint.socket_->descriptor(), datagram_bytes));
  }
  return endpoint;
}

Endpoint::Received Endpoint::receive(std::int64_t now_ns) noexcept {
  const std::uint64_t applied_before = inbound_.counters().applied;
  DatagramBytes opened;
  for (std::size_t taken = 0; taken < packets_a_tick;) {
    const auto packets = socket_->receive();
    if (packets.empty()) break;
    for (const Packet& packet : packets) {
      if (secure_ && !secure_->open(packet, opened)) continue;
      Datagram datagram;
      if (decode(secure_ ? std::span<const std::byte>(opened) : packet.bytes(), datagram) == Refusal::none) {
        inbound_.take(datagram, now_ns);
      } else {
        ++malformed_;
      }
    }
    taken += packets.size();
    if (packets.size() < Socket::packets_at_once) break;
  }

  const Datagram& newest = inbound_.newest();
  Received received{.arrival = {.message = newest.message, .fresh = inbound_.counters().applied > applied_before}};
  if (inbound_.counters().applied == 0) return received;
  const auto seconds = [](std::int64_t ns) { return static_cast<double>(ns) * 1e-9; };
  received.heard = true;
  received.session = newest.session;
  received.sequence = newest.sequence;
  received.standing = newest.standing;
  received.armings = newest.armings;
  received.age_s = seconds(inbound_.clock().age_ns(newest.sent_ns, now_ns));
  received.silence_s = seconds(now_ns - inbound_.heard_ns());
  received.round_trip_s = seconds(inbound_.clock().round_trip_ns());
  received.clock_offset_s = seconds(inbound_.clock().offset_ns());
  return received;
}

void Endpoint::send(const control::Message& message, Standing standing, std::uint32_t armings,
                    std::int64_t now_ns) noexcept {
  const bool echoes = inbound_.echo_heard_ns() != 0;
  const DatagramBytes bytes = encode({.site = site_,
                                      .standing = standing,
                                      .armings = armings,
                                      .session = session_,
                                      .peer_session = inbound_.answered_session(),
                                      .sequence = ++sequence_,
                                      .sent_ns = now_ns,
                                      .echo_sent_ns = inbound_.echo_sent_ns(),
                                      .echo_hold_ns = echoes ? now_ns - inbound_.echo_heard_ns() : 0,
                                      .message = message});
  ++((secure_ ? secure_->send(bytes) : socket_->send(bytes)) ? sent_ : unsent_);
}

Endpoint::Counters Endpoint::counters() const noexcept {
  return {.inbound = inbound_.counters(),
          .secure = secure_ ? secure_->counters() : SecureChannel::Counters{},
          .sent = sent_,
          .unsent = unsent_,
          .malformed = malformed_,
          .dropped = socket_->dropped(),
          .expected = inbound_.arrived() > 0 ? inbound_.expected() : 0,
          .arrived = inbound_.arrived()};
}

}  // namespace tactus::link
