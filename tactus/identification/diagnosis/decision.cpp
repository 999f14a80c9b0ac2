// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>
#include <tactus/identification/diagnosis/decision.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace tactus::diagnosis {

namespace {

constexpr double untested = 0.5;
constexpr double least_score = 0.55;  ///< more than untested
constexpr double least_lead = 0.25;
constexpr double usual_tremor_m = 1.5e-4, usual_tremor_rad = 3e-3;
constexpr double deliberate_below_Hz = 3.0;
constexpr double ends_below = 0.3;  ///< of the speed of the person's slower motion

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
  std::optional<double> slave_alone, slave_part, leads_itself, few_slave_steps, few_master_steps, standstill, contact,
      delayed, hand, actuator, line_of_master;
  double steady, tremor_band, slow_enough_to_stick;
};

Shown shown_by(const Oscillation& oscillation, const Evidence& evidence) {
  const double f_Hz = oscillation.frequency_Hz;
  Shown shown{.slave_alone = ramp(evidence.master_part, 0.35, 0.12),
              .slave_part = ramp(evidence.master_part, 10.0, 4.0),
              .leads_itself = ramp(evidence.follows, 0.9, 0.6),
              .few_slave_steps = ramp(evidence.slave_steps, 5.0, 3.0),
              .few_master_steps = ramp(evidence.master_steps, 5.0, 3.0),
              .standstill = ramp(evidence.standstill, 0.25, 0.45),
              .contact = ramp(evidence.contact, 0.1, 0.3),
              .delayed = {},
              .hand = {},
              .actuator = {},
              .line_of_master = ramp(evidence.master_line, 0.15, 0.35),
              .steady = std::max(ramp(evidence.wander, 0.45, 0.25), ramp(f_Hz, 14.0, 20.0)),
              .tremor_band = std::min(ramp(f_Hz, 2.5, 3.5), ramp(f_Hz, 16.0, 13.0)),
              .slow_enough_to_stick = ramp(f_Hz, 40.0, 25.0)};
  if (evidence.delay_there_s || evidence.delay_back_s) {
    const double round_trip_s = evidence.delay_there_s.value_or(0.0) + evidence.delay_back_s.value_or(0.0);
    shown.delayed = ramp(2.0 * std::numbers::pi * f_Hz * round_trip_s, 0.3, 0.8);
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
  if (loop || beyond_a_hand > 0.0) shown.actuator = std::max(loop.value_or(untested), beyond_a_hand);
  return shown;
}

std::vector<Scored> scores(const Shown& s) {
  using enum Role;
  const auto both = opposite(s.slave_alone);
  const auto many_slave_steps = opposite(s.few_slave_steps), moves = opposite(s.standstill);
  std::vector<Scored> all;
  all.push_back(Scored{Mechanism::induced_motion}
                    .must(both, {master_position, slave_position})
                    .must(s.actuator, {displayed_force})
                    .must(s.contact, {tip_force})
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
                    .must(opposite(s.contact), {tip_force})
                    .must(s.delayed, {slave_force, displayed_force})
                    .must(opposite(s.few_master_steps), {master_position})
                    .must(s.steady));
  // At the slave alone, or at a master whose actuator keeps it going.
  const auto at_master = s.few_master_steps && both && s.actuator
                             ? std::optional(std::min({*s.few_master_steps, *both, *s.actuator}))
                             : std::nullopt;
  const auto at_slave = s.few_slave_steps && s.slave_alone
                            ? std::optional(std::min({*s.few_slave_steps, *s.slave_alone, *s.leads_itself}))
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
                    .must(s.tremor_band));
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

std::string text(double value, int digits = 2) { return report::number(value, digits); }

std::vector<std::string> sentences(const Signals& signals, const Oscillation& oscillation, const Evidence& evidence) {
  std::vector<std::string> told;
  const std::string length = signals.rotary ? " mrad" : " mm", force = signals.rotary ? " N m" : " N";
  std::string sizes;
  for (const Role role : all_roles) {
    const auto& amplitude = evidence.of(role);
    if (!amplitude) continue;
    sizes += (sizes.empty() ? "" : ", ") + std::string(words_of(role)) + " " +
             (is_position(role) ? text(1e3 * *amplitude) + length : text(*amplitude) + force);
  }
  told.push_back("amplitudes at " + text(oscillation.frequency_Hz, 3) + " Hz: " + sizes);
  if (evidence.master_part) {
    told.push_back("the master moves " + text(*evidence.master_part) + " times as far as the slave (scaled): " +
                   (*evidence.master_part < 0.2   ? "the slave shakes by itself"
                    : *evidence.master_part < 0.3 ? "unclear whether it takes part"
                                                  : "it takes part"));
  }
  if (evidence.actuator_gives) {
    told.push_back("the displayed force is in line with the master's velocity by " + text(*evidence.actuator_gives) +
                   (*evidence.actuator_gives > 0.2 ? ": it drives the master" : ": it does not drive the master"));
  }
  if (evidence.hand_gives) {
    told.push_back("the hand's force is in line with the master's velocity by " + text(*evidence.hand_gives) +
                   (*evidence.hand_gives > 0.05 ? ": the hand gives energy" : ": the hand takes energy"));
  }
  if (evidence.contact) {
    told.push_back(*evidence.contact > 0.2
                       ? "the tip force takes part (" + text(*evidence.contact) +
                             " of the motor's force): the slave is in contact"
                       : "the tip force does not take part (" + text(*evidence.contact) + " of the motor's force)");
  }
  if (evidence.delay_there_s || evidence.delay_back_s) {
    std::string delays;
    if (evidence.delay_there_s) delays += text(1e3 * *evidence.delay_there_s) + " ms to the slave";
    if (evidence.delay_back_s) {
      delays += (delays.empty() ? "" : ", ") + text(1e3 * *evidence.delay_back_s) + " ms back to the master";
    }
    told.push_back("a coupling by position explains the force with a delay of " + delays);
  }
  if (evidence.slave_steps) {
    told.push_back(
        "the slave moves " + text(*evidence.slave_steps) + " counts peak to peak" +
        (evidence.standstill ? " and is at rest " + text(100.0 * *evidence.standstill) + " % of the time" : ""));
  }
  if (evidence.master_steps && *evidence.master_steps < 6.0) {
    told.push_back("the master moves " + text(*evidence.master_steps) + " counts peak to peak");
  }
  if (evidence.master_line) {
    told.push_back("of the master's motion above half of the frequency " + text(100.0 * *evidence.master_line) +
                   " % is in this line");
  }
  if (evidence.motion_after) {
    told.push_back("after it the master's slower motion is " + text(*evidence.motion_after) + " times what it was");
  }
  told.push_back("its size wanders by " + text(100.0 * evidence.wander) + " %");
  return told;
}

}  // namespace

