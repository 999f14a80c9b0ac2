#include <tactus/control/supervision.hpp>

#include <algorithm>

namespace tactus::control {

namespace {

SiteCause cause_of(ProbeVerdict verdict) {
  switch (verdict) {
    case ProbeVerdict::reversed:
      return SiteCause::probe_reversed;
    case ProbeVerdict::still:
      return SiteCause::probe_still;
    case ProbeVerdict::astray:
      return SiteCause::probe_astray;
    case ProbeVerdict::none:
    case ProbeVerdict::passed:
      break;
  }
  return SiteCause::none;
}

}  // namespace

Result<Supervision> Supervision::make(const SupervisionParams& params, SiteRole role, std::int64_t session, Seconds dt,
                                      const Agreement& agreement) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  if (session == 0) {
    return Error{.code = ErrorCode::out_of_bounds,
                 .parameter = "session",
                 .message = "0 stands for no session: draw another number",
                 .place = {}};
  }
  const auto judge = PacketJudge::make(params.packets, dt);
  if (!judge) return under("packets", judge.error());
  const auto follower = MessageFollower::make(params.silence, dt);
  if (!follower) return under("silence", follower.error());
  const auto watchdog = Watchdog::make(params.watchdog, dt);
  if (!watchdog) return under("watchdog", watchdog.error());
  const auto answer = Watchdog::make({.timeout_s = params.answer_within_s}, dt);
  if (!answer) return answer.error();
  const auto overload = OverloadCheck::make(params.overload, dt);
  if (!overload) return under("overload", overload.error());
  const auto pace = PaceCheck::make(
      {.slack_s = params.packets.longest_age_s + params.watchdog.timeout_s, .tolerance_share = params.pace_share}, dt);
  if (!pace) return pace.error();
  const auto probe = SignProbe::make(params.probe, dt);
  if (!probe) return under("probe", probe.error());
  const double tried_after_s = params.blend_s + params.probe.duration_s;
  if (params.probe.force_N > 0.0 && params.answer_within_s <= tried_after_s) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "answer_within_s",
                 .message = format_number(params.answer_within_s) +
                            " s must be more than blend_s and probe.duration_s together, " +
                            format_number(tried_after_s) + " s: a slave answers once its motor was tried",
                 .place = {}};
  }
  const auto supervisor = SiteSupervisor::make({.role = role}, dt);
  if (!supervisor) return supervisor.error();
  return Supervision(*judge, *follower, *watchdog, *answer, *overload, *pace, *probe, *supervisor, role, params,
                     session, dt, agreement);
}

/// A packet tells the cell that its number names. One that does not is an old one under a new number, and so may be the
/// next that does by chance: its session is believed again once all cells have come in their turn.
bool Supervision::is_renumbered(const Packet& packet) noexcept {
  const AgreementExcerpt& said = packet.agreement;
  const Agreement& own = agreement_.own();
  if (said.digest == own.digest() && said.cell != own.excerpt(packet.sequence).cell) {
    doubted_session_ = packet.session;
    believed_from_ = packet.sequence + static_cast<std::int64_t>(own.size());
  }
  return packet.session == doubted_session_ && packet.sequence <= believed_from_;
}

PacketVerdict Supervision::take(const Packet& packet) noexcept {
  const PacketVerdict verdict = is_renumbered(packet) ? PacketVerdict::stale : judge_.step(packet);
  if (verdict == PacketVerdict::applied) {
    newest_ = packet;
    agreement_.take(packet.session, packet.agreement);
    arrived_ = true;
  } else {
    ++refused_;
  }
  return verdict;
}

/// Whether the master has waited too long for the slave to follow its arming.
bool Supervision::unanswered() noexcept {
  const std::int64_t armings = supervisor_.armings();
  const bool waits = role_ == SiteRole::master && before_ == SiteState::armed && newest_.armings != armings;
  if (!waits || armings != awaited_arming_) answer_.reset();
  awaited_arming_ = armings;
  return waits && answer_.step({.heard = false, .elapsed_ticks = elapsed_ticks_});
}

