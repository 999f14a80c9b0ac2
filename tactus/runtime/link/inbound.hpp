// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/packet.hpp>
#include <tactus/runtime/link/datagram.hpp>
#include <tactus/runtime/link/peer_clock.hpp>
#include <tactus/runtime/link/replay_window.hpp>

#include <cstdint>

namespace tactus::link {

/// Whose datagrams come, and how old they are. What a packet is worth after that is for `control::PacketJudge`.
///
/// A session of the other site counts once it has answered the own session: its datagrams then carry the own session's
/// number, which was drawn at the own start, so nothing that was recorded before can be among them. A session that was
/// left is never taken up again, and of a session each datagram counts once.
///
/// Pure: no socket and no clock of its own. Real-time safe.
class Inbound {
 public:
  enum class Verdict : std::uint8_t {
    counted,    ///< the other site's, answering this one: a packet to be judged
    greeting,   ///< of a session that has not received the own one yet: to be answered, not to be used
    repeated,   ///< was here before
    reflected,  ///< of the own kind of site
    foreign,    ///< answers another session than the own one, or is of one that was left
  };

  struct Counters {
    std::uint64_t counted = 0, greeting = 0, repeated = 0, reflected = 0, foreign = 0;
    std::uint64_t sessions = 0;  ///< of the other site, that were taken up
  };

  /// `own_session` is not 0.
  Inbound(SiteRole own_site, std::int64_t own_session) : own_site_(own_site), own_session_(own_session) {}

  /// Where the verdict is `counted`, the datagram's packet is given its age: infinite as long as no echo has arrived.
  template <class Payload>
  Verdict take(DatagramOf<Payload>& datagram, std::int64_t now_ns) noexcept;

  /// When a datagram was counted last, own clock; 0 before the first.
  [[nodiscard]] std::int64_t received_ns() const noexcept { return received_ns_; }
  /// The session to answer: of the newest greeting, or the one that is taken up; 0 before either.
  [[nodiscard]] std::int64_t answered_session() const noexcept { return answered_session_; }
  /// When the datagram that is to be echoed was sent, other's clock, and arrived, own clock; 0 before the first.
  [[nodiscard]] std::int64_t echo_sent_ns() const noexcept { return echo_sent_ns_; }
  [[nodiscard]] std::int64_t echo_received_ns() const noexcept { return echo_received_ns_; }
  [[nodiscard]] const PeerClock& clock() const noexcept { return clock_; }
  [[nodiscard]] const Counters& counters() const noexcept { return counters_; }
  /// Datagrams of the session so far: how many were sent up to the newest since it was taken up, and how many of them
  /// came.
  [[nodiscard]] std::uint64_t expected() const noexcept {
    return arrived_ > 0 ? window_.newest() - first_sequence_ + 1 : 0;
  }
  [[nodiscard]] std::uint64_t arrived() const noexcept { return arrived_; }

 private:
  template <class Payload>
  Verdict judge(DatagramOf<Payload>& datagram, std::int64_t now_ns) noexcept;
  void take_up(std::int64_t session, std::int64_t sequence) noexcept;

  SiteRole own_site_;
  std::int64_t own_session_;
  control::Sessions sessions_;
  ReplayWindow window_;
  PeerClock clock_;
  std::int64_t received_ns_ = 0;
  std::int64_t answered_session_ = 0;
  std::int64_t echo_sent_ns_ = 0;
  std::int64_t echo_received_ns_ = 0;
  std::uint64_t first_sequence_ = 1;
  std::uint64_t arrived_ = 0;
  Counters counters_;
};

}  // namespace tactus::link
