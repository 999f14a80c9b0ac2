// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/faults/injection.hpp>
#include <tactus/simulation/experiments/faults/table.hpp>
#include <tactus/simulation/experiments/faults/witness.hpp>
#include <tactus/simulation/teleoperator/bad_number.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::experiments {
namespace faults_test {

TEST(Faults, EveryRowSurvivesAndMostOfItsRunsDoNotWithoutWhatDefends) {
  FaultsParams params;
  params.task.seeds = 6;
  params.task.longest_cut_s = 0.3;
  const auto table = run_faults(params, [](double) {});
  ASSERT_TRUE(table) << describe(table.error());
  ASSERT_EQ(table->rows.size(), fault_rows().size());
  for (const FaultTally& tally : table->rows) {
    EXPECT_EQ(tally.tried, 6);
    if (tally.row.monitored) {
      EXPECT_EQ(tally.survived, 6) << tally.row.id << ": "
                                   << (tally.failures.empty() ? "" : tally.failures.front().rule);
      EXPECT_EQ(tally.diverged, 0) << tally.row.id;
    } else {
      EXPECT_EQ(tally.diverged, 6) << tally.row.id;
    }
    EXPECT_EQ(tally.worst.not_finite, 0) << tally.row.id;
    EXPECT_EQ(tally.worst.stale_applied, 0) << tally.row.id;
    EXPECT_EQ(tally.worst.steps_above_rate, 0) << tally.row.id;
  }
  for (const FaultTally& tally : table->controls) {
    EXPECT_TRUE(tally.fails()) << tally.row.id << ": " << tally.survived << " survived without "
                               << tally.row.control.off;
  }
}

TEST(Faults, EveryRowHasAnIdOfItsOwnAndOneRowCanBeAskedFor) {
  std::set<std::string_view> ids;
  for (const FaultRow& row : fault_rows()) {
    EXPECT_TRUE(ids.insert(row.id).second) << row.id << " comes twice";
    EXPECT_EQ(row.id.find_first_not_of("abcdefghijklmnopqrstuvwxyz-"), std::string_view::npos) << row.id;
    ASSERT_EQ(fault_rows(row.id).size(), 1U);
    EXPECT_EQ(fault_rows(row.id).front().name, row.name);
  }
  FaultsParams params;
  params.task.only = "encoder-spikes";
  const auto refused = run_faults(params, [](double) {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().parameter, "task.only");
  EXPECT_NE(refused.error().message.find("encoder-spike,"), std::string::npos) << refused.error().message;
}

TEST(Faults, AMastersDriveThatSticksIsSwitchedOffSoonerWhereTheHandContradictsIt) {
  const FaultsParams params;
  FaultsParams alone = params;
  alone.control.supervision.hand_sensor.residual_limit_N = 200.0;
  alone.control.gate.encoder.frozen_force_N = 200.0;
  int masters = 0;
  for (std::int64_t seed = 0; masters < 10; ++seed) {
    const FaultPlan plan = draw_plan(FaultKind::actuator_stuck, 0, seed, 1.0);
    if (plan.site != FaultSite::master) continue;
    ++masters;
    const FaultOutcome seen = run_fault(params, plan).value(), unseen = run_fault(alone, plan).value();
    EXPECT_GE(seen.detection_ticks, 0) << "seed " << seed;
    EXPECT_TRUE(unseen.detection_ticks < 0 || seen.detection_ticks < unseen.detection_ticks) << "seed " << seed;
    EXPECT_TRUE(seen.active_at_end);
  }
}

TEST(Faults, ComputationDelayAndAChangingGripCount) {
  const FaultsParams params;
  const FaultPlan plan = draw_plan(FaultKind::none, 0, 1, 1.0);
  FaultsParams late = params, light = params;
  late.servo.computation_delay_s = 1e-4;
  light.person.grip_change = {.factor = 0.2, .start_s = 0.3, .duration_s = 0.1};
  const double given_J = run_fault(params, plan).value().given_J;
  EXPECT_NE(run_fault(late, plan).value().given_J, given_J);
  EXPECT_NE(run_fault(light, plan).value().given_J, given_J);
}

TEST(FaultyParts, DoWhatTheyAreCalledWhileTheFaultLastsAndAtTheirSiteOnly) {
  const simulation::FaultSpan span(0.5, 0.8, 0.1);
  const auto actuator = [&](FaultKind kind, double size, double told_N, bool enabled = true) {
    simulation::FaultyActuator made({.kind = kind, .site = FaultSite::slave, .size = size, .impairment = {}},
                                    FaultSite::slave, 0.1);
    EXPECT_EQ(made.step(told_N, true, span.at(4)), told_N) << "not begun";
    const double given_N = made.step(told_N, enabled, span.at(5));
    EXPECT_EQ(made.step(told_N, true, span.at(8)), told_N) << "mended";
    return given_N;
  };
  EXPECT_EQ(actuator(FaultKind::motor_reversed, 0.0, 1.5), -1.5);
  EXPECT_EQ(actuator(FaultKind::torque_constant, 3.0, 1.5), 4.5);
  EXPECT_EQ(actuator(FaultKind::actuator_dead, 0.0, 1.5), 0.0);
  EXPECT_EQ(actuator(FaultKind::actuator_stuck, -2.0, 1.5), -2.0);
  EXPECT_EQ(actuator(FaultKind::actuator_stuck, -2.0, 1.5, false), 0.0) << "the enable line takes its power";
  EXPECT_EQ(actuator(FaultKind::actuator_saturated, 0.2, -1.5), -0.2);
  simulation::FaultyActuator elsewhere({.kind = FaultKind::motor_reversed, .site = FaultSite::slave, .impairment = {}},
                                       FaultSite::master, 0.1);
  EXPECT_EQ(elsewhere.step(1.0, true, span.at(6)), 1.0);

  // Readings at 0.1 s each: at rest at 1 before the fault, then 2, 1, 3.
  const auto encoder = [&](FaultKind kind, double size) {
    simulation::FaultyEncoder made({.kind = kind, .size = size, .impairment = {}}, FaultSite::master, 0.1);
    std::vector<double> read;
    const double at_m[] = {1.0, 1.0, 2.0, 1.0, 3.0};
    for (int i = 0; i < 5; ++i) read.push_back(made.step(at_m[i], span.at(4 + i)));
    return read;
  };
  EXPECT_EQ(encoder(FaultKind::encoder_reversed, 0.0), (std::vector{1.0, 1.0, 0.0, 1.0, 3.0}));
  EXPECT_EQ(encoder(FaultKind::encoder_scale, 0.5), (std::vector{1.0, 1.0, 1.5, 1.0, 3.0}));
  EXPECT_EQ(encoder(FaultKind::encoder_slip, 0.5), (std::vector{1.0, 1.0, 1.5, 0.5, 3.0}));
  EXPECT_EQ(encoder(FaultKind::encoder_drift, 5.0), (std::vector{1.0, 1.5, 3.0, 2.5, 3.0}));

  simulation::FaultyForceSensor late({.kind = FaultKind::force_sensor_late, .size = 0.2, .impairment = {}}, 0.1);
  std::vector<double> read;
  for (int i = 3; i < 9; ++i) read.push_back(late.step(i, span.at(i)));
  EXPECT_EQ(read, (std::vector{3.0, 4.0, 3.0, 4.0, 5.0, 8.0}));
}

/// What its tip force leaves of a slave's motor force betrays a frozen encoder before the slave has gone.
TEST(Faults, ASlaveWhoseEncoderFreezesStaysInItsWorkspaceBecauseItsForcesAreBalanced) {
  const FaultsParams params;
  FaultsParams unbalanced = params;
  unbalanced.control.slave_gate.encoder.unbalanced_force_N = 200.0;
  int lost = 0, lost_unbalanced = 0, slaves = 0;
  for (std::int64_t seed = 0; slaves < 20; ++seed) {
    const FaultPlan plan = draw_plan(FaultKind::encoder_freeze, 0, seed, 1.0);
    if (plan.site != FaultSite::slave) continue;
    ++slaves;
    lost += run_fault(params, plan).value().left_workspace ? 1 : 0;
    lost_unbalanced += run_fault(unbalanced, plan).value().left_workspace ? 1 : 0;
  }
  EXPECT_EQ(lost, 0);
  EXPECT_GT(lost_unbalanced, 0) << "or this shows nothing";
}

TEST(Faults, ARunThatDoesNotSurviveIsNamedWithTheRuleThatItBroke) {
  const FaultsParams params;
  const FaultRow row = fault_rows().front();
  const FaultOutcome good{.active_at_end = true};
  FaultOutcome stale = good, tripped = good, outside = good;
  stale.stale_applied = 1;
  tripped.detection_ticks = 40;
  outside.left_workspace = true;
  EXPECT_EQ(broken_rule(row, {.impairment = {}}, good, params), "");
  std::vector<FaultPlan> plans(4);
  for (std::int64_t i = 0; i < 4; ++i) plans[static_cast<std::size_t>(i)].choice = i;
  const FaultTally sum = tally(row, params, plans, {good, stale, tripped, outside});
  EXPECT_EQ(sum.survived, 1);
  ASSERT_EQ(sum.failures.size(), 3U);
  EXPECT_EQ(sum.failures[0].number, 1);
  EXPECT_EQ(sum.failures[0].rule, "a stale packet was applied");
  EXPECT_EQ(sum.failures[1].rule, "tripped on clean data");
  EXPECT_EQ(sum.failures[2].rule, "a device left its workspace");
}

TEST(Faults, OfManyFailuresTheFirstAreListedAndAllAreCounted) {
  const FaultRow row = fault_rows().front();
  FaultTallier tallier(row, 0.25);
  const FaultPlan plan{.impairment = {}};
  for (std::int64_t i = 0; i < 5000; ++i) {
    FaultPlan numbered = plan;
    numbered.choice = i;
    tallier.add(numbered, {}, i % 2 == 0 ? "stayed" : "fell");
  }
  const FaultTally sum = std::move(tallier).finish();
  EXPECT_EQ(sum.tried, 5000);
  EXPECT_EQ(sum.survived, 0);
  ASSERT_EQ(sum.failures.size(), 1000U);
  EXPECT_EQ(sum.failures.back().number, 999);
  ASSERT_EQ(sum.broken.size(), 2U);
  EXPECT_EQ(sum.broken[0].rule, "fell");
  EXPECT_EQ(sum.broken[0].count, 2500);
  EXPECT_EQ(sum.broken[0].first, 1);
  EXPECT_EQ(sum.broken[1].rule, "stayed");
  EXPECT_EQ(sum.broken[1].first, 0);
}

/// However many runs there are, memory is that of a stretch of them.
TEST(Faults, RunsAreMadeReadyInStretchesAndAddedUpInOrder) {
  constexpr std::size_t count = 2 * most_runs_at_once + 7;
  std::vector<std::size_t> numbers, results, taken;
  std::size_t largest = 0;
  double last = 0.0;
  run_in_stretches(
      count,
      [&](std::size_t first, std::size_t size) {
        largest = std::max(largest, size);
        numbers.resize(size);
        results.assign(size, 0);
        for (std::size_t place = 0; place < size; ++place) numbers[place] = first + place;
      },
      [&](std::size_t place) { results[place] = 3 * numbers[place]; },
      [&](std::size_t place) { taken.push_back(results[place]); },
      [&](double share) {
        EXPECT_GE(share, last);
        last = share;
      });
  EXPECT_EQ(largest, most_runs_at_once);
  EXPECT_EQ(last, 1.0);
  ASSERT_EQ(taken.size(), count);
  for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(taken[i], 3 * i);
}

TEST(Faults, TicksThatTheMachineMissesAreAStallOfBothSites) {
  const FaultsParams params;
  const FaultPlan plan = draw_plan(FaultKind::none, 0, 1, 1.0);
  const auto played = [&](std::int64_t missed) {
    auto run = FaultRun::make(params, plan).value();
    const auto late_tick = std::lround((plan.start_s + 0.05) * params.servo.rate_Hz);
    std::int64_t steps = 1;
    for (; run.step(steps == late_tick ? missed : 0); ++steps) {
    }
    EXPECT_EQ(steps + missed, std::lround((plan.start_s + 0.9) * params.servo.rate_Hz)) << "time goes on";
    return run.outcome();
  };
  const FaultOutcome in_time = played(0), late = played(500), virtual_time = run_fault(params, plan).value();
  EXPECT_EQ(in_time.given_J, virtual_time.given_J);
  EXPECT_EQ(in_time.detection_ticks, -1);
  EXPECT_GT(late.detection_ticks, 0) << "0.1 s without a step ends in hold";
  for (const FaultOutcome& outcome : {in_time, late}) {
    EXPECT_EQ(outcome.not_finite + outcome.stale_applied + outcome.steps_above_rate, 0);
    EXPECT_TRUE(outcome.active_at_end);
  }
}

TEST(Faults, EqualPlansGiveEqualOutcomes) {
  const FaultsParams params;
  const FaultPlan plan = draw_plan(FaultKind::loss_bursts, 3, 1, 1.0),
                  same = draw_plan(FaultKind::loss_bursts, 3, 1, 1.0);
  EXPECT_EQ(plan.seed, same.seed);
  EXPECT_NE(plan.seed, draw_plan(FaultKind::loss_bursts, 4, 1, 1.0).seed);
  const auto left = run_fault(params, plan), right = run_fault(params, same);
  ASSERT_TRUE(left && right);
  EXPECT_EQ(left->peak_force_N, right->peak_force_N);
  EXPECT_EQ(left->given_J, right->given_J);
}

TEST(Faults, BadNumbersGoThroughEveryInputValueStateAndSiteOnce) {
  std::set<std::tuple<bool, int, std::size_t, int>> seen;
  for (std::int64_t choice = 0; choice < simulation::BadNumber::choices; ++choice) {
    const simulation::BadNumber bad = simulation::BadNumber::of(choice);
    std::size_t value = 0;
    while (value < simulation::BadNumber::values.size() && !(simulation::BadNumber::values[value] == bad.value) &&
           !(std::isnan(simulation::BadNumber::values[value]) && std::isnan(bad.value))) {
      ++value;
    }
    seen.insert({bad.at_master, static_cast<int>(bad.input), value, static_cast<int>(bad.state)});
  }
  EXPECT_EQ(static_cast<std::int64_t>(seen.size()), simulation::BadNumber::choices);
  EXPECT_LE(simulation::BadNumber::choices, 1000) << "a thousand seeds try all of them";
}

/// A choice that changes nothing would be a fault survived for free.
TEST(Faults, EveryBadNumberReachesAnInputOfTheSiteThatItIsMeantFor) {
  for (std::int64_t choice = 0; choice < simulation::BadNumber::choices; ++choice) {
    const simulation::BadNumber bad = simulation::BadNumber::of(choice);
    station::DeviceReading reading;
    control::Packet packet;
    bad.spoil(packet);
    bad.spoil(reading);
    // A slave has no use for a grip.
    const bool sensors = reading.position_m != 0.0 || reading.force_N != 0.0 || (bad.at_master && reading.grip != 1.0);
    const bool told = packet.age_s != 0.0 || packet.message.position_m != 0.0 ||
                      packet.message.velocity_m_per_s != 0.0 || packet.message.force_N != 0.0 ||
                      packet.message.wave != 0.0 || packet.message.energy_J != 0.0;
    EXPECT_TRUE(sensors || told) << "choice " << choice;
  }
}

/// The share of lost packets of a chain of two states is known in closed form: begins / (begins + ends) · loss.
TEST(ImpairedLink, LosesTheShareOfGilbertAndElliottAndInBurstsOfTheirMeanLength) {
  const simulation::Impairment impairment{
      .burst_begins_fraction = 0.01, .burst_ends_fraction = 0.1, .burst_loss_fraction = 1.0};
  simulation::ImpairedLink link(impairment, signal::Random(5));
  constexpr int packets = 400000;
  int lost = 0, bursts = 0;
  bool before = false;
  for (int i = 0; i < packets; ++i) {
    const bool gone = link.next().copies == 0;
    lost += gone;
    bursts += gone && !before;
    before = gone;
  }
  EXPECT_NEAR(static_cast<double>(lost) / packets, 0.01 / 0.11, 0.004);
  EXPECT_NEAR(static_cast<double>(lost) / bursts, 1.0 / 0.1, 0.4);
}

/// A judge that finds nothing wrong must be one that would.
TEST(FaultWitnesses, SeeWhatTheyAreThereFor) {
  FaultOutcome outcome;
  ForceWitness force(2.0, 500.0, 0.25, 1e-3);
  for (const double force_N : {0.5, 1.0, 1.500001, 1.4}) force.see(force_N, false, outcome);
  EXPECT_EQ(outcome.steps_above_rate, 1);
  force.see(std::numeric_limits<double>::quiet_NaN(), false, outcome);
  EXPECT_EQ(outcome.not_finite, 1);
  for (const double force_N : {1.8, 2.1}) force.see(force_N, false, outcome);
  EXPECT_EQ(outcome.forces_above_limit, 1);
  EXPECT_EQ(outcome.peak_force_N, 2.1);
  FaultOutcome stops;
  ForceWitness slow(2.0, 0.5, 0.25, 1e-3);
  for (const double force_N : {0.0005, 0.001, 0.0, -0.0005}) slow.see(force_N, false, stops);
  EXPECT_EQ(stops.steps_above_rate, 0) << "a stop falls within its time";
  for (const double force_N : {-0.001, 0.0004, 0.002}) slow.see(force_N, false, stops);
  EXPECT_EQ(stops.steps_above_rate, 2) << "what is beyond zero, and what grows, keeps the rate limit";

  PacketWitness packets(0.01, 1e-3);
  for (std::int64_t i = 1; i <= 30; ++i) packets.sent({.session = 9, .sequence = i}, i);
  const auto apply = [&](std::int64_t sequence, std::int64_t tick) {
    packets.applied({.applied_session = 9, .applied_sequence = sequence, .fresh = true}, tick, outcome);
  };
  apply(5, 6);
  apply(9, 10);
  EXPECT_EQ(outcome.stale_applied, 0);
  apply(8, 11);
  EXPECT_EQ(outcome.stale_applied, 1) << "older than one before";
  apply(10, 30);
  EXPECT_EQ(outcome.stale_applied, 2) << "too old";
  apply(31, 31);
  EXPECT_EQ(outcome.stale_applied, 3) << "never sent";

  EnergyWitness energy;
  double rise_J = 0.0;
  for (const double position_m : {0.0, -0.5, 0.25, 0.0}) rise_J = energy.see(2.0, position_m);
  EXPECT_DOUBLE_EQ(rise_J, 1.5) << "the rise from the lowest";

  HarmWitness harm(0.0, 0.01, 0.25, 1e-3);
  SiteHarm done;
  const auto gives = [&](double force_N, double speed_m_per_s, double now_s) {
    harm.see({.drive_N = force_N, .motor_m_per_s = speed_m_per_s}, now_s, done);
    return harm.forced_s() == now_s;
  };
  EXPECT_TRUE(gives(1.0, 0.0, 1.0)) << "presses";
  EXPECT_TRUE(gives(-1.0, -0.1, 2.0)) << "pushes";
  EXPECT_FALSE(gives(-1.0, 0.1, 3.0)) << "brakes";
  EXPECT_FALSE(gives(0.2, 0.0, 4.0)) << "hardly anything";
}

}  // namespace faults_test
}  // namespace tactus::experiments