SiteState Supervision::decide(const Sight& sight) noexcept {
  before_ = supervisor_.state();
  elapsed_ticks_ = std::max<std::int64_t>(sight.elapsed_ticks, 1);
  fresh_ = arrived_;
  arrived_ = false;
  const bool guards = before_ == SiteState::armed || before_ == SiteState::active;
  // Where a site does not follow, its state is the latch.
  if (!guards && fresh_) watchdog_.reset();
  const bool silent = watchdog_.step({.heard = fresh_, .elapsed_ticks = elapsed_ticks_});
  const bool overloaded = overload_.step({.elapsed_ticks = elapsed_ticks_});
  proved_ = proved_ || probe_.verdict() == ProbeVerdict::passed;
  supervisor_.step(
      {.requests = sight.requests,
       .heard = newest_.session != 0,
       .session = newest_.session,
       .peer = newest_.state,
       .peer_armings = newest_.armings,
       .disagrees = agreement_.disagrees(),
       .silent = silent,
       .unanswered = unanswered(),
       .stalled = static_cast<double>(elapsed_ticks_) * dt_s_ > longest_stall_s_,
       .overloaded = overloaded,
       .out_of_pace = pace_.step(
           {.following = before_ == SiteState::active, .sequence = newest_.sequence, .elapsed_ticks = elapsed_ticks_}),
       .force_sensor = sight.force_sensor,
       .probe = cause_of(probe_.verdict()),
       .proved = proved_,
       .energy = sight.fault == GateFault::energy,
       .fault = sight.fault != GateFault::none && sight.fault != GateFault::energy});
  cannot_hold_ = state() == SiteState::hold && (cannot_hold_ || overloaded);
  if (arms_from_rest()) proved_ = !must_be_proved_;
  if (role_ == SiteRole::master || !probes()) answered_arming_ = supervisor_.armings();
  return state();
}

bool Supervision::arms_from_rest() const noexcept {
  return state() == SiteState::armed && (before_ == SiteState::align || before_ == SiteState::hold);
}

bool Supervision::rearms() const noexcept {
  return arms_from_rest() || (state() == SiteState::align && before_ != SiteState::align);
}

Arrival Supervision::arrival(double offset_m) noexcept {
  Arrival told{.message = newest_.message, .fresh = fresh_};
  told.message.position_m -= offset_m;
  return follower_.step({.arrival = told, .following = state() == SiteState::active, .elapsed_ticks = elapsed_ticks_});
}

double Supervision::probe(double position_m, bool force_passes) noexcept {
  probing_ = probes() && (probing_ || (share_ == 0.0 && !force_passes));
  return probe_.step({.probing = probing_, .position_m = position_m, .elapsed_ticks = elapsed_ticks_});
}

double Supervision::blend(bool in) noexcept {
  // Who lets go of the switch may let go of the handle, and what is left of the force would throw it.
  const bool nobody_holds =
      role_ == SiteRole::master && state() == SiteState::armed && supervisor_.cause() == SiteCause::dead_man;
  if (state() == SiteState::fault || nobody_holds) return share_ = 0.0;
  // After a stall a force goes as far as it should have gone by now, but comes no farther than in one tick.
  const double out_step = (state() == SiteState::hold ? hold_step_ : blend_step_) * static_cast<double>(elapsed_ticks_);
  return share_ = in ? std::min(share_ + blend_step_, 1.0) : std::max(share_ - out_step, 0.0);
}

Packet Supervision::packet(const Message& message) noexcept {
  return {.session = session_,
          .sequence = ++sequence_,
          .age_s = 0.0,
          .state = state(),
          .armings = answered_arming_,
          .message = message,
          .agreement = agreement_.own().excerpt(sequence_)};
}

SiteRecord Supervision::record() const noexcept {
  return {.state = static_cast<std::int64_t>(state()),
          .cause = static_cast<std::int64_t>(supervisor_.cause()),
          .armings = supervisor_.armings(),
          .applied_session = newest_.session,
          .applied_sequence = newest_.sequence,
          .refused = refused_,
          .fresh = fresh_,
          .silence_s = watchdog_.silence_s(),
          .share = share_,
          .gap_m = follower_.gap_m(),
          .differs = static_cast<std::int64_t>(agreement_.first_difference())};
}

}  // namespace tactus::control
