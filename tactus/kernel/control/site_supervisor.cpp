// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/site_supervisor.hpp>

#include <algorithm>

namespace tactus::control {

SiteCause SiteSupervisor::reason_to_hold(const Input& input) const noexcept {
  if (input.disagrees) return SiteCause::disagreement;
  if (input.energy) return SiteCause::energy;
  if (input.force_sensor) return SiteCause::force_sensor;
  if (input.stalled) return SiteCause::stalled;
  if (input.overloaded) return SiteCause::overloaded;
  if (input.device_silent) return SiteCause::device;
  if (input.out_of_pace) return SiteCause::pace;
  if (input.silent) return SiteCause::timed_out;
  if (input.probe != SiteCause::none) return input.probe;
  if (input.unanswered) return SiteCause::unanswered;
  const bool stands = input.peer != SiteState::armed && input.peer != SiteState::active;
  // What stands under another number has not heard yet of the arming of a master. A slave has its number from the
  // master, whose other one is newer.
  const bool counts = state_ == SiteState::active || role_ == SiteRole::slave || input.peer_armings == armings_;
  return stands && counts ? SiteCause::peer : SiteCause::none;
}

void SiteSupervisor::go(SiteState state, SiteCause cause, const Input& input) noexcept {
  state_ = state;
  cause_ = cause;
  over_ = input.peer_armings;
  pressed_ = false;
}

void SiteSupervisor::arm_where_asked(const Input& input, bool asked) noexcept {
  const bool master = role_ == SiteRole::master;
  // An energy latch is no obstacle: arming empties the account.
  const bool may = input.heard && !input.disagrees && !input.silent && !input.stalled && !input.overloaded &&
                   !input.device_silent && !input.too_heavy;
  if (!may || !(master ? asked : input.peer_armings != over_ && input.peer == SiteState::armed)) return;
  armings_ = master ? std::max(armings_, input.peer_armings) + 1 : input.peer_armings;
  state_ = SiteState::armed;
  pressed_ = false;
}

void SiteSupervisor::become_active_where_ready(const Input& input) noexcept {
  const bool ready = input.peer_armings == armings_ && input.proved;
  const bool master = role_ == SiteRole::master;
  if (master) {
    pressed_ = input.requests.dead_man && (pressed_ || !before_.dead_man);
    if (!pressed_ || !ready || (input.peer != SiteState::armed && input.peer != SiteState::active)) return;
  } else if (!ready || input.peer != SiteState::active) {
    return;
  }
  state_ = SiteState::active;
  cause_ = SiteCause::none;
}

SiteState SiteSupervisor::step(const Input& input) noexcept {
  const bool align = input.requests.align && !before_.align;
  const bool arm = input.requests.arm && !before_.arm;
  const bool clear = input.requests.clear && !before_.clear;
  const bool other_session = input.heard && input.session != session_;
  if (other_session) {
    session_ = input.session;
    over_ = input.peer_armings;
    // A master that starts anew counts anew.
    if (role_ == SiteRole::slave) armings_ = 0;
  }
  const bool emergency_stop = input.requests.emergency_stop;
  if ((input.fault || emergency_stop) && state_ != SiteState::fault) {
    go(SiteState::fault, emergency_stop ? SiteCause::emergency_stop : SiteCause::gate, input);
  } else if (input.requests.leave) {
    const bool works = state_ != SiteState::configure && state_ != SiteState::fault;
    if (works) go(SiteState::configure, SiteCause::dead_man, input);
  } else if (state_ == SiteState::configure) {
    if (align && !input.too_heavy) state_ = SiteState::align;
    if (align && input.too_heavy) {
      cause_ = SiteCause::weight;
    } else if (align && cause_ == SiteCause::weight) {
      cause_ = SiteCause::started;
    }
  } else if (input.support_moves && state_ != SiteState::fault) {
    go(SiteState::hold, SiteCause::support, input);
  } else if (state_ == SiteState::align || state_ == SiteState::hold) {
    arm_where_asked(input, arm);
    if (input.disagrees) {
      cause_ = SiteCause::disagreement;
    } else if (cause_ == SiteCause::disagreement) {
      cause_ = SiteCause::other_session;
    }
  } else if (state_ == SiteState::fault) {
    // The gate is re-armed on the way out; a cause that is still there closes it again.
    if (clear && !emergency_stop && !input.too_heavy) go(SiteState::align, cause_, input);
  } else if (const SiteCause cause = other_session ? SiteCause::other_session : reason_to_hold(input);
             cause != SiteCause::none) {
    go(SiteState::hold, cause, input);
  } else if (state_ == SiteState::armed) {
    // Armed anew, for a slave that was not ready the first time.
    arm_where_asked(input, arm);
    become_active_where_ready(input);
  } else if (role_ == SiteRole::master ? !input.requests.dead_man : input.peer == SiteState::armed) {
    state_ = SiteState::armed;
    cause_ = SiteCause::dead_man;
    pressed_ = false;
  }
  before_ = input.requests;
  return state_;
}

}  // namespace tactus::control
