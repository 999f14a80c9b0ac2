#pragma once

#include <tactus/core/parameters.hpp>
#include <tactus/link/endpoint.hpp>

#include <algorithm>
#include <array>
#include <cstdint>

namespace tactus::link {

/// Why a site holds.
enum class HoldCause : std::uint8_t { none, not_armed, silent, other_session, peer_holds, unanswered, fault };
constexpr auto enumerators(HoldCause) {
  return std::array{Enumerator{HoldCause::none, "none"},
                    Enumerator{HoldCause::not_armed, "not-armed"},
                    Enumerator{HoldCause::silent, "silent"},
                    Enumerator{HoldCause::other_session, "other-session"},
                    Enumerator{HoldCause::peer_holds, "peer-holds"},
                    Enumerator{HoldCause::unanswered, "unanswered"},
                    Enumerator{HoldCause::fault, "fault"}};
}

/// Whether a site may follow the other: a latch on each site that only a person opens.
///
/// Each site starts in hold. A person arms the master; that counts up a number which every datagram carries, and the
/// slave becomes active when it sees the number rise. Either site falls back into hold when the other has been silent,
/// was restarted, holds itself, or a safety gate latched a fault here. Nothing but a new arming leads out, so a slave
/// that was cut off alone does not come back with an arming that is over. The slave repeats the number that it
/// followed: the master gives up an arming that goes unanswered.
///
/// Pure and trivially copyable. Real-time safe.
class Arming {
 public:
  struct Input {
    bool heard = false;
    double silence_s = 0.0;
    std::uint64_t session = 0;
    Standing peer = Standing::hold;
    std::uint32_t peer_armings = 0;
    bool arm = false;    ///< a person asks for it, at the master
    bool fault = false;  ///< of a safety gate here
  };

  /// `hold_after_s`: silence that ends in hold; an arming is given up when it is not answered within ten times that.
  Arming(SiteName site, double hold_after_s, double tick_s) noexcept
      : site_(site), hold_after_s_(hold_after_s), tick_s_(tick_s) {}

  /// One tick.
  Standing step(const Input& input) noexcept {
    if (input.heard && input.session != session_) {
      session_ = input.session;
      baseline_ = input.peer_armings;
      if (standing_ == Standing::active) hold(HoldCause::other_session, input);
    }
    const HoldCause cause = standing_ == Standing::active ? reason_to_hold(input) : HoldCause::none;
    if (cause != HoldCause::none) {
      hold(cause, input);
    } else if (standing_ == Standing::hold && may_follow(input) && asked(input)) {
      standing_ = Standing::active;
      cause_ = HoldCause::none;
      // A restarted master goes on from what it heard that the slave has followed. Should it not have heard yet, the
      // number comes again, under another session: to the slave that is another arming.
      armings_ = site_ == SiteName::master ? std::max(armings_, input.peer_armings) + 1 : input.peer_armings;
      unanswered_s_ = 0.0;
      answered_ = site_ == SiteName::slave;
    }
    return standing_;
  }

  [[nodiscard]] Standing standing() const noexcept { return standing_; }
  [[nodiscard]] HoldCause cause() const noexcept { return cause_; }
  /// What every datagram carries.
  [[nodiscard]] std::uint32_t armings() const noexcept { return armings_; }

 private:
  [[nodiscard]] bool may_follow(const Input& input) const noexcept {
    return input.heard && input.silence_s < hold_after_s_ && !input.fault;
  }
  [[nodiscard]] bool asked(const Input& input) const noexcept {
    if (site_ == SiteName::master) return input.arm;
    return input.peer == Standing::active && input.peer_armings != baseline_;
  }
  [[nodiscard]] HoldCause reason_to_hold(const Input& input) noexcept {
    if (input.fault) return HoldCause::fault;
    if (input.silence_s >= hold_after_s_) return HoldCause::silent;
    const bool same_arming = input.peer_armings == armings_;
    if (same_arming && input.peer == Standing::hold) return HoldCause::peer_holds;
    answered_ = answered_ || same_arming;
    if (answered_) return HoldCause::none;
    unanswered_s_ += tick_s_;
    return unanswered_s_ > 10.0 * hold_after_s_ ? HoldCause::unanswered : HoldCause::none;
  }
  void hold(HoldCause cause, const Input& input) noexcept {
    standing_ = Standing::hold;
    cause_ = cause;
    baseline_ = input.peer_armings;
  }

  SiteName site_;
  double hold_after_s_;
  double tick_s_;
  Standing standing_ = Standing::hold;
  HoldCause cause_ = HoldCause::not_armed;
  std::uint64_t session_ = 0;
  std::uint32_t armings_ = 0;
  std::uint32_t baseline_ = 0;  ///< the peer's number that is over, for the slave
  double unanswered_s_ = 0.0;
  bool answered_ = false;
};

}  // namespace tactus::link
