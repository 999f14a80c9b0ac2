// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/supervision.hpp>

#include <algorithm>
#include <limits>

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

/// The name of the first number in which two sets of parameters differ; empty where they don't.
template <Described T>
std::string first_difference(const T& one, const T& other) {
  std::string found;
  for_each_field<T>([&](const auto& f) {
    if (!found.empty()) return;
    using Value = std::remove_cvref_t<decltype(one.*f.member)>;
    if constexpr (Described<Value>) {
      const std::string inner = first_difference(one.*f.member, other.*f.member);
      if (!inner.empty()) found = std::string(f.name).append(1, '.').append(inner);
    } else if (one.*f.member != other.*f.member) {
      found = f.name;
    }
  });
  return found;
}

/// That a joint has no other value of what the site has but once.
Check check_shared(const SupervisionParams& site, SupervisionParams joint) {
  joint.packets.position_limit_m = site.packets.position_limit_m;
  joint.packets.force_limit_N = site.packets.force_limit_N;
  joint.silence = site.silence;
  joint.force_sensor = site.force_sensor;
  joint.hand_sensor = site.hand_sensor;
  joint.probe = site.probe;
  const std::string other = first_difference(site, joint);
  if (other.empty()) return {};
  return Error{.code = ErrorCode::inconsistent,
               .parameter = other,
               .message = "differs from that of joint 1: a site has one for all its joints",
               .place = {}};
}

}  // namespace

template <class Payload>
Result<SupervisionOf<Payload>> SupervisionOf<Payload>::make(const Params& all, SiteRole role, std::int64_t session,
                                                            Seconds dt, const Agreement& agreement) {
  const SupervisionParams& params = joint_of(all, 0);
  double carried_after_s = params.blend_s;
  for (std::size_t joint = 0; joint < joints_of(all); ++joint) {
    const double raise_s = joint_of(all, joint).support.raise_s;
    if (raise_s > 0.0) carried_after_s = std::max(carried_after_s, raise_s + SupportRaiseOf<Payload>::settles_s);
  }
  double tried_after_s = carried_after_s;
  for (std::size_t joint = 0; joint < joints_of(all); ++joint) {
    const SupervisionParams& own = joint_of(all, joint);
    if (auto error = signal::check(own, dt)) return under_joint<Payload>(joint, *std::move(error));
    if (auto error = check_shared(params, own)) return under_joint<Payload>(joint, *std::move(error));
    if (own.probe.force_N > 0.0) tried_after_s += SignProbe::longest_s(own.probe);
  }
  if (session == 0) {
    return Error{.code = ErrorCode::out_of_bounds,
                 .parameter = "session",
                 .message = "0 stands for no session: draw another number",
                 .place = {}};
  }
  const auto judge = PacketJudgeOf<Payload>::make(member_of_each(all, &SupervisionParams::packets), dt);
  if (!judge) return under("packets", judge.error());
  const auto follower = make_each<MessageFollower>(member_of_each(all, &SupervisionParams::silence), dt);
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
  const auto probe = make_each<SignProbe>(member_of_each(all, &SupervisionParams::probe), dt);
  if (!probe) return under("probe", probe.error());
  if (tried_after_s > carried_after_s && params.answer_within_s <= tried_after_s) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "answer_within_s",
                 .message = rounded_number(params.answer_within_s) + " s must be more than " +
                            (carried_after_s > params.blend_s ? "support.raise_s" : "blend_s") +
                            " and all trials of probe together, " + rounded_number(tried_after_s) +
                            " s: a slave answers once its motor was tried; raise it, or write a smaller "
                            "probe.most_force_N or probe.duration_s",
                 .place = {}};
  }
  const auto support =
      SupportRaiseOf<Payload>::make(member_of_each(all, &SupervisionParams::support), params.blend_s, dt);
  if (!support) return under("support", support.error());
  const auto supervisor = SiteSupervisor::make({.role = role}, dt);
  if (!supervisor) return supervisor.error();
  return SupervisionOf(*judge, *follower, *watchdog, *answer, *overload, *pace, *probe, *support, *supervisor, role,
                       all, session, dt, agreement);
}

