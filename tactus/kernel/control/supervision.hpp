// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/agreement.hpp>
#include <tactus/kernel/control/force_sensor_check.hpp>
#include <tactus/kernel/control/gain_change.hpp>
#include <tactus/kernel/control/message_follower.hpp>
#include <tactus/kernel/control/overload_check.hpp>
#include <tactus/kernel/control/pace_check.hpp>
#include <tactus/kernel/control/packet.hpp>
#include <tactus/kernel/control/sign_probe.hpp>
#include <tactus/kernel/control/site_supervisor.hpp>
#include <tactus/kernel/control/support_raise.hpp>
#include <tactus/kernel/control/tare_report.hpp>
#include <tactus/kernel/control/watchdog.hpp>
#include <tactus/kernel/core/signals.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace tactus::control {

/// What becomes of a force in `hold`.
struct HoldParams {
  double release_s = 1.0;
  static constexpr auto fields() {
    return List{
        field("release_s", &HoldParams::release_s, units::second, positive_up_to(60.0),
              "Time in which the coupling force falls to zero after the site goes to hold; gravity compensation "
              "stays on. A slave that must not sink or swing away needs a brake.")};
  }
};

/// The group `[control.supervision]`: what a site makes of the other one and of its own state.
struct SupervisionParams {
  PacketJudgeParams packets;
  MessageFollower::Params silence;
  Watchdog::Params watchdog;
  ForceSensorCheck::Params force_sensor;
  ForceSensorCheck::Params hand_sensor{.residual_limit_N = 200.0};
  OverloadCheck::Params overload;
  SignProbe::Params probe;
  HoldParams hold;
  GainChange::Params force_gain;
  double pace_share = 0.25;
  double longest_stall_s = 0.02;
  double answer_within_s = 1.0;
  double blend_s = 0.1;
  /// Of what carries a joint; no key of this group, for it follows from the arm and its rig.
  SupportCheck::Params support = {};
  static constexpr auto fields() {
    return List{
        field("packets", &SupervisionParams::packets, "Limits for packets from the other site."),
        field("silence", &SupervisionParams::silence, "Values that replace the received ones while no packets arrive."),
        field("watchdog", &SupervisionParams::watchdog, "Time without packets after which the site holds."),
        field("force_sensor", &SupervisionParams::force_sensor, "Check of the force sensor at the tip."),
        field("hand_sensor", &SupervisionParams::hand_sensor,
              "Check of the master's motor against a force sensor at the hand. Without such a sensor, set a limit so "
              "large that it never applies."),
        field("overload", &SupervisionParams::overload, "Limit of missed control cycles above which a site holds."),
        field("probe", &SupervisionParams::probe, "The force that tests the sign of a site's motor on arming."),
        field("hold", &SupervisionParams::hold, "The force when the site holds."),
        field("force_gain", &SupervisionParams::force_gain,
              "How an operator may change the force gain while the site runs."),
        field("pace_share", &SupervisionParams::pace_share, units::none, positive_up_to(0.9),
              "If the other site's clock is slower or faster by more than this share, the site goes to hold. Must be "
              "greater than the share of control cycles that the other site may miss."),
        field("longest_stall_s", &SupervisionParams::longest_stall_s, units::second, positive_up_to(1.0),
              "Longest time between two control cycles. After a longer one the site goes to hold."),
        field(
            "answer_within_s", &SupervisionParams::answer_within_s, units::second, positive_up_to(10.0),
            "If the slave does not confirm an arming within this time, the master goes to hold. Must be longer than "
            "the round trip; with a sign probe, longer than round trip, blend_s and all trials of the probe together."),
        field("blend_s", &SupervisionParams::blend_s, units::second, positive_up_to(10.0),
              "Time in which a force ramps in when a site becomes active, and ramps out when it stops.")};
  }
};

/// A motor that did not pass its sign probe.
struct ProbeFinding {
  ProbeReport report;
  std::size_t joint = 0;
};

/// The words of an enum and the numbers that stand for them in a log, behind `prefix`: "Why: 0 none, 1 started."
struct Legend {
  char text[512]{};
};
template <NamedEnum E>
constexpr Legend legend(std::string_view prefix) {
  Legend made;
  std::size_t size = 0;
  const auto add = [&](std::string_view text) {
    for (const char character : text) made.text[size++] = character;
  };
  const auto add_number = [&](int number) {
    if (number >= 10) made.text[size++] = static_cast<char>('0' + number / 10);
    made.text[size++] = static_cast<char>('0' + number % 10);
  };
  add(prefix);
  bool first = true;
  for (const auto& entry : enumerators(E{})) {
    if (!first) add(", ");
    first = false;
    add_number(static_cast<int>(entry.value));
    add(" ");
    add(entry.name);
  }
  add(".");
  return made;
}
inline constexpr Legend state_legend = legend<SiteState>("");
inline constexpr Legend cause_legend = legend<SiteCause>("Why the site does not follow: ");
inline constexpr Legend limit_legend = legend<ActiveLimit>("What changes the force right now: ");
inline constexpr Legend fault_legend = legend<GateFault>("What the gate latched: ");
inline constexpr Legend tare_legend = legend<TareState>("The latest tare: ");

