// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/packet.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/runtime/link/inbound.hpp>
#include <tactus/runtime/link/key.hpp>
#include <tactus/runtime/link/secure_channel.hpp>
#include <tactus/runtime/link/socket.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>

namespace tactus::link {

/// Of every end of the link, whatever the number of joints.
struct EndpointSettings {
  SiteRole site = SiteRole::master;
  Address peer;
  Address listen;
  /// The secret both sites share. None is plain text, which only a host's own loopback may carry.
  std::optional<Key> key;
};

/// What the link knows of the other site, apart from what it states.
struct LinkCondition {
  bool heard = false;           ///< a packet of it has come, ever
  double silence_s = 0.0;       ///< since the last arrived; 0 before the first
  double round_trip_s = 0.0;    ///< of the latest echo; 0 before the first
  double clock_offset_s = 0.0;  ///< the other's clock less the own, within half the shortest round trip of late
};

struct LinkCounters {
  Inbound::Counters inbound;
  SecureChannel::Counters secure;  ///< zeros in plain text
  std::uint64_t sent = 0;
  std::uint64_t unsent = 0;         ///< not taken by the kernel, or no keys yet
  std::uint64_t malformed = 0;      ///< plain text or authentic, but no datagram
  std::uint64_t keyed = 0;          ///< of these, frames of a site that has a key, which this one has not
  std::uint16_t other_version = 0;  ///< of the format that the other site speaks, where that is another one
  std::size_t other_joints = 0;     ///< that the other site has, where those are others than the own; 0 where not
  std::uint64_t expected = 0;       ///< of the other's session so far
  std::uint64_t arrived = 0;        ///< of those
};

/// One site's end of the link, for a servo step: each tick one `receive` and one `send`, neither of which waits,
/// allocates or locks. It turns datagrams into the packets that a supervised site judges, and back. Of one axis
/// (`Endpoint`) or of several joints (`JointEndpoint`); two ends with other numbers of joints never receive packets of
/// each other.
template <class Payload>
class EndpointOf {
 public:
  using Packet = control::PacketOf<Payload>;
  using Settings = EndpointSettings;
  using Condition = LinkCondition;
  using Counters = LinkCounters;

  /// Opens the socket and starts to shake hands. Errors: an address that cannot be used; `inconsistent` for plain text
  /// that would leave the loopback; `out_of_bounds` for a number of joints outside of 1 to `most_joints`. One axis
  /// has one.
  static Result<EndpointOf> make(const Settings& settings, std::size_t joints = 1);

  /// The packets that have come, in the order in which they came and each with its age, at `now_ns` of the monotonic
  /// clock. At most `packets_a_tick` datagrams are looked at. Good until the next call. Real-time safe.
  std::span<const Packet> receive(std::int64_t now_ns) noexcept;
  /// Sends one packet, whose session is `session()`, with as many joints as `make` was given. Real-time safe.
  void send(const Packet& packet, std::int64_t now_ns) noexcept;
  /// Real-time safe.
  [[nodiscard]] Condition condition(std::int64_t now_ns) const noexcept;

  [[nodiscard]] bool encrypted() const noexcept { return secure_.has_value(); }
  [[nodiscard]] bool established() const noexcept { return !secure_ || secure_->established(); }
  /// Drawn by `make`, never 0: for the site whose packets are sent.
  [[nodiscard]] std::int64_t session() const noexcept { return session_; }
  [[nodiscard]] const Socket& socket() const noexcept { return *socket_; }
  /// Real-time safe.
  [[nodiscard]] Counters counters() const noexcept;

  /// Bounds the time that a flood can take of a tick.
  static constexpr std::size_t packets_a_tick = 64;

 private:
  EndpointOf(const Settings& settings, std::unique_ptr<Socket> socket, std::int64_t session, const Payload& nothing)
      : socket_(std::move(socket)),
        site_(settings.site),
        session_(session),
        inbound_(settings.site, session),
        nothing_(nothing) {}

  std::unique_ptr<Socket> socket_;  ///< in one place, for the channel and its thread
  std::optional<SecureChannel> secure_;
  SiteRole site_;
  std::int64_t session_;
  Inbound inbound_;
  Payload nothing_;  ///< of as many joints as the packets have
  std::array<Packet, packets_a_tick> packets_{};
  std::uint64_t sent_ = 0;
  std::uint64_t unsent_ = 0;
  std::uint64_t malformed_ = 0;
  std::uint64_t keyed_ = 0;
  std::uint16_t other_version_ = 0;
  std::size_t other_joints_ = 0;
};
using Endpoint = EndpointOf<control::Message>;
using JointEndpoint = EndpointOf<Joints<control::Message>>;

}  // namespace tactus::link
