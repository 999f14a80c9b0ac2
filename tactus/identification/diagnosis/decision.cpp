// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/diagnosis/decision.hpp>
#include <tactus/identification/diagnosis/wording.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace tactus::diagnosis {

namespace {

constexpr double untested = 0.5;
constexpr double least_score = 0.55;  ///< more than untested
constexpr double least_lead = 0.25;
constexpr double usual_tremor_m = 1.5e-4, usual_tremor_rad = 3e-3;
constexpr double deliberate_below_Hz = 3.2;  ///< people lead at up to 3 Hz
constexpr double ends_below = 0.3;           ///< of the speed of the person's slower motion
/// The largest tremor of 97 healthy hands had a peak of 0.035 g at its main frequency (Wade, Gresty and Findley, A
/// normative study of postural tremor of the hand, Archives of Neurology 39(6), 1982): 0.18 mm at 7 Hz. Ten times as
/// much is accepted without doubt, thirty times as much is no hand's. The lever is that of `usual_tremor_rad`.
constexpr double likely_tremor_mps2 = 3.4, largest_tremor_mps2 = 10.3, tremor_lever_m = 0.05;

constexpr double explains_well = 0.9;  ///< of the variance of a force

/// 0 at `from`, 1 at `to`, a straight line between; either may be the larger.
double ramp(double value, double from, double to) { return std::clamp((value - from) / (to - from), 0.0, 1.0); }
std::optional<double> ramp(const std::optional<double>& value, double from, double to) {
  return value ? std::optional(ramp(*value, from, to)) : std::nullopt;
}
std::optional<double> opposite(const std::optional<double>& score) {
  return score ? std::optional(1.0 - *score) : std::nullopt;
}

struct Scored {
  Mechanism mechanism;
  double score = 1.0;
  std::vector<Role> missing = {};

