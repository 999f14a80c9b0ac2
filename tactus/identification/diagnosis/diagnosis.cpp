// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>
#include <tactus/identification/diagnosis/diagnosis.hpp>
#include <tactus/identification/diagnosis/line.hpp>
#include <tactus/identification/diagnosis/loop_gain.hpp>
#include <tactus/identification/diagnosis/motor_power.hpp>

#include <algorithm>
#include <numbers>
#include <span>
#include <utility>

namespace tactus::diagnosis {

namespace {

constexpr double slow_rate_Hz = 400.0;
constexpr double longest_break_s = 3.0;

/// The loop gain from the force of the loop that was found.
std::optional<identification::Estimate> loop_gain_of(const Signals& signals, const Oscillation& oscillation,
                                                     Mechanism mechanism) {
  const bool induced = mechanism == Mechanism::induced_motion;
  if (!induced && mechanism != Mechanism::slave_servo && mechanism != Mechanism::delay) return std::nullopt;
  const Channel* force = signals.find(mechanism == Mechanism::slave_servo ? Role::slave_force : Role::displayed_force);
  if (force == nullptr || force->constant()) return std::nullopt;
  const auto from = static_cast<std::size_t>(oscillation.from_s / signals.sample_time.value);
  const auto to = std::min(static_cast<std::size_t>(oscillation.to_s / signals.sample_time.value), signals.samples);
  return loop_gain(std::span(force->values).subspan(from, to - from), induced);
}

/// What grows may change its frequency: one loop that makes several lines in turn is told once, by the strongest.
bool goes_on(const Finding& strong, const Finding& weak) {
  const double gap_s = std::max(strong.oscillation.from_s, weak.oscillation.from_s) -
                       std::min(strong.oscillation.to_s, weak.oscillation.to_s);
  return strong.decision.mechanism == weak.decision.mechanism && strong.decision.mechanism != Mechanism::unknown &&
         gap_s < longest_break_s;
}

std::string when(const Signals& signals, const Oscillation& oscillation) {
  const double edge_s = 0.02 * signals.duration_s();
  if (oscillation.from_s < edge_s && signals.duration_s() - oscillation.to_s < edge_s) return "all the time";
  return "from " + report::number(oscillation.from_s, 3) + " s to " + report::number(oscillation.to_s, 3) + " s";
}

/// What stands before any oscillation: a range of velocity that is wrong drives two arms that are coupled by it.
std::string wrong_velocities(const Signals& signals) {
  std::string text;
  for (const auto* told : {&signals.master_velocity, &signals.slave_velocity}) {
    if (!*told || !(*told)->wrong()) continue;
    text += "The velocity " + (*told)->name + " is reported as " + report::number((*told)->scale, 2) +
            " times as large as its position moves: correct the range of velocity in the host's table or in the drive "
            "(VMAX) before anything else; where it is asked of another drive, or of this one, it drives the motion "
            "that it should damp. ";
  }
  return text;
}

/// The sign of the follower's motor force, or what is called the follower, is wrong. A spring at the tip shows at 270
/// degrees, less what its force is late by, so nothing within 45 degrees of it is doubted.
std::string doubted_motor(std::optional<double> phase_deg, const std::optional<Following>& following) {
  constexpr double surely_from = 165.0, probably_from = 110.0, until = 225.0;
  const bool leads = following && following->lag_s.upper < 0.0;
  if (!phase_deg || *phase_deg < (leads ? probably_from : surely_from) || *phase_deg > until) return {};
  std::string text =
      "The follower's motor takes energy out of the follower, which moves nevertheless (its force leads the "
      "velocity by " +
      report::number(*phase_deg, 3) +
      "°, where inertia and friction need 0 to 90°): the force has the opposite sign (turn it with "
      "--slave-force-sign -1), or the columns of leader and follower are exchanged";
  if (leads) {
    text += "; that the follower moves " + report::number(-1e3 * following->lag_s.value, 2) +
            " ms before the leader is evidence for the latter";
  }
  return text + ". No mechanism is named before that is corrected. ";
}

/// Within an oscillation a lag cannot be told from one of a period more or less.
bool is_ambiguous(const std::optional<Following>& following, const std::vector<Finding>& findings) {
  return following && std::any_of(findings.begin(), findings.end(), [&](const Finding& finding) {
           const double lag_s = following->lag_s.value;
           return lag_s < 0.0 || lag_s > 0.5 / finding.oscillation.frequency_Hz;
         });
}

/// A hand that leads at one frequency, and the slave that follows it.
std::string how_it_follows(const Finding& finding) {
  const double f_Hz = finding.oscillation.frequency_Hz;
  const double late_s = finding.evidence.slave_behind_rad.value_or(0.0) / (2.0 * std::numbers::pi * f_Hz);
  const double slave = finding.evidence.of(Role::slave_position).value_or(0.0);
  const double master = finding.evidence.of(Role::master_position).value_or(1.0);
  return " At " + report::number(f_Hz, 3) + " Hz the hand moves the master on purpose and the slave follows, " +
         report::number(1e3 * late_s, 2) + " ms later and " + report::number(100.0 * slave / master, 3) +
         " % as far: this is no fault.";
}

std::string verdict_of(const Signals& signals, const std::vector<Finding>& findings) {
  const double highest_Hz = 0.45 / signals.sample_time.value;
  if (findings.empty()) {
    return "No oscillation found below " + report::number(highest_Hz, 2) + " Hz in " +
           report::number(signals.duration_s(), 3) + " s.";
  }
  const Finding& first = findings.front();
  std::string text = "It shakes at " + report::number(first.oscillation.frequency_Hz, 3) + " Hz " +
                     when(signals, first.oscillation) + ": ";
  text += words_of(first.decision.mechanism);
  if (first.decision.mechanism == Mechanism::unknown) {
    std::string possible;
    for (const Mechanism mechanism : first.decision.possible) {
      possible += (possible.empty() ? "" : ", ") + std::string(words_of(mechanism));
    }
    text +=
        possible.empty() ? "; it shows nothing that a mechanism known here must show" : "; possible are " + possible;
  } else {
    text += " (confidence " + report::number(first.decision.confidence, 2) + ")";
  }
  text += ". What would help: " + std::string(remedy_of(first.decision.mechanism)) + ".";
  if (first.loop_gain) {
    text += " At this amplitude the loop gain for small motion is " + report::number(first.loop_gain->value, 2) + " (" +
            report::number(first.loop_gain->lower, 2) + " to " + report::number(first.loop_gain->upper, 2) +
            "): turn it down step by step; by as much is nearly always enough.";
  }
  return text;
}

/// A mechanism whose evidence rests on a sign that is in doubt is only possible.
void withdraw(Decision& decision) {
  if (decision.mechanism == Mechanism::unknown) return;
  decision.possible = {decision.mechanism};
  decision.mechanism = Mechanism::unknown;
  decision.confidence = 0.0;
}

std::string_view tells(Role role) {
  switch (role) {
    case Role::master_position:
      return "whether the master takes part or the slave shakes by itself";
    case Role::slave_position:
      return "whether the slave takes part, in how many counts, and whether it sticks";
    case Role::displayed_force:
      return "whether the actuator drives the master or the hand does";
    case Role::tip_force:
      return "whether the contact closes the loop";
    case Role::hand_force:
      return "whether the hand gives energy or takes it";
    case Role::slave_force:
      return "the delay of the link to the slave, and whether its motor is at its limit";
  }
  return {};
}

std::vector<std::string> record_next_of(const Signals& signals, const std::vector<Finding>& findings) {
  std::vector<std::string> next;
  for (const Role role : all_roles) {
    const bool asked = std::any_of(findings.begin(), findings.end(), [role](const Finding& finding) {
      const auto& missing = finding.decision.missing;
      return std::find(missing.begin(), missing.end(), role) != missing.end();
    });
    if (!asked) continue;
    next.push_back("the " + std::string(words_of(role)) + ", which shows " + std::string(tells(role)) +
                   " (if the file has it, name its column with " + option_of(role) + ")");
  }
  const double rate_Hz = 1.0 / signals.sample_time.value;
  if (rate_Hz < slow_rate_Hz) {
    next.push_back("at 1 kHz: " + report::number(rate_Hz, 3) + " samples a second show nothing above " +
                   report::number(0.45 * rate_Hz, 2) + " Hz, and what is faster may look slow");
  }
  const bool unknown = std::any_of(findings.begin(), findings.end(), [](const Finding& finding) {
    return finding.decision.mechanism == Mechanism::unknown;
  });
  if (unknown && next.empty()) {
    next.push_back(
        "the same with the force gain halved, then with the hand off the master: what stays is not made by "
        "the loop that was opened");
  }
  return next;
}

}  // namespace

Diagnosis diagnose(const Signals& signals) {
  Diagnosis diagnosis;
  diagnosis.following = find_following(signals);
  const std::string doubt = doubted_motor(motor_phase_deg(signals), diagnosis.following);
  std::string led;
  for (Oscillation& oscillation : find_oscillations(signals)) {
    Finding finding{.oscillation = std::move(oscillation), .evidence = {}, .decision = {}, .loop_gain = {}};
    finding.evidence = measure(signals, finding.oscillation);
    finding.decision = decide(signals, finding.oscillation, finding.evidence);
    if (finding.decision.led && led.empty()) led = how_it_follows(finding);
    if (finding.decision.harmless) continue;
    if (!doubt.empty()) withdraw(finding.decision);
    const auto told = std::find_if(diagnosis.findings.begin(), diagnosis.findings.end(),
                                   [&](const Finding& before) { return goes_on(before, finding); });
    if (told != diagnosis.findings.end()) {
      told->decision.evidence.push_back("the same loop shows at " +
                                        report::number(finding.oscillation.frequency_Hz, 3) + " Hz from " +
                                        report::number(finding.oscillation.from_s, 3) + " s to " +
                                        report::number(finding.oscillation.to_s, 3) + " s");
      told->oscillation.from_s = std::min(told->oscillation.from_s, finding.oscillation.from_s);
      told->oscillation.to_s = std::max(told->oscillation.to_s, finding.oscillation.to_s);
      continue;
    }
    finding.loop_gain = loop_gain_of(signals, finding.oscillation, finding.decision.mechanism);
    diagnosis.findings.push_back(std::move(finding));
  }
  if (is_ambiguous(diagnosis.following, diagnosis.findings)) diagnosis.following.reset();
  diagnosis.verdict = wrong_velocities(signals) + doubt + verdict_of(signals, diagnosis.findings) + led;
  diagnosis.record_next = record_next_of(signals, diagnosis.findings);
  return diagnosis;
}

}  // namespace tactus::diagnosis
