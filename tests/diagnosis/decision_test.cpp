// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/diagnosis/decision.hpp>

#include <algorithm>

#include <gtest/gtest.h>

namespace tactus::diagnosis {
namespace {

Oscillation line(double frequency_Hz) {
  return {.frequency_Hz = frequency_Hz, .from_s = 1.0, .to_s = 8.0, .share = 0.9, .signal = "slave position"};
}

/// Everything was recorded.
Signals everything() {
  Signals signals{.channels = {}, .sample_time = Seconds{1e-3}, .samples = 8000, .rotary = false};
  for (auto& channel : signals.channels) channel = Channel{.name = "x", .values = {}, .step = 1e-5};
  return signals;
}

/// Both sites move in contact, and the displayed force drives the master.
Evidence in_contact() {
  Evidence evidence;
  evidence.amplitude = {1e-3, 5e-4, 1.0, 0.5, 0.3, 0.5};
  evidence.master_part = 2.0;
  evidence.follows = 1.0;
  evidence.master_steps = 200.0;
  evidence.slave_steps = 100.0;
  evidence.standstill = 0.1;
  evidence.actuator_gives = 0.95;
  evidence.contact = 0.9;
  evidence.master_line = 0.9;
  return evidence;
}

Evidence slave_alone() {
  Evidence evidence = in_contact();
  evidence.amplitude = {1e-6, 5e-4, 0.0, 0.0, 0.0, 0.5};
  evidence.master_part = 0.002;
  evidence.follows = 0.0;
  evidence.actuator_gives = 0.0;
  evidence.contact = 0.0;
  return evidence;
}

Mechanism named(const Evidence& evidence, double frequency_Hz) {
  return decide(everything(), line(frequency_Hz), evidence).mechanism;
}

TEST(Decide, AHandThatLeadsSlowlyWithAFollowerSoonBehindIsNoFaultWherePositionsAloneTell) {
  Signals positions{.channels = {}, .sample_time = Seconds{5e-3}, .samples = 2000, .rotary = true};
  for (const Role role : {Role::master_position, Role::slave_position}) {
    positions.channels[static_cast<std::size_t>(role)] = Channel{.name = "q", .values = {}, .step = 1e-5};
  }
  Evidence led;
  led.amplitude = {0.4, 0.39, {}, {}, {}, {}};
  led.master_part = 1.03;
  led.follows = 0.99;
  led.slave_behind_rad = 0.3;
  led.master_steps = led.slave_steps = 1000.0;
  EXPECT_TRUE(decide(positions, line(1.0), led).led);
  EXPECT_TRUE(decide(positions, line(1.0), led).harmless);
  EXPECT_FALSE(decide(positions, line(6.0), led).led) << "no hand does this on purpose";
  Evidence other = led;
  other.slave_behind_rad = 3.0;
  EXPECT_FALSE(decide(positions, line(1.0), other).led) << "half a turn behind, as over a delay";
  other.slave_behind_rad = -0.3;
  EXPECT_FALSE(decide(positions, line(1.0), other).led) << "the slave leads";
  other = led;
  other.master_part = 0.1;
  EXPECT_FALSE(decide(positions, line(1.0), other).led) << "the slave moves by itself";
  EXPECT_FALSE(decide(everything(), line(1.0), led).led) << "forces tell";
}

TEST(Decide, NamesEachMechanismByWhatItMustShow) {
  EXPECT_EQ(named(in_contact(), 80.0), Mechanism::induced_motion);
  EXPECT_EQ(named(slave_alone(), 25.0), Mechanism::slave_servo);

  Evidence counts = slave_alone();
  counts.slave_steps = 1.0;
  counts.slave_turns = 1.0;
  EXPECT_EQ(named(counts, 90.0), Mechanism::quantisation);

  Evidence sticks = slave_alone();
  sticks.standstill = 0.7;
  EXPECT_EQ(named(sticks, 3.0), Mechanism::stick_slip);

  Evidence free = in_contact();
  free.contact = 0.0;
  free.delay_there_s = free.delay_back_s = 0.04;
  EXPECT_EQ(named(free, 6.0), Mechanism::delay);

  Evidence hand = in_contact();
  hand.contact = 0.0;
  hand.actuator_gives = -0.3;
  hand.wander = 0.4;
  EXPECT_EQ(named(hand, 8.0), Mechanism::tremor);
}

TEST(Decide, QuantisationGoesToAndFroByHalfACountOrMore) {
  Evidence counts = slave_alone();
  counts.slave_steps = 1.0;
  counts.slave_turns = 1.0;
  EXPECT_EQ(named(counts, 24.0), Mechanism::quantisation);
  counts.slave_turns = 0.0;  // a slow motion through counts has a line at its speed over the count
  EXPECT_NE(named(counts, 24.0), Mechanism::quantisation);
  EXPECT_TRUE(decide(everything(), line(24.0), counts).harmless);
  counts.slave_turns = 1.0;
  counts.slave_steps = 0.0;
  EXPECT_NE(named(counts, 24.0), Mechanism::quantisation);
}

TEST(Decide, ATremorIsNoLargerThanAHandCanShake) {
  Evidence hand = in_contact();
  hand.contact = 0.0;
  hand.actuator_gives = -0.3;
  hand.wander = 0.4;
  EXPECT_EQ(named(hand, 8.0), Mechanism::tremor);
  hand.amplitude[0] = 0.023;  // 58 m/s2 at 8 Hz
  EXPECT_NE(named(hand, 8.0), Mechanism::tremor);
}

TEST(Decide, WhatExplainsTheForceOutranksWhatFitsTheBand) {
  Evidence evidence = in_contact();
  evidence.contact = 0.2;
  evidence.actuator_gives = 0.19;
  evidence.wander = 0.01;
  evidence.delay_there_s = evidence.delay_back_s = 0.042;
  evidence.coupling_explains = 0.99;
  evidence.tip_explains = 0.6;
  EXPECT_EQ(named(evidence, 9.4), Mechanism::delay);
  // The same where the tip force explains it: the slave is in contact, and that force comes back.
  evidence.contact = 0.9;
  evidence.actuator_gives = 0.35;
  evidence.coupling_explains = 0.7;
  evidence.tip_explains = 0.99;
  EXPECT_EQ(named(evidence, 9.4), Mechanism::induced_motion);
}

TEST(Decide, AVirtualWallNeedsNoSlaveAndNoContact) {
  Signals signals{.channels = {}, .sample_time = Seconds{1e-3}, .samples = 8000, .rotary = false};
  signals.channels[0] = signals.channels[2] = Channel{.name = "x", .values = {}, .step = 1e-5};
  Evidence wall;
  wall.amplitude = {1.3e-3, {}, 2.5, {}, {}, {}};
  wall.master_steps = 50.0;
  wall.actuator_gives = 0.35;
  wall.own_wall = OwnWall{.explained = 0.99, .delay_s = 5e-3, .held_s = 0.01, .switched = false};
  EXPECT_EQ(decide(signals, line(14.0), wall).mechanism, Mechanism::virtual_wall);
  wall.own_wall->explained = 0.8;
  EXPECT_EQ(decide(signals, line(14.0), wall).mechanism, Mechanism::unknown);
  // A recorded tip force that explains the force as well makes it that of a contact.
  Evidence contact = in_contact();
  contact.own_wall = OwnWall{.explained = 0.99, .delay_s = 5e-3, .held_s = 0.01, .switched = false};
  contact.tip_explains = 0.99;
  EXPECT_EQ(named(contact, 80.0), Mechanism::induced_motion);
}

TEST(Decide, WhatTheTipMovesIsNoContactThatShakes) {
  Evidence evidence = in_contact();
  EXPECT_EQ(named(evidence, 20.0), Mechanism::induced_motion);
  evidence.tip_gives = 0.8;
  EXPECT_EQ(named(evidence, 20.0), Mechanism::unknown);
}

TEST(Decide, NoiseInWhichNothingMovesIsHarmless) {
  Evidence noise = in_contact();
  noise.line_of_motion = 0.003;
  noise.wander = 0.4;
  Oscillation in_force = line(24.0);
  in_force.signal = "tip force";
  EXPECT_TRUE(decide(everything(), in_force, noise).harmless);
  noise.line_of_motion = 0.5;
  EXPECT_FALSE(decide(everything(), in_force, noise).harmless);
}

TEST(Decide, AHandThatTakesEnergyHasNoTremorAndOneThatGivesItHas) {
  Evidence evidence = in_contact();
  evidence.actuator_gives = 0.5;
  evidence.hand_gives = -0.9;
  EXPECT_EQ(named(evidence, 8.0), Mechanism::induced_motion);
  evidence.hand_gives = 0.9;
  EXPECT_EQ(named(evidence, 8.0), Mechanism::tremor);
}

TEST(Decide, ATremorStandsOutOfTheMastersOwnMotion) {
  Evidence evidence = in_contact();
  evidence.hand_gives = 0.8;
  evidence.actuator_gives = -0.5;
  EXPECT_EQ(named(evidence, 8.0), Mechanism::tremor);
  evidence.master_line = 0.03;  // somebody moves about while the slave sticks
  EXPECT_NE(named(evidence, 8.0), Mechanism::tremor);
}

TEST(Decide, WhatEndsWithThePersonsMotionIsARingingAndNoOscillation) {
  Evidence evidence = in_contact();
  evidence.contact = 0.0;
  evidence.delay_there_s = evidence.delay_back_s = 0.03;
  EXPECT_EQ(named(evidence, 9.0), Mechanism::delay);
  EXPECT_FALSE(decide(everything(), line(9.0), evidence).harmless);
  evidence.motion_after = 0.8;  // it ended, and the person moves on
  EXPECT_FALSE(decide(everything(), line(9.0), evidence).harmless);
  evidence.motion_after = 0.1;
  EXPECT_TRUE(decide(everything(), line(9.0), evidence).harmless);
  // A contact that is left ends what it made.
  Evidence left = in_contact();
  left.motion_after = 0.1;
  EXPECT_FALSE(decide(everything(), line(80.0), left).harmless);
}

TEST(Decide, WhereHandAndActuatorBothTakeEnergyNoneIsNamed) {
  Evidence evidence = in_contact();
  evidence.actuator_gives = -0.5;
  evidence.hand_gives = -0.9;
  EXPECT_EQ(named(evidence, 8.0), Mechanism::unknown);
}

TEST(Decide, WhatTwoExplainAlikeIsUnknownAndTheMissingSignalIsNamed) {
  Evidence evidence = in_contact();
  evidence.contact.reset();
  evidence.delay_there_s = evidence.delay_back_s = 0.04;
  Signals signals = everything();
  signals.channels[static_cast<std::size_t>(Role::tip_force)].reset();
  const Decision decision = decide(signals, line(8.0), evidence);
  EXPECT_EQ(decision.mechanism, Mechanism::unknown);
  EXPECT_EQ(decision.missing, std::vector<Role>{Role::tip_force});
  for (const Mechanism mechanism : {Mechanism::induced_motion, Mechanism::delay}) {
    EXPECT_NE(std::find(decision.possible.begin(), decision.possible.end(), mechanism), decision.possible.end());
  }
}

TEST(Decide, AMasterThatOnlyItsPositionTellsOfNamesNothing) {
  Signals signals{.channels = {}, .sample_time = Seconds{1e-3}, .samples = 8000, .rotary = false};
  signals.channels[0] = Channel{.name = "x", .values = {}, .step = 1e-5};
  Evidence evidence;
  evidence.amplitude[0] = 1e-3;
  evidence.master_steps = 200.0;
  const Decision decision = decide(signals, line(80.0), evidence);
  EXPECT_EQ(decision.mechanism, Mechanism::unknown);
  EXPECT_FALSE(decision.missing.empty());
  EXPECT_EQ(decision.confidence, 0.0);
}

TEST(Decide, WhatAHandMeansAndWhatEveryHandHasIsHarmless) {
  Evidence hand = in_contact();
  hand.contact = 0.0;
  hand.actuator_gives = 0.0;
  hand.wander = 0.4;
  EXPECT_TRUE(decide(everything(), line(1.8), hand).harmless);
  EXPECT_FALSE(decide(everything(), line(8.0), hand).harmless);
  hand.amplitude = {5e-5, 5e-5, 0.0, 0.0, 0.0, 0.0};
  EXPECT_TRUE(decide(everything(), line(8.0), hand).harmless);
}

}  // namespace
}  // namespace tactus::diagnosis