/// A packet tells the cell that its number names. One that does not is an old one under a new number, and so may be the
/// next that does by chance: its session is believed again once all cells have come in their turn.
template <class Payload>
bool SupervisionOf<Payload>::is_renumbered(const Packet& packet) noexcept {
  const AgreementExcerpt& said = packet.agreement;
  const Agreement& own = agreement_.own();
  if (said.digest == own.digest() && said.cell != own.excerpt(packet.sequence).cell) {
    doubted_session_ = packet.session;
    const auto turn = static_cast<std::int64_t>(own.size());
    believed_from_ = std::min(packet.sequence, std::numeric_limits<std::int64_t>::max() - turn) + turn;
  }
  return packet.session == doubted_session_ && packet.sequence <= believed_from_;
}

template <class Payload>
PacketVerdict SupervisionOf<Payload>::take(const Packet& packet) noexcept {
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
template <class Payload>
bool SupervisionOf<Payload>::unanswered() noexcept {
  const std::int64_t armings = supervisor_.armings();
  const bool waits = role_ == SiteRole::master && before_ == SiteState::armed && newest_.armings != armings;
  if (!waits || armings != awaited_arming_) answer_.reset();
  awaited_arming_ = armings;
  return waits && answer_.step({.heard = false, .elapsed_ticks = elapsed_ticks_});
}

template <class Payload>
SiteState SupervisionOf<Payload>::decide(const Snapshot& snapshot) noexcept {
  before_ = supervisor_.state();
  elapsed_ticks_ = std::max<std::int64_t>(snapshot.elapsed_ticks, 1);
  fresh_ = arrived_;
  arrived_ = false;
  const bool guards = before_ == SiteState::armed || before_ == SiteState::active;
  // Where a site does not follow, its state is the latch.
  if (!guards && fresh_) watchdog_.reset();
  const bool silent = watchdog_.step({.heard = fresh_, .elapsed_ticks = elapsed_ticks_});
  const bool overloaded = overload_.step({.elapsed_ticks = elapsed_ticks_});
  proved_ = proved_ || probe_passed();
  supervisor_.step(
      {.requests = snapshot.requests,
       .heard = newest_.session != 0,
       .session = newest_.session,
       .peer = newest_.state,
       .peer_armings = newest_.armings,
       .disagrees = agreement_.disagrees(),
       .silent = silent,
       .unanswered = unanswered(),
       .stalled = static_cast<double>(elapsed_ticks_) * dt_s_ > longest_stall_s_,
       .overloaded = overloaded,
       .device_silent = snapshot.device_silent,
       .out_of_pace = pace_.step(
           {.following = before_ == SiteState::active, .sequence = newest_.sequence, .elapsed_ticks = elapsed_ticks_}),
       .force_sensor = snapshot.force_sensor,
       .probe = probe_failed(),
       .proved = proved_,
       .support_moves = support_.failed(),
       .too_heavy = support_.too_heavy(),
       .energy = snapshot.fault == GateFault::energy,
       .fault = snapshot.fault != GateFault::none && snapshot.fault != GateFault::energy});
  cannot_hold_ =
      state() == SiteState::hold && (cannot_hold_ || overloaded || snapshot.device_silent || support_.failed());
  if (arms_from_rest()) {
    proved_ = true;
    for_each_joint([this](bool tried) noexcept { proved_ = proved_ && !tried; }, tried_);
  }
  if (role_ == SiteRole::master || !probes()) answered_arming_ = supervisor_.armings();
  return state();
}

template <class Payload>
bool SupervisionOf<Payload>::arms_from_rest() const noexcept {
  return state() == SiteState::armed && (before_ == SiteState::align || before_ == SiteState::hold);
}

template <class Payload>
bool SupervisionOf<Payload>::rearms() const noexcept {
  return arms_from_rest() || (state() == SiteState::align && before_ != SiteState::align);
}

template <class Payload>
Each<Payload, Arrival> SupervisionOf<Payload>::arrival(const Lengths& offset_m) noexcept {
  Each<Payload, Arrival> arrivals = same_for_each(offset_m, Arrival{});
  for_each_joint(
      [this](MessageFollower& follower, const Message& message, double offset, Arrival& arrival) noexcept {
        Arrival told{.message = message, .fresh = fresh_};
        told.message.position_m -= offset;
        arrival = follower.step(
            {.arrival = told, .following = state() == SiteState::active, .elapsed_ticks = elapsed_ticks_});
      },
      follower_, newest_.message, offset_m, arrivals);
  return arrivals;
}

template <class Payload>
typename SupervisionOf<Payload>::Forces SupervisionOf<Payload>::probe(const Lengths& position_m, bool force_passes,
                                                                      bool sinks) noexcept {
  probing_ = probes() && (probing_ || (share_ == 0.0 && !force_passes && !sinks));
  Forces forces = same_for_each(position_m, 0.0);
  bool turn = probing_;
  for_each_joint(
      [this, &turn](SignProbe& probe, bool tried, double position, double& force) noexcept {
        force = probe.step({.probing = turn && tried, .position_m = position, .elapsed_ticks = elapsed_ticks_});
        turn = turn && (!tried || probe.verdict() == ProbeVerdict::passed);
      },
      probe_, tried_, position_m, forces);
  return forces;
}

/// Why the first joint that did not pass did not.
template <class Payload>
SiteCause SupervisionOf<Payload>::probe_failed() const noexcept {
  SiteCause cause = SiteCause::none;
  for_each_joint(
      [&cause](const SignProbe& probe) noexcept {
        if (cause == SiteCause::none) cause = cause_of(probe.verdict());
      },
      probe_);
  return cause;
}

template <class Payload>
ProbeFinding SupervisionOf<Payload>::probe_finding() const noexcept {
  ProbeFinding found;
  const SiteCause cause = supervisor_.cause();
  if (cause == SiteCause::none) return found;
  std::size_t joint = 0;
  for_each_joint(
      [&found, &joint, cause](const SignProbe& probe) noexcept {
        if (cause_of(probe.report().verdict) == cause) found = {.report = probe.report(), .joint = joint};
        ++joint;
      },
      probe_);
  return found;
}

template <class Payload>
bool SupervisionOf<Payload>::probe_passed() const noexcept {
  bool passed = true;
  for_each_joint(
      [&passed](const SignProbe& probe, bool tried) noexcept {
        passed = passed && (!tried || probe.verdict() == ProbeVerdict::passed);
      },
      probe_, tried_);
  return passed;
}

template <class Payload>
double SupervisionOf<Payload>::blend(bool in) noexcept {
  // Who lets go of the switch may let go of the handle, and what is left of the force would throw it.
  const bool nobody_holds =
      role_ == SiteRole::master && state() == SiteState::armed && supervisor_.cause() == SiteCause::dead_man;
  if (state() == SiteState::fault || nobody_holds) return share_ = 0.0;
  // After a stall a force goes as far as it should have gone by now, but comes no farther than in one tick.
  const double out_step = (state() == SiteState::hold ? hold_step_ : blend_step_) * static_cast<double>(elapsed_ticks_);
  return share_ = in ? std::min(share_ + blend_step_, 1.0) : std::max(share_ - out_step, 0.0);
}

template <class Payload>
double SupervisionOf<Payload>::carry(const Lengths& at_m) noexcept {
  return support_.step(state() != SiteState::configure, lets_go(), at_m, elapsed_ticks_);
}

template <class Payload>
PacketOf<Payload> SupervisionOf<Payload>::packet(const Payload& message) noexcept {
  return {.session = session_,
          .sequence = ++sequence_,
          .age_s = 0.0,
          .state = state(),
          .armings = answered_arming_,
          .message = message,
          .agreement = agreement_.own().excerpt(sequence_)};
}

template <class Payload>
SiteRecord SupervisionOf<Payload>::record() const noexcept {
  double gap_m = 0.0;
  for_each_joint([&gap_m](const MessageFollower& follower) noexcept { gap_m = farther(gap_m, follower.gap_m()); },
                 follower_);
  return {.state = static_cast<std::int64_t>(state()),
          .cause = static_cast<std::int64_t>(supervisor_.cause()),
          .armings = supervisor_.armings(),
          .applied_session = newest_.session,
          .applied_sequence = newest_.sequence,
          .refused = refused_,
          .fresh = fresh_,
          .silence_s = watchdog_.silence_s(),
          .share = share_,
          .gap_m = gap_m,
          .differs = static_cast<std::int64_t>(agreement_.first_difference())};
}

template class SupervisionOf<Message>;
template class SupervisionOf<Joints<Message>>;

}  // namespace tactus::control