/// What supervision shows of a tick. State, cause, limit and fault are four different things: what the site does, why
/// it does not follow, what changes the force right now, and what made the gate release.
struct SiteRecord {
  std::int64_t state = 0;
  std::int64_t cause = 0;
  std::int64_t limit = 0;
  std::int64_t fault = 0;
  std::int64_t armings = 0;
  std::int64_t applied_session = 0;
  std::int64_t applied_sequence = 0;
  std::int64_t refused = 0;
  bool enabled = false;
  bool fresh = false;
  double silence_s = 0.0;
  double share = 0.0;
  double offset_m = 0.0;
  double gap_m = 0.0;
  double given_J = 0.0;
  std::int64_t differs = 0;
  double force_gain = 0.0;
  std::int64_t tare = 0;
  static constexpr auto signals() {
    return List{
        observed("state", &SiteRecord::state, units::none, "", "", "", state_legend.text),
        observed("cause", &SiteRecord::cause, units::none, "", "", "", cause_legend.text),
        observed("limit", &SiteRecord::limit, units::none, "", "", "", limit_legend.text),
        observed("fault", &SiteRecord::fault, units::none, "", "", "", fault_legend.text),
        observed("armings", &SiteRecord::armings, units::none, "", "", "", "The arming that is followed."),
        observed("applied_session", &SiteRecord::applied_session, units::none, "", "", "",
                 "Session of the packet that was applied last."),
        observed("applied_sequence", &SiteRecord::applied_sequence, units::none, "", "", "", "Its sequence."),
        observed("refused", &SiteRecord::refused, units::none, "", "", "", "Packets so far that were not applied."),
        observed("enabled", &SiteRecord::enabled, units::none, "", "", "",
                 "The drive may have power: not in configure, and in fault, or in a hold that lets the motor go, only "
                 "until the force is zero."),
        observed("fresh", &SiteRecord::fresh, units::none, "", "", "", "A packet was applied in this control cycle."),
        observed("silence_s", &SiteRecord::silence_s, units::second, "", "", "", "Since a packet was applied."),
        observed("share", &SiteRecord::share, units::none, "", "", "", "Of the controller's force that is let in."),
        observed("offset_m", &SiteRecord::offset_m, units::metre, "", "slave", "toward the environment",
                 "Workspace offset: the sent position less the controller's."),
        observed("gap_m", &SiteRecord::gap_m, units::metre, "", "", "toward the environment",
                 "What is still to be caught up of the other's position."),
        observed("given_J", &SiteRecord::given_J, units::joule, "", "", "the motor gave it",
                 "Account of the passivity monitor."),
        observed("differs", &SiteRecord::differs, units::none, "", "", "",
                 "Cell of the agreement in which the other site is known to differ, from 1; 0 for none."),
        observed("force_gain", &SiteRecord::force_gain, units::none, "master", "hand", "",
                 "Displayed force over the force that the slave sends, as it acts; 0 without a gain that "
                 "can change."),
        observed("tare", &SiteRecord::tare, units::none, "", "", "", tare_legend.text)};
  }
};

/// One site's half of the link, its watchdog and its state: what both sites have in common. A site is in one state,
/// with all its joints: what is wrong with one of them holds them all. Each joint has its own follower, and its motor
/// is tried by itself, one after the other, since each moves the others too.
template <class Payload>
class SupervisionOf {
 public:
  using Params = Each<Payload, SupervisionParams>;
  using Packet = PacketOf<Payload>;
  using Lengths = Each<Payload, double>;  ///< in m
  using Forces = Each<Payload, double>;   ///< in N

  /// A site whose other half does not have `agreement` in common with it is never armed. Of several joints, what the
  /// site has but once must be the same for all: what they may differ in are the limits of `packets`, `silence`,
  /// `probe` and the checks of force sensors.
  static Result<SupervisionOf> make(const Params& params, SiteRole role, std::int64_t session, Seconds dt,
                                    const Agreement& agreement = {});