  /// It must show this, which these signals would tell.
  Scored& must(const std::optional<double>& shown, std::initializer_list<Role> told_by = {}) {
    score = std::min(score, shown.value_or(untested));
    if (!shown) missing.insert(missing.end(), told_by);
    return *this;
  }
};

/// What the tests of all mechanisms share, each 0 to 1.
struct Shown {
  std::optional<double> slave_alone, slave_part, leads_itself, few_slave_steps, few_master_steps, slave_to_and_fro,
      master_to_and_fro, standstill, contact, passive_contact, delayed, coupled, own_wall, drives, hand, actuator,
      line_of_master, size_of_tremor;
  double steady, tremor_band, slow_enough_to_stick;
};

/// Does the master's own position explain the displayed force, and nothing else as well?
std::optional<double> own_wall_of(const Evidence& evidence) {
  if (!evidence.own_wall) return std::nullopt;
  const OwnWall& wall = *evidence.own_wall;
  // Within one line any position explains a force in some phase, so a coupling that explains it well outranks a wall.
  constexpr double as_good = 0.02;
  const double coupling = evidence.delay_back_s ? evidence.coupling_explains.value_or(0.0) : 0.0;
  const bool of_another = evidence.tip_explains.value_or(0.0) > wall.explained - as_good ||
                          coupling > std::min(wall.explained, explains_well);
  if (of_another) return 0.0;
  // A force that is switched, or held while the device moves, is no measured one. Any other has to be exact.
  if (wall.switched) return ramp(wall.explained, 0.4, 0.65);
  return wall.held_s > 0.0 ? ramp(wall.explained, 0.9, 0.97) : ramp(wall.explained, 0.985, 0.998);
}

/// Does a position go to and fro over counts, by half of one or more?
std::optional<double> to_and_fro(const std::optional<double>& steps, const std::optional<double>& turns) {
  if (!steps || !turns) return std::nullopt;
  return std::min({ramp(*steps, 5.0, 3.0), ramp(*steps, 0.2, 0.5), ramp(*turns, 0.25, 0.5)});
}

Shown shown_by(const Signals& signals, const Oscillation& oscillation, const Evidence& evidence) {
  const double f_Hz = oscillation.frequency_Hz;
  Shown shown{.slave_alone = ramp(evidence.master_part, 0.35, 0.12),
              .slave_part = ramp(evidence.master_part, 10.0, 4.0),
              .leads_itself = ramp(evidence.follows, 0.9, 0.6),
              .few_slave_steps = ramp(evidence.slave_steps, 5.0, 3.0),
              .few_master_steps = ramp(evidence.master_steps, 5.0, 3.0),
              .slave_to_and_fro = to_and_fro(evidence.slave_steps, evidence.slave_turns),
              .master_to_and_fro = to_and_fro(evidence.master_steps, evidence.master_turns),
              .standstill = ramp(evidence.standstill, 0.25, 0.45),
              .contact = ramp(evidence.contact, 0.1, 0.3),
              .passive_contact = ramp(evidence.tip_gives, 0.6, 0.3),
              .delayed = {},
              .coupled = {},
              .own_wall = own_wall_of(evidence),
              .drives = ramp(evidence.actuator_gives, 0.03, 0.15),
              .hand = {},
              .actuator = {},
              .line_of_master = ramp(evidence.master_line, 0.15, 0.35),
              .size_of_tremor = {},
              .steady = std::max(ramp(evidence.wander, 0.45, 0.25), ramp(f_Hz, 14.0, 20.0)),
              .tremor_band = std::min(ramp(f_Hz, 2.5, 3.5), ramp(f_Hz, 16.0, 13.0)),
              .slow_enough_to_stick = ramp(f_Hz, 40.0, 25.0)};
  if (evidence.delay_there_s || evidence.delay_back_s) {
    // A direction whose force was not recorded is taken to be as long as the other.
    const bool has_there = signals.find(Role::slave_force) != nullptr,
               has_back = signals.find(Role::displayed_force) != nullptr;
    const double there_s = evidence.delay_there_s.value_or(0.0), back_s = evidence.delay_back_s.value_or(0.0);
    const double round_trip_s = (has_there ? there_s : back_s) + (has_back ? back_s : there_s);
    shown.delayed = ramp(2.0 * std::numbers::pi * f_Hz * round_trip_s, 0.3, 0.8);
    // A coupling that leaves more of the force than the master's own position does is in doubt.
    const double explained = evidence.coupling_explains.value_or(1.0);
    if (explained < explains_well && evidence.own_wall && evidence.own_wall->explained > explained) {
      shown.delayed = std::min(*shown.delayed, untested);
    }
  }
  // The coupling and the contact may both explain a force: a servo presses as hard as its position error asks. Only a
  // force that the tip's explains less is the coupling's.
  if (evidence.coupling_explains && evidence.tip_explains) {
    shown.coupled = evidence.delay_back_s ? ramp(*evidence.coupling_explains - *evidence.tip_explains, 0.0, 0.1) : 0.0;
  }
  if (const std::optional<double>& moved = evidence.of(Role::master_position)) {
    const double turns = 2.0 * std::numbers::pi * f_Hz;
    shown.size_of_tremor =
        ramp(*moved * (signals.rotary ? tremor_lever_m : 1.0) * turns * turns, largest_tremor_mps2, likely_tremor_mps2);
  }
  // No hand shakes faster than a tremor. Below, it is the hand or the loop that gives the energy. A measured hand force
  // says which. So does the displayed one; but a contact that is felt late gives some energy back to any hand that
  // shakes it, so in contact more is asked of it.
  const double beyond_a_hand = ramp(f_Hz, 14.0, 20.0);
  std::optional<double> loop;
  if (evidence.hand_gives) {
    loop = ramp(*evidence.hand_gives, 0.15, -0.1);
    shown.hand = 1.0 - *loop;
    // Somebody must give it: where both take, a sign is wrong.
    if (*evidence.hand_gives < 0.0 && evidence.actuator_gives.value_or(0.0) < -0.2) shown.hand = loop = untested;
  } else if (evidence.actuator_gives) {
    const double in_contact = shown.contact.value_or(untested);
    loop = ramp(*evidence.actuator_gives, 0.35 * in_contact, 0.15 + 0.55 * in_contact);
    // A limit cycle keeps its size, a tremor wanders: this counts where the force is in line by half or less.
    const double wanders = ramp(evidence.wander, 0.25, 0.45) * ramp(*evidence.actuator_gives, 0.8, 0.5);
    shown.hand = std::max(1.0 - *loop, wanders);
  }
  // A force whose law is known, that is late by it and that gives energy in a motion of steady size sustains it. A
  // contact that is felt late gives some energy to any motion, so more is asked of it.
  if (!evidence.hand_gives && evidence.actuator_gives) {
    const double gives = *evidence.actuator_gives;
    const double by_position = std::min(
        std::max(shown.own_wall.value_or(0.0), std::min(shown.delayed.value_or(0.0), shown.coupled.value_or(1.0))),
        ramp(gives, 0.0, 0.06));
    const double by_contact = std::min(
        {shown.contact.value_or(0.0), ramp(evidence.tip_explains, 0.7, 0.9).value_or(0.0), ramp(gives, 0.1, 0.3)});
    const double sustains = std::min(std::max(by_position, by_contact), ramp(evidence.wander, 0.3, 0.12));
    loop = std::max(loop.value_or(0.0), sustains);
    shown.hand = std::min(shown.hand.value_or(1.0), 1.0 - sustains);
  }
  if (loop || beyond_a_hand > 0.0) shown.actuator = std::max(loop.value_or(untested), beyond_a_hand);
  return shown;
}

std::vector<Scored> scores(const Shown& s) {
  using enum Role;
  const auto both = opposite(s.slave_alone);
  const auto many_slave_steps = opposite(s.few_slave_steps), moves = opposite(s.standstill);
  // A follower that touches something is no contradiction where the coupling explains the force and the contact does
  // not.
  const auto not_by_contact =
      s.contact ? std::optional(std::max(1.0 - *s.contact, s.coupled.value_or(0.0))) : std::nullopt;
  std::vector<Scored> all;
  all.push_back(Scored{Mechanism::induced_motion}
                    .must(both, {master_position, slave_position})
                    .must(s.actuator, {displayed_force})
                    .must(s.contact, {tip_force})
                    .must(s.passive_contact.value_or(1.0))
                    .must(1.0 - s.coupled.value_or(0.0))
                    .must(1.0 - s.own_wall.value_or(0.0))
                    .must(opposite(s.few_master_steps), {master_position})
                    .must(s.steady));
  all.push_back(Scored{Mechanism::slave_servo}
                    .must(s.slave_alone, {master_position, slave_position})
                    .must(s.leads_itself, {master_position, slave_position})
                    .must(many_slave_steps, {slave_position})
                    .must(moves, {slave_position})
                    .must(s.steady));
  all.push_back(Scored{Mechanism::delay}
                    .must(both, {master_position, slave_position})
                    .must(s.slave_part, {master_position, slave_position})
                    .must(s.actuator, {displayed_force})
                    .must(not_by_contact, {tip_force})
                    .must(s.delayed, {slave_force, displayed_force})
                    .must(opposite(s.few_master_steps), {master_position})
                    .must(s.steady));
  // At the slave alone, or at a master whose actuator keeps it going.
  const auto at_master = s.master_to_and_fro && both && s.actuator
                             ? std::optional(std::min({*s.master_to_and_fro, *both, *s.actuator}))
                             : std::nullopt;
  const auto at_slave = s.slave_to_and_fro && s.slave_alone
                            ? std::optional(std::min({*s.slave_to_and_fro, *s.slave_alone, *s.leads_itself}))
                            : std::nullopt;
  all.push_back(Scored{Mechanism::quantisation}.must(
      at_master || at_slave ? std::optional(std::max(at_master.value_or(0.0), at_slave.value_or(0.0))) : std::nullopt,
      {master_position, slave_position}));
  all.push_back(Scored{Mechanism::stick_slip}
                    .must(s.slave_alone, {master_position, slave_position})
                    .must(s.leads_itself, {master_position, slave_position})
                    .must(many_slave_steps, {slave_position})
                    .must(s.standstill, {slave_position})
                    .must(s.slow_enough_to_stick));
  all.push_back(Scored{Mechanism::tremor}
                    .must(both, {master_position, slave_position})
                    .must(s.hand, {hand_force, displayed_force})
                    .must(s.line_of_master, {master_position})
                    .must(s.size_of_tremor, {master_position})
                    .must(s.tremor_band));
  // One device is enough: a follower need not be recorded, and the contact is the controller's own.
  all.push_back(Scored{Mechanism::virtual_wall}
                    .must(both.value_or(1.0))
                    .must(s.own_wall, {displayed_force})
                    .must(s.drives, {displayed_force})
                    .must(1.0 - s.contact.value_or(0.0))
                    .must(opposite(s.few_master_steps), {master_position})
                    .must(s.steady));
  std::stable_sort(all.begin(), all.end(), [](const Scored& a, const Scored& b) { return a.score > b.score; });
  return all;
}

/// Does the hand lead, on purpose, and the slave follow? Where a force tells who gives the energy, it decides instead.
/// Two devices that shake each other over a delay come half a turn after one another; a follower comes soon after.
bool is_led(const Signals& signals, const Oscillation& oscillation, const Evidence& evidence) {
  constexpr double latest_rad = std::numbers::pi / 3.0, alike_from = 0.5, alike_to = 2.0, surely = 0.9;
  const bool forces_tell = signals.find(Role::hand_force) != nullptr || signals.find(Role::displayed_force) != nullptr;
  return !forces_tell && oscillation.frequency_Hz < deliberate_below_Hz && evidence.follows.value_or(0.0) > surely &&
         evidence.master_part && *evidence.master_part > alike_from && *evidence.master_part < alike_to &&
         evidence.slave_behind_rad && *evidence.slave_behind_rad > 0.0 && *evidence.slave_behind_rad < latest_rad;
}

/// Noise of a force sensor has lines for a while, in which nothing moves; and a slow motion through counts has a line
/// at its speed over the count. Neither goes to and fro.
bool moves_nothing(const Oscillation& oscillation, const Evidence& evidence) {
  constexpr double some_line = 0.1, unsteady = 0.25, some_turns = 0.25, few_steps = 4.0, long_enough = 60.0;
  const bool in_a_position =
      oscillation.signal == words_of(Role::master_position) || oscillation.signal == words_of(Role::slave_position);
  const bool follows_error = oscillation.signal == "following error";
  if (!in_a_position && !follows_error) {
    return evidence.line_of_motion < some_line && (evidence.wander > unsteady || oscillation.cycles() < long_enough);
  }
  const auto ramps = [&](const std::optional<double>& steps, const std::optional<double>& turns) {
    return !steps || (*steps < few_steps && turns.value_or(0.0) < some_turns);
  };
  const bool master = ramps(evidence.master_steps, evidence.master_turns);
  const bool slave = ramps(evidence.slave_steps, evidence.slave_turns);
  if (follows_error) return master && slave;
  return oscillation.signal == words_of(Role::master_position) ? master : slave;
}

}  // namespace

