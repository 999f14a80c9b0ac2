// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/runtime/link/internal/dtls.hpp>
#include <tactus/runtime/link/internal/handshake_inbox.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace tactus::link {

/// Shakes hands for a channel, in a thread of its own.
///
/// The client draws a session and greets until the server answers with its own; only then does DTLS begin, in frames
/// that carry both. So what was recorded in another hand-shake answers the wrong session and goes no farther, and costs
/// the server a greeting at most: it keeps nothing before a frame has answered a session that it drew since the last
/// hand-shake, and then nothing displaces that hand-shake but its end.
class Handshaker {
 public:
  Handshaker(SiteRole own_site, const Key& key, const Socket& socket, FrameSender frames, HandshakeInbox& inbox)
      : server_(own_site == SiteRole::slave),
        socket_(&socket),
        inbox_(&inbox),
        frames_(std::move(frames)),
        dtls_(own_site, key) {}

  /// Errors: as those of `Dtls::start`. Before all else, once.
  Check start();

  /// Once in a while: takes what came, sends what is due and gives up what takes too long. `wanted` is whether a client
  /// shall begin. A connection with new keys, or null.
  std::unique_ptr<Connection> work(bool wanted, std::int64_t now_ns);
  /// Whether the server waits for a message as a proof that the client has its keys. Then `prove` may be given some.
  [[nodiscard]] bool wants_proof() const noexcept { return shaken_; }
  std::unique_ptr<Connection> prove(std::span<const std::byte> record);
  /// One greeting that answers nobody, by which who has another key or none can see that there is a site.
  void show_itself() { frames_.send(own_, 0); }
  /// Whether hands are being shaken.
  [[nodiscard]] bool busy() const noexcept { return server_ ? pending_ != nullptr : own_ != 0; }

 private:
  bool draw_session();
  void begin(std::int64_t now_ns);
  void take_beginning(const HandshakeLetter& letter, std::int64_t now_ns);
  void connect(std::uint64_t other);
  void advance(std::span<const std::byte> records);
  void give_up();
  std::unique_ptr<Connection> finished();

  bool server_;
  const Socket* socket_;
  HandshakeInbox* inbox_;
  FrameSender frames_;
  Dtls dtls_;
  std::unique_ptr<Connection> pending_;
  bool shaken_ = false;    ///< the pending one has its keys
  std::uint64_t own_ = 0;  ///< session; a server has one always, a client while it shakes hands
  std::int64_t begun_ns_ = 0;
  std::int64_t greeted_ns_ = 0;
  std::uint64_t newest_ = 0;  ///< number of a frame of the server in this hand-shake
};

}  // namespace tactus::link