  /// What the site itself saw, for `decide`.
  struct Snapshot {
    SiteRequests requests{};
    std::int64_t elapsed_ticks = 1;
    bool device_silent = false;
    GateFault fault = GateFault::none;
    bool force_sensor = false;
  };

  /// A packet that has come; any number of them before `decide`. Real-time safe.
  PacketVerdict take(const Packet& packet) noexcept;
  /// What was read of a device that something carries. Once, before `decide`.
  void look(typename SupportRaiseOf<Payload>::Snapshot snapshot) noexcept {
    snapshot.tried = probing_;
    snapshot.proved = !tries() || proved_;
    support_.look(snapshot);
  }
  /// The state for this tick. Real-time safe.
  SiteState decide(const Snapshot& snapshot) noexcept;
  /// What the controller shall take as the message of the other site, its positions moved by `-offset_m`. Once, after
  /// `decide`.
  Each<Payload, Arrival> arrival(const Lengths& offset_m) noexcept;
  /// The force in N to add to the controller's while the motor is tried: from when the controller's has gone, none
  /// passes to the motor any more (`force_passes`), `position_m` being measured. `sinks` where something carries the
  /// device and has not come in yet: then the trial waits for that. Once, after `decide` and before `blend` and
  /// `carry`.
  Forces probe(const Lengths& position_m, bool force_passes, bool sinks = false) noexcept;
  /// Whether the site is armed and its motor not yet tried: the controller's force must go.
  [[nodiscard]] bool probes() const noexcept { return state() == SiteState::armed && !proved_; }
  /// The share of the controller's force, on its way to 1 or 0; in `fault`, and at a master whose dead-man switch was
  /// released, 0 at once, for the gate to ramp. Once, after `decide`.
  double blend(bool in) noexcept;
  /// The share of gravity compensation: rises to 1 wherever the site has power and is not released, falls to 0 in
  /// `configure`; where it releases 0 at once, for the gate to ramp. Once, after `decide`.
  double carry(const Lengths& at_m) noexcept;
  /// The share of the law that holds the device while its support comes in. The coupling takes its place, and so does
  /// what `moves` the device. Once, after `blend` and `carry`.
  double hold(bool moves) noexcept {
    moved_share_ = moves ? std::min(moved_share_ + blend_step_, 1.0) : 0.0;
    return support_.hold(std::max(share_, moved_share_));
  }
  /// Whether all of it has come in, at the latest tick, and was judged where that is wanted.
  [[nodiscard]] bool carries() const noexcept { return support_.share() == 1.0 && !support_.rises(); }
  [[nodiscard]] const SupportRaiseOf<Payload>& support() const noexcept { return support_; }
  /// Whether the device is held until its support has come in and its motors were tried: nothing else may pull it.
  [[nodiscard]] bool is_held() const noexcept {
    return support_.holds() && (support_.rises() || (tries() && !proved_));
  }
  /// The packet that states `message`. Once a tick.
  Packet packet(const Payload& message) noexcept;
  /// A slave's command is `position_m` until it follows.
  void stand(const Lengths& position_m) noexcept {
    for_each_joint([](MessageFollower& follower, double at_m) noexcept { follower.settle(at_m); }, follower_,
                   position_m);
  }
  /// Until a master follows, it assumes the slave where the newest packet puts it, less `offset_m`. Otherwise it would
  /// start at 0 and be pulled toward that.
  void stand_at_packet(const Lengths& offset_m) noexcept {
    for_each_joint([](MessageFollower& follower, const Message& message,
                      double offset) noexcept { follower.settle(message.position_m - offset); },
                   follower_, newest_.message, offset_m);
  }

  [[nodiscard]] SiteState state() const noexcept { return supervisor_.state(); }
  [[nodiscard]] SiteCause cause() const noexcept { return supervisor_.cause(); }
  /// Whether the motor must get no force any more: in `fault`, and in a `hold` in which the site misses too many ticks
  /// to close a loop, or receives no reading of its device, or because its support moved it, or because motor and force
  /// sensor contradict one another, when either may be wrong.
  [[nodiscard]] bool lets_go() const noexcept { return state() == SiteState::fault || cannot_hold_ || contradicted(); }
  /// Whether that is because motor and force sensor contradict one another.
  [[nodiscard]] bool contradicted() const noexcept {
    return state() == SiteState::hold && supervisor_.cause() == SiteCause::force_sensor && !cannot_hold_;
  }
  [[nodiscard]] SiteState before() const noexcept { return before_; }
  /// Whether the site is armed, its motors are tried, all of its support has come in, and it does not follow: then a
  /// tare has the device for itself.
  [[nodiscard]] bool may_tare() const noexcept {
    return state() == SiteState::armed && before_ == SiteState::armed && !probes() && carries() && !is_held();
  }
  /// What the other site has in common with this one.
  [[nodiscard]] const AgreementCheck& agreement() const noexcept { return agreement_; }
  /// The packet that was applied last; of session 0 before any.
  [[nodiscard]] const Packet& heard() const noexcept { return newest_; }
  /// Which joint did not pass the sign probe, while that is why the site does not follow; else no verdict.
  [[nodiscard]] ProbeFinding probe_finding() const noexcept;
  /// Whether the site leaves what its gate or its controller latched, at this tick.
  [[nodiscard]] bool rearms() const noexcept;
  /// Everything that supervision itself knows; the rest is the site's to fill in.
  [[nodiscard]] SiteRecord record() const noexcept;