Decision decide(const Signals& signals, const Oscillation& oscillation, const Evidence& evidence) {
  const Shown shown = shown_by(signals, oscillation, evidence);
  const std::vector<Scored> all = scores(shown);
  Decision decision;
  decision.evidence = sentences_of(signals, oscillation, evidence);
  const Scored &best = all[0], &second = all[1];
  if (best.score >= least_score && best.score - second.score >= least_lead) {
    decision.mechanism = best.mechanism;
    decision.confidence = best.score * (1.0 - second.score);
  } else {
    for (const Scored& one : all) {
      if (one.score < std::min(untested, best.score - least_lead)) continue;
      decision.possible.push_back(one.mechanism);
      for (const Role role : one.missing) {
        if (signals.find(role) == nullptr &&
            std::find(decision.missing.begin(), decision.missing.end(), role) == decision.missing.end()) {
          decision.missing.push_back(role);
        }
      }
    }
    decision.confidence = 0.0;
  }
  // The master is moved by the hand, on purpose or within what every hand does; or somebody leads the slave.
  const bool by_hand = (shown.hand.value_or(0.0) > untested || shown.passive_contact.value_or(1.0) < untested) &&
                       shown.slave_alone.value_or(0.0) < untested;
  const std::optional<double>& motion = evidence.of(Role::master_position);
  const double usual = signals.rotary ? usual_tremor_rad : usual_tremor_m;
  const bool small = motion.value_or(0.0) < usual && evidence.of(Role::slave_position).value_or(0.0) < usual;
  const bool may_be_tremor = decision.mechanism == Mechanism::tremor || decision.mechanism == Mechanism::unknown;
  // A loop that shakes goes on where the person holds still, but for a contact that is left and for what must move to
  // stick and slip. What ends with the person's motion was a ringing after each reach.
  const bool ends_with_motion = evidence.motion_after && *evidence.motion_after < ends_below;
  const bool needs_motion = shown.contact.value_or(untested) >= untested || decision.mechanism == Mechanism::stick_slip;
  decision.led = is_led(signals, oscillation, evidence);
  decision.harmless = decision.led || moves_nothing(oscillation, evidence) || (ends_with_motion && !needs_motion) ||
                      (by_hand && (oscillation.frequency_Hz < deliberate_below_Hz || motion.value_or(0.0) < usual)) ||
                      (may_be_tremor && small && shown.tremor_band > 0.0);
  return decision;
}

}  // namespace tactus::diagnosis
