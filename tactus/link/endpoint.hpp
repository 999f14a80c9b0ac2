#pragma once

#include <tactus/control/site.hpp>
#include <tactus/core/result.hpp>
#include <tactus/link/inbound.hpp>
#include <tactus/link/key.hpp>
#include <tactus/link/secure_channel.hpp>
#include <tactus/link/socket.hpp>

#include <cstdint>
#include <memory>
#include <optional>

namespace tactus::link {

/// One site's end of the link, for a servo step: each tick one `receive` and one `send`, neither of which waits,
/// allocates or locks. All that comes is judged by `Inbound`; of all that came the newest counts.
class Endpoint {
 public:
  struct Settings {
    SiteName site = SiteName::master;
    Address peer;
    Address listen;
    /// The secret both sites share. None is plain text, which only a host's own loopback may carry.
    std::optional<Key> key;
    double longest_age_s = 0.5;  ///< older datagrams are not applied
  };

  /// The newest of the other site. `arrival.fresh` tells whether it came since the last call.
  struct Received {
    control::Arrival arrival;
    bool heard = false;          ///< anything at all, ever
    std::uint64_t session = 0;   ///< of the other site; a change is a restart
    std::uint64_t sequence = 0;  ///< of the message in its session
    Standing standing = Standing::hold;
    std::uint32_t armings = 0;
    double age_s = 0.0;           ///< since it was sent; within half the shortest round trip of late
    double silence_s = 0.0;       ///< since it arrived
    double round_trip_s = 0.0;    ///< of the latest echo
    double clock_offset_s = 0.0;  ///< the other's clock less the own
  };

  struct Counters {
    Inbound::Counters inbound;
    SecureChannel::Counters secure;  ///< zeros in plain text
    std::uint64_t sent = 0;
    std::uint64_t unsent = 0;     ///< not taken by the kernel, or no keys yet
    std::uint64_t malformed = 0;  ///< plain text or authentic, but no datagram
    std::uint64_t dropped = 0;    ///< by the kernel: no packet of the link by size and first bytes, or no room
    std::uint64_t expected = 0;   ///< of the other's session so far
    std::uint64_t arrived = 0;    ///< of those
  };

  /// Opens the socket and starts to shake hands. Errors: an address that cannot be used; `inconsistent` for plain text
  /// that would leave the loopback, `out_of_bounds` for an age that is not positive.
  static Result<Endpoint> make(const Settings& settings);

  /// Takes what has come, at most `packets_a_tick` packets, at `now_ns` of the monotonic clock. Real-time safe.
  Received receive(std::int64_t now_ns) noexcept;
  /// Sends one message. Real-time safe.
  void send(const control::Message& message, Standing standing, std::uint32_t armings, std::int64_t now_ns) noexcept;

  [[nodiscard]] bool encrypted() const noexcept { return secure_.has_value(); }
  [[nodiscard]] bool established() const noexcept { return !secure_ || secure_->established(); }
  [[nodiscard]] std::uint64_t session() const noexcept { return session_; }
  [[nodiscard]] const Socket& socket() const noexcept { return *socket_; }
  /// Real-time safe: one system call.
  [[nodiscard]] Counters counters() const noexcept;

  /// Bounds the time that a flood can take of a tick.
  static constexpr std::size_t packets_a_tick = 64;

 private:
  Endpoint(const Settings& settings, std::unique_ptr<Socket> socket, std::uint64_t session)
      : socket_(std::move(socket)),
        site_(settings.site),
        session_(session),
        inbound_(settings.site, session, settings.longest_age_s) {}

  std::unique_ptr<Socket> socket_;  ///< in one place, for the channel and its thread
  std::optional<SecureChannel> secure_;
  SiteName site_;
  std::uint64_t session_;
  std::uint64_t sequence_ = 0;
  Inbound inbound_;
  std::uint64_t sent_ = 0;
  std::uint64_t unsent_ = 0;
  std::uint64_t malformed_ = 0;
};

}  // namespace tactus::link
