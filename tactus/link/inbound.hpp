#pragma once

#include <tactus/link/datagram.hpp>
#include <tactus/link/peer_clock.hpp>
#include <tactus/link/replay_window.hpp>

#include <array>
#include <cstdint>

namespace tactus::link {

/// What becomes of the datagrams of the other site: which is the newest, whose session it is, how old.
///
/// A session of the other site counts once it has answered the own session: its datagrams then carry the own session's
/// number, which was drawn at the own start, so nothing that was recorded before can be among them. A session that was
/// left is never taken up again. Of a session the newest datagram wins, a late or repeated one changes nothing, and one
/// that is older than `longest_age_s` on its arrival is not applied at all.
///
/// Pure: no socket and no clock of its own. Real-time safe.
class Inbound {
 public:
  enum class Verdict : std::uint8_t {
    applied,    ///< the newest, to be used
    greeting,   ///< of a session that has not heard the own one yet: to be answered, not to be used
    late,       ///< an older one than one before
    repeated,   ///< was here before
    stale,      ///< the newest, but too old
    reflected,  ///< of the own kind of site
    foreign,    ///< answers another session than the own one, or is of one that was left
  };

  struct Counters {
    std::uint64_t applied = 0, greeting = 0, late = 0, repeated = 0, stale = 0, reflected = 0, foreign = 0;
    std::uint64_t sessions = 0;  ///< of the other site, that were taken up
  };

  /// `own_session` is not 0; `longest_age_s` is positive.
  Inbound(SiteName own_site, std::uint64_t own_session, double longest_age_s)
      : own_site_(own_site),
        own_session_(own_session),
        longest_age_ns_(static_cast<std::int64_t>(longest_age_s * 1e9)) {}

  Verdict take(const Datagram& datagram, std::int64_t now_ns) noexcept;

  /// The newest applied datagram; meaningless before the first.
  [[nodiscard]] const Datagram& newest() const noexcept { return newest_; }
  /// When the newest applied datagram arrived, own clock; 0 before the first.
  [[nodiscard]] std::int64_t heard_ns() const noexcept { return heard_ns_; }
  /// The session to answer: of the newest greeting, or the one that is taken up; 0 before either.
  [[nodiscard]] std::uint64_t answered_session() const noexcept { return answered_session_; }
  /// When the datagram that is to be echoed was sent, other's clock, and arrived, own clock; 0 before the first.
  [[nodiscard]] std::int64_t echo_sent_ns() const noexcept { return echo_sent_ns_; }
  [[nodiscard]] std::int64_t echo_heard_ns() const noexcept { return echo_heard_ns_; }
  [[nodiscard]] const PeerClock& clock() const noexcept { return clock_; }
  [[nodiscard]] const Counters& counters() const noexcept { return counters_; }
  /// Datagrams of the session so far: how many were sent up to the newest, and how many of them came.
  [[nodiscard]] std::uint64_t expected() const noexcept { return newest_sequence() - first_sequence_ + 1; }
  [[nodiscard]] std::uint64_t arrived() const noexcept { return arrived_; }

 private:
  static constexpr std::size_t remembered = 8;

  Verdict judge(const Datagram& datagram, std::int64_t now_ns) noexcept;
  [[nodiscard]] bool was_left(std::uint64_t session) const noexcept;
  void take_up(const Datagram& datagram) noexcept;
  [[nodiscard]] std::uint64_t newest_sequence() const noexcept { return window_.newest(); }

  SiteName own_site_;
  std::uint64_t own_session_;
  std::int64_t longest_age_ns_;
  std::uint64_t session_ = 0;
  std::array<std::uint64_t, remembered> left_{};
  std::size_t next_left_ = 0;
  ReplayWindow window_;
  PeerClock clock_;
  Datagram newest_;
  std::int64_t heard_ns_ = 0;
  std::uint64_t answered_session_ = 0;
  std::int64_t echo_sent_ns_ = 0;
  std::int64_t echo_heard_ns_ = 0;
  std::uint64_t first_sequence_ = 1;
  std::uint64_t arrived_ = 0;
  Counters counters_;
};

}  // namespace tactus::link
