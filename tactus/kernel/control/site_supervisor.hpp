// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/packet.hpp>
#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <array>
#include <cstdint>

namespace tactus::control {

/// Why a site does not follow: a different thing from its state, and from the limit that clips a force right now.
enum class SiteCause {
  none,
  started,
  dead_man,
  timed_out,
  stalled,
  other_session,
  peer,
  force_sensor,
  energy,
  gate,
  unanswered,
  overloaded,
  probe_reversed,
  probe_still,
  probe_astray,
  emergency_stop,
  disagreement,
  pace,
  device,
  support,
  weight
};
constexpr auto enumerators(SiteCause) {
  return std::array{Enumerator{SiteCause::none, "none"},
                    Enumerator{SiteCause::started, "started"},
                    Enumerator{SiteCause::dead_man, "dead-man"},
                    Enumerator{SiteCause::timed_out, "timed-out"},
                    Enumerator{SiteCause::stalled, "stalled"},
                    Enumerator{SiteCause::other_session, "other-session"},
                    Enumerator{SiteCause::peer, "peer"},
                    Enumerator{SiteCause::force_sensor, "force-sensor"},
                    Enumerator{SiteCause::energy, "energy"},
                    Enumerator{SiteCause::gate, "gate"},
                    Enumerator{SiteCause::unanswered, "unanswered"},
                    Enumerator{SiteCause::overloaded, "overloaded"},
                    Enumerator{SiteCause::probe_reversed, "probe-reversed"},
                    Enumerator{SiteCause::probe_still, "probe-still"},
                    Enumerator{SiteCause::probe_astray, "probe-astray"},
                    Enumerator{SiteCause::emergency_stop, "emergency-stop"},
                    Enumerator{SiteCause::disagreement, "disagreement"},
                    Enumerator{SiteCause::pace, "pace"},
                    Enumerator{SiteCause::device, "device"},
                    Enumerator{SiteCause::support, "support"},
                    Enumerator{SiteCause::weight, "weight"}};
}

enum class SiteRole { master, slave };
constexpr auto enumerators(SiteRole) {
  return std::array{Enumerator{SiteRole::master, "master"}, Enumerator{SiteRole::slave, "slave"}};
}

/// What an operator asks of a site. `align`, `arm` and `clear` count when they rise, so a button that is stuck arms
/// nothing. The dead-man switch must be pressed after arming and as long as the site shall follow.
struct SiteRequests {
  bool align = false;           ///< leave `configure`
  bool arm = false;             ///< leave `align` or `hold`; at the master, for both sites
  bool clear = false;           ///< leave `fault`, to `align`
  bool dead_man = false;        ///< pressed; at the master
  bool clutch = false;          ///< pressed: the hand moves and the slave does not; at the master
  bool emergency_stop = false;  ///< pressed: into `fault`, and no way out of it
  bool leave = false;           ///< pressed: the site is about to end, in `configure` and without force
  bool tare = false;            ///< pressed: a site that is armed and does not follow identifies its gravity, once
  double force_gain = -1.0;     ///< that is asked for, at the master; below 0: what was asked last
};

/// The state of one site, and why.
///
///     configure –align→ align –arm→ armed –sign probe, dead-man, and the other site armed→ active
///     active –dead-man released→ armed
///     armed, active –silence, stall, overload, device, other site, sensor, energy→ hold –arm→ armed
///     align, armed, active, hold –motion while its support comes in→ hold
///     armed –no answer, sign probe not passed→ hold
///     any –safety gate, emergency stop→ fault –clear→ align
///     any but fault –about to end→ configure
///
/// Arming is a number that the master counts up and every packet carries; a restarted master continues from the number
/// that it receives the slave has followed. The slave is armed when it sees the number rise, repeats it, and the master
/// becomes active only once the slave does. Either site falls into hold when the other holds under the same number, or
/// under any while this one is active, or was restarted; so one that was cut off alone does not come back with an
/// arming that is over, and nothing but a new one leads out. An arming that the slave does not answer is given up. A
/// site whose motor is tried on arming follows only after the sign probe.
/// While the other site works by other parameters, nothing is armed; it must be started again. Nor does a site leave
/// `configure`, `hold` or `fault` whose device is heavier, by its model, than its motors may carry.
class SiteSupervisor {
 public:
  struct Params {
    SiteRole role = SiteRole::master;
    static constexpr auto fields() { return List{field("role", &Params::role, "Which of the two sites this is.")}; }
  };
  struct Input {
    SiteRequests requests{};
    bool heard = false;        ///< the other site, ever
    std::int64_t session = 0;  ///< of the other site
    SiteState peer = SiteState::configure;
    std::int64_t peer_armings = 0;
    bool disagrees = false;             ///< the other site works by other parameters
    bool silent = false;                ///< the watchdog barks
    bool unanswered = false;            ///< the slave has not followed the arming for too long
    bool stalled = false;               ///< this site was not stepped for too long
    bool overloaded = false;            ///< this site was not stepped too often
    bool device_silent = false;         ///< what this site's device reads is too old
    bool out_of_pace = false;           ///< the other site's clock is not this one's
    bool force_sensor = false;          ///< the force sensor cannot be right
    SiteCause probe = SiteCause::none;  ///< why the sign probe was not passed
    bool proved = true;                 ///< the sign probe was passed, or nobody asks for one
    bool support_moves = false;         ///< a joint moved as no right support moves it
    bool too_heavy = false;             ///< the device is heavier than its motors may carry; it has no support yet
    bool energy = false;                ///< the passivity monitor has latched
    bool fault = false;                 ///< the safety gate has, for any other reason
  };
  using Output = SiteState;

  static Result<SiteSupervisor> make(const Params& params, Seconds dt) {
    if (auto error = signal::check(params, dt)) return *std::move(error);
    return SiteSupervisor(params.role);
  }

  /// One tick. Real-time safe.
  SiteState step(const Input& input) noexcept;
  /// As made: in `configure`.
  void reset() noexcept { *this = SiteSupervisor(role_); }

  [[nodiscard]] SiteState state() const noexcept { return state_; }
  [[nodiscard]] SiteCause cause() const noexcept { return cause_; }
  /// What every packet carries.
  [[nodiscard]] std::int64_t armings() const noexcept { return armings_; }

 private:
  explicit SiteSupervisor(SiteRole role) : role_(role) {}

  [[nodiscard]] SiteCause reason_to_hold(const Input& input) const noexcept;
  void go(SiteState state, SiteCause cause, const Input& input) noexcept;
  void arm_where_asked(const Input& input, bool asked) noexcept;
  void become_active_where_ready(const Input& input) noexcept;

  SiteRole role_;
  SiteState state_ = SiteState::configure;
  SiteCause cause_ = SiteCause::started;
  SiteRequests before_{.align = true,
                       .arm = true,
                       .clear = true,
                       .dead_man = true,
                       .clutch = true};  ///< what is pressed at the start does not count
  std::int64_t session_ = 0;
  std::int64_t armings_ = 0;
  std::int64_t over_ = 0;  ///< the peer's arming that a slave no longer follows
  bool pressed_ = false;   ///< the dead-man switch, since arming
};

}  // namespace tactus::control