 private:
  /// Whether arming tries any motor.
  [[nodiscard]] bool tries() const noexcept {
    bool any = false;
    for_each_joint([&any](bool tried) noexcept { any = any || tried; }, tried_);
    return any;
  }
  [[nodiscard]] bool is_renumbered(const Packet& packet) noexcept;
  [[nodiscard]] bool unanswered() noexcept;
  [[nodiscard]] bool arms_from_rest() const noexcept;
  [[nodiscard]] SiteCause probe_failed() const noexcept;
  [[nodiscard]] bool probe_passed() const noexcept;
  SupervisionOf(const PacketJudgeOf<Payload>& judge, const Each<Payload, MessageFollower>& follower,
                const Watchdog& watchdog, const Watchdog& answer, const OverloadCheck& overload, const PaceCheck& pace,
                const Each<Payload, SignProbe>& probe, const SupportRaiseOf<Payload>& support,
                const SiteSupervisor& supervisor, SiteRole role, const Params& all, std::int64_t session, Seconds dt,
                const Agreement& agreement)
      : judge_(judge),
        follower_(follower),
        watchdog_(watchdog),
        answer_(answer),
        overload_(overload),
        pace_(pace),
        probe_(probe),
        support_(support),
        supervisor_(supervisor),
        role_(role),
        dt_s_(dt.value),
        session_(session),
        agreement_(agreement),
        newest_{.message = same_for_each(all, Message{})},
        tried_(same_for_each(all, false)) {
    const SupervisionParams& params = joint_of(all, 0);
    longest_stall_s_ = params.longest_stall_s;
    blend_step_ = dt.value / params.blend_s;
    hold_step_ =
        dt.value / (role == SiteRole::slave ? params.hold.release_s : std::min(params.hold.release_s, params.blend_s));
    for_each_joint([](bool& tried, const SupervisionParams& joint) { tried = joint.probe.force_N > 0.0; }, tried_, all);
  }

  PacketJudgeOf<Payload> judge_;
  Each<Payload, MessageFollower> follower_;
  Watchdog watchdog_;
  Watchdog answer_;  ///< of the slave to an arming
  OverloadCheck overload_;
  PaceCheck pace_;
  Each<Payload, SignProbe> probe_;
  SupportRaiseOf<Payload> support_;
  SiteSupervisor supervisor_;
  SiteRole role_;
  double dt_s_;
  double longest_stall_s_ = 0.0;
  double blend_step_ = 0.0;
  double hold_step_ = 0.0;  ///< of the share, in a tick of `hold`
  std::int64_t session_;
  std::int64_t sequence_ = 0;
  std::int64_t doubted_session_ = 0;  ///< which put new numbers on old packets
  std::int64_t believed_from_ = 0;    ///< number of its packets after which they count again
  AgreementCheck agreement_;
  Packet newest_;
  Each<Payload, bool> tried_;  ///< whether arming tries the motor
  bool arrived_ = false;
  bool fresh_ = false;
  std::int64_t elapsed_ticks_ = 1;
  std::int64_t refused_ = 0;
  std::int64_t awaited_arming_ = 0;
  std::int64_t answered_arming_ = 0;  ///< that packets carry: a slave's only once its motor was tried
  bool proved_ = false;               ///< the motor was tried since the site was armed, or need not be
  bool probing_ = false;              ///< the trial is under way
  bool cannot_hold_ = false;          ///< too many ticks were missed in this hold, its device did not respond or moved
  double share_ = 0.0;
  double moved_share_ = 0.0;  ///< grows while something else moves the device
  SiteState before_ = SiteState::configure;
};
using Supervision = SupervisionOf<Message>;
using JointSupervision = SupervisionOf<Joints<Message>>;

}  // namespace tactus::control