std::string_view word_of(Mechanism mechanism) {
  return enumerators(Mechanism{})[static_cast<std::size_t>(mechanism)].name;
}

std::string_view words_of(Mechanism mechanism) {
  constexpr std::array<std::string_view, 7> words{"induced master motion",
                                                  "the slave's own servo",
                                                  "delay between devices that are coupled by position",
                                                  "quantisation",
                                                  "stick and slip",
                                                  "the hand's tremor",
                                                  "cannot be determined from these signals"};
  return words[static_cast<std::size_t>(mechanism)];
}

std::string_view remedy_of(Mechanism mechanism) {
  constexpr std::array<std::string_view, 7> remedies{
      "cancel the induced motion with a model of the master (control.cancellation), or turn the force gain down; "
      "damping "
      "at the master and a firmer grip help less",
      "turn the slave's stiffness down, or add damping and shorten the delay from its encoder to its motor",
      "turn the coupling's stiffness down or add damping at both sites; over a long delay use wave variables or "
      "passivity "
      "control",
      "use a finer encoder, or less stiffness and derivative gain and a lower cutoff of the velocity: the force of one "
      "count should stay below friction",
      "take integral action out or bound it, compensate friction, or stiffen the servo with damping",
      "no gain of the loop makes it: scale the motion down, or filter the command about this frequency",
      "record what is missing, then ask again"};
  return remedies[static_cast<std::size_t>(mechanism)];
}

Decision decide(const Signals& signals, const Oscillation& oscillation, const Evidence& evidence) {
  const Shown shown = shown_by(oscillation, evidence);
  const std::vector<Scored> all = scores(shown);
  Decision decision;
  decision.evidence = sentences(signals, oscillation, evidence);
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
  // The master is moved by the hand, on purpose or within what every hand does.
  const bool by_hand = shown.hand.value_or(0.0) > untested && shown.slave_alone.value_or(0.0) < untested;
  const std::optional<double>& motion = evidence.of(Role::master_position);
  const double usual = signals.rotary ? usual_tremor_rad : usual_tremor_m;
  const bool small = motion.value_or(0.0) < usual && evidence.of(Role::slave_position).value_or(0.0) < usual;
  const bool may_be_tremor = decision.mechanism == Mechanism::tremor || decision.mechanism == Mechanism::unknown;
  // A loop that shakes goes on where the person holds still, but for a contact that is left and for what must move to
  // stick and slip. What ends with the person's motion was a ringing after each reach.
  const bool ends_with_motion = evidence.motion_after && *evidence.motion_after < ends_below;
  const bool needs_motion = shown.contact.value_or(untested) >= untested || decision.mechanism == Mechanism::stick_slip;
  decision.led = is_led(signals, oscillation, evidence);
  decision.harmless = decision.led || (ends_with_motion && !needs_motion) ||
                      (by_hand && (oscillation.frequency_Hz < deliberate_below_Hz || motion.value_or(0.0) < usual)) ||
                      (may_be_tremor && small && shown.tremor_band > 0.0);
  return decision;
}

}  // namespace tactus::diagnosis
