// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>
#include <tactus/identification/diagnosis/wording.hpp>

#include <array>

namespace tactus::diagnosis {

namespace {

std::string text(double value, int digits = 2) { return report::number(value, digits); }

}  // namespace

std::string_view word_of(Mechanism mechanism) {
  return enumerators(Mechanism{})[static_cast<std::size_t>(mechanism)].name;
}

std::string_view words_of(Mechanism mechanism) {
  constexpr std::array<std::string_view, 8> words{"induced master motion",
                                                  "the slave's own servo",
                                                  "delay between devices that are coupled by position",
                                                  "quantisation",
                                                  "stick and slip",
                                                  "the hand's tremor",
                                                  "a virtual wall at the master, too stiff for its rate",
                                                  "cannot be determined from these signals"};
  return words[static_cast<std::size_t>(mechanism)];
}

std::string_view remedy_of(Mechanism mechanism) {
  constexpr std::array<std::string_view, 8> remedies{
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
      "make the wall less stiff, compute it at a higher rate, replace a force that is switched by a spring, or add "
      "damping at the master",
      "record what is missing, then ask again"};
  return remedies[static_cast<std::size_t>(mechanism)];
}

std::vector<std::string> sentences_of(const Signals& signals, const Oscillation& oscillation,
                                      const Evidence& evidence) {
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
                   (*evidence.actuator_gives > 0.1 ? ": it drives the master" : ": it does not drive the master"));
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
  if (evidence.tip_gives && *evidence.tip_gives > 0.3) {
    told.push_back("the tip force is in line with the slave's velocity by " + text(*evidence.tip_gives) +
                   ": whatever is at the tip moves the slave, as no contact at rest does, or its sign is wrong");
  }
  if (evidence.own_wall && evidence.own_wall->explained > (evidence.own_wall->switched ? 0.5 : 0.9)) {
    const OwnWall& wall = *evidence.own_wall;
    told.push_back("the master's own position " + text(1e3 * wall.delay_s) + " ms before explains " +
                   text(100.0 * wall.explained) + " % of the displayed force, as that of a virtual wall" +
                   (wall.switched       ? ", which is switched"
                    : wall.held_s > 0.0 ? ", which is held for " + text(1e3 * wall.held_s) + " ms at a time"
                                        : ""));
  }
  if (evidence.coupling_explains && evidence.tip_explains && evidence.delay_back_s) {
    told.push_back("of the displayed force the coupling by position explains " +
                   text(100.0 * *evidence.coupling_explains) + " %, the tip force " +
                   text(100.0 * *evidence.tip_explains) + " %");
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

}  // namespace tactus::diagnosis
