// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/agreed_parameters.hpp>
#include <tactus/simulation/experiments/faults/duty.hpp>
#include <tactus/simulation/experiments/faults/faulty_configuration.hpp>
#include <tactus/simulation/experiments/faults/pairs.hpp>
#include <tactus/simulation/experiments/faults/process.hpp>
#include <tactus/simulation/experiments/faults/table.hpp>
#include <tactus/simulation/teleoperator/packet_relay.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::experiments {
namespace fault_course_test {

FaultMoment during(double since_s = 0.1) { return {.since_s = since_s, .before = false, .during = true}; }

TEST(FaultsOfTheCourse, SitesThatAreConfiguredDifferentlyNameEachKeyInWhichTheyCanDiffer) {
  const FaultsParams params;
  const Seconds tick{1.0 / params.servo.rate_Hz};
  for (std::size_t choice = 0; choice < FaultyConfiguration::keys.size(); ++choice) {
    const FaultPlan plan{.kind = FaultKind::configurations_differ,
                         .site = FaultSite::slave,
                         .choice = static_cast<std::int64_t>(choice),
                         .impairment = {}};
    const FaultyConfiguration of_master(params.control, tick, plan, FaultSite::master);
    const FaultyConfiguration of_slave(params.control, tick, plan, FaultSite::slave);
    auto master = control::make_supervised_master(of_master.control, 1, of_master.tick).value();
    auto slave = control::make_supervised_slave(of_slave.control, 2, of_slave.tick).value();
    for (int i = 0; i < 200; ++i) {
      slave.take(master.step({}).packet);
      master.take(slave.step({}).packet);
    }
    const auto named = control::first_disagreement(master.agreement());
    ASSERT_TRUE(named) << FaultyConfiguration::keys[choice];
    EXPECT_EQ(named->key, FaultyConfiguration::keys[choice]);
    EXPECT_NE(named->own, named->other);
  }
}

// A clock has one rate: the second drift takes its share of the ticks that the first leaves.
TEST(FaultsOfTheCourse, TwoDriftsOfOneClockAreOneOfAnotherRate) {
  const FaultPlan drift{.kind = FaultKind::rate_drift,
                        .site = FaultSite::slave,
                        .start_s = 0.0,
                        .length_s = 10.0,
                        .size = 0.67,
                        .impairment = {}};
  std::vector<FaultInjection> both{FaultInjection(drift, 1e-3), FaultInjection(drift, 1e-3)};
  FaultProcess process(FaultSite::slave);
  int steps = 0, gap = 0, longest = 0;
  for (std::int64_t tick = 0; tick < 9000; ++tick) {
    for (FaultInjection& one : both) one.enter(tick);
    process.fare(both, false);
    gap = process.stands_still() ? gap + 1 : 0;
    longest = std::max(longest, gap);
    steps += process.stands_still() ? 0 : 1;
  }
  EXPECT_NEAR(steps / 9000.0, 0.33 * 0.33, 0.01);
  EXPECT_LE(longest, 4 * 4) << "from one step of either to its next there are four ticks at most";
}

// By the default seed, before a slave that lets go was braked, before a site that misses its ticks let go, and before
// the rule knew slow clocks.
TEST(FaultsOfTheCourse, RunsThatWereLostOnceAreSurvived) {
  const FaultsParams params;
  const auto expect_survived = [&params](std::string_view id, std::vector<std::int64_t> numbers) {
    const FaultRow row = fault_rows(id).front();
    for (const std::int64_t number : numbers) {
      const FaultPlan plan = draw_plan(row.kind, number, 1, params.task.longest_cut_s);
      const auto outcome = run_fault(params_of(row, params), plan);
      ASSERT_TRUE(outcome);
      EXPECT_EQ(broken_rule(row, plan, *outcome, params), "") << id << " " << number;
    }
  };
  expect_survived("peer-wrong", {143, 319, 423, 559, 831});
  expect_survived("two-faults", {65, 484, 857});
}

TEST(FaultsOfTheCourse, TwoFaultsAreEveryPairOfKindsAmongAThousandAndOverlap) {
  std::set<FaultKind> kinds;
  std::set<std::pair<FaultKind, FaultKind>> pairs;
  for (std::int64_t choice = 0; choice < 1000; ++choice) {
    const auto plans = plans_of(draw_plan(FaultKind::two_faults, choice, 1, 1.0));
    ASSERT_EQ(plans.size(), 2U);
    kinds.insert({plans[0].kind, plans[1].kind});
    pairs.insert({plans[0].kind, plans[1].kind});
    EXPECT_LE(plans[0].start_s, plans[1].start_s);
    EXPECT_LE(plans[1].start_s, plans[0].start_s + 0.3);
  }
  EXPECT_GE(kinds.size(), 15U);
  EXPECT_EQ(pairs.size(), kinds.size() * (kinds.size() + 1) / 2);
}

TEST(FaultsOfTheCourse, ASiteThatRepeatsItselfHasFreshNumbersAndOldNews) {
  simulation::FaultyPeer peer({.kind = FaultKind::peer_repeats, .site = FaultSite::slave, .impairment = {}},
                              FaultSite::slave);
  control::Packet said{.session = 3, .sequence = 10, .armings = 1, .message = {.force_N = 0.5}};
  peer.step(said, {});
  control::Packet later{.session = 3, .sequence = 11, .armings = 2, .message = {.force_N = 0.9}};
  peer.step(later, during());
  EXPECT_EQ(later.sequence, 11);
  EXPECT_EQ(later.armings, 1);
  EXPECT_EQ(later.message.force_N, 0.5);
}

TEST(FaultsOfTheCourse, AMachineThatSleepsDoesNotCountTheTicksThatItMissesAndAProcessThatIsStoppedDoes) {
  for (const std::int64_t choice : {0, 1}) {
    const FaultPlan plan{.kind = FaultKind::suspend,
                         .start_s = 0.002,
                         .length_s = 0.0035 + simulation::forgotten_s,
                         .choice = choice,
                         .impairment = {}};
    std::vector<FaultInjection> injections{FaultInjection(plan, 1e-3)};
    FaultProcess process(FaultSite::master);
    std::int64_t elapsed_ticks = 0;
    for (std::int64_t tick = 0; tick < 8; ++tick) {
      injections.front().enter(tick);
      process.fare(injections, false);
      EXPECT_EQ(process.stands_still(), tick >= 2 && tick < 6) << tick;
      if (tick == 6) elapsed_ticks = process.elapsed_ticks();
    }
    EXPECT_EQ(elapsed_ticks, choice == 0 ? 5 : 1);
  }
}

/// A hand does not pull a handle that moved away back as if it had held it all the while.
TEST(FaultsOfTheCourse, AHandThatComesBackTakesTheHandleWhereItIsAndNothingThrewItMeanwhile) {
  const FaultsParams params;
  const FaultRow row = fault_rows("hand-lets-go").front();
  for (const auto& [seed, number] :
       std::vector<std::pair<std::int64_t, std::int64_t>>{{700000, 38}, {700000, 129}, {700000, 174}, {900000, 241}}) {
    const FaultPlan plan = draw_plan(FaultKind::hand_lets_go, number, seed, 1.0);
    const FaultOutcome outcome = run_fault(params, plan).value();
    EXPECT_EQ(broken_rule(row, plan, outcome, params), "") << number;
    EXPECT_LT(outcome.master.peak_force_N, 5.0) << number;
    EXPECT_LT(outcome.master.strayed_m, 0.03) << number << ": what was left of the force threw it";
  }
}

/// A pair of these kinds whose second begins so soon after the first.
FaultPlan pair_of(FaultKind first, FaultKind second, double within_s) {
  for (std::int64_t choice = 0; choice < 10000; ++choice) {
    const FaultPlan plan = draw_plan(FaultKind::two_faults, choice, 1, 1.0);
    const auto parts = plans_of(plan);
    if (parts[0].kind == first && parts[1].kind == second && parts[1].start_s < parts[0].start_s + within_s)
      return plan;
  }
  ADD_FAILURE() << "no such pair";
  return {};
}

TEST(FaultsOfTheCourse, OfTwoFaultsEachKeepsItsDutyPutOffByWhatTheOtherTakes) {
  const FaultsParams params;
  FaultOutcome outcome{.became_active = true, .stopped = true};
  const auto stops_after = [&](const FaultPlan& plan, double after_s) {
    outcome.master_followed_s = outcome.slave_followed_s = outcome.time_to_stop_s = after_s;
    outcome.detection_ticks = std::lround(after_s * params.servo.rate_Hz);
    return broken_duty_of_two(plan, outcome, params);
  };
  // A way that takes longer brings what is under way so much later, and no later than that.
  const FaultPlan delayed = pair_of(FaultKind::restart, FaultKind::disorder, 0.05);
  const auto parts = plans_of(delayed);
  const double way_s = parts[1].impairment.delay_s + parts[1].impairment.jitter_s;
  const double alone_s = duty_of(parts[0], params).within_s;
  EXPECT_EQ(stops_after(delayed, alone_s + 0.9 * way_s), "");
  EXPECT_NE(stops_after(delayed, alone_s + way_s + 0.001), "");
  // What begins only after the first should have stopped the sites puts nothing off.
  FaultPlan later = delayed;
  for (std::int64_t choice = 0; plans_of(later)[1].start_s < plans_of(later)[0].start_s + 0.15; ++choice) {
    const FaultPlan plan = draw_plan(FaultKind::two_faults, choice, 1, 1.0);
    const auto both = plans_of(plan);
    if (both[0].kind == FaultKind::restart && both[1].kind == FaultKind::disorder) later = plan;
  }
  EXPECT_EQ(stops_after(later, alone_s), "");
  EXPECT_NE(stops_after(later, alone_s + 0.001), "");
  // A jump is seen at once, whatever the other is.
  const FaultPlan jumps = pair_of(FaultKind::encoder_wrap, FaultKind::encoder_spike, 0.3);
  EXPECT_EQ(stops_after(jumps, 0.0), "");
  EXPECT_NE(stops_after(jumps, 0.01), "");
  // Who never followed shows nothing.
  outcome.became_active = false;
  EXPECT_NE(stops_after(jumps, 0.0), "");
}

TEST(FaultsOfTheCourse, NoOneFollowsOnAFaultThatCameWhileArming) {
  const FaultsParams params;
  FaultPlan plan;
  for (std::int64_t choice = 0; plan.kind == FaultKind::none; ++choice) {
    const FaultPlan one = draw_plan(FaultKind::fault_while_arming, choice, 1, 1.0);
    if (plans_of(one).front().kind == FaultKind::restart) plan = one;
  }
  FaultOutcome outcome;
  EXPECT_EQ(broken_duty_while_arming(plan, outcome, params), "");
  outcome.slave_followed_s = 0.5;
  EXPECT_NE(broken_duty_while_arming(plan, outcome, params), "");
}

/// Of a pair, one way is late only while that fault lasts.
TEST(FaultsOfTheCourse, EachLinkOfARelayImpairsInItsOwnTime) {
  const simulation::ImpairedLink slow({.delay_s = 0.004}, signal::Random(1)),
      slower({.delay_s = 0.010}, signal::Random(2));
  simulation::PacketRelay relay({slow, slower}, 0.014, 0.001);
  const auto arrives_after = [&relay](std::int64_t sent_tick, double of_slow, double of_slower) {
    relay.send({}, sent_tick, [&](std::size_t i) { return i == 0 ? of_slow : of_slower; });
    std::int64_t after = -1;
    for (std::int64_t tick = sent_tick; tick < sent_tick + 16; ++tick) {
      relay.deliver(tick, [&](const control::Packet&) { after = tick - sent_tick; });
    }
    return after;
  };
  EXPECT_EQ(arrives_after(0, 0.0, 0.0), 0);
  EXPECT_EQ(arrives_after(20, 1.0, 0.0), 4);
  EXPECT_EQ(arrives_after(40, 1.0, 1.0), 14);
  EXPECT_EQ(arrives_after(60, 0.0, 0.5), 5);
}

/// A control that survives would say that the row shows nothing.
TEST(FaultsOfTheCourse, ADriveThatKeepsAnOldCommandPushesOnAndOneThatLetsGoDoesNot) {
  const FaultsParams params;
  const FaultRow row = fault_rows("stale-commands").front();
  for (std::int64_t i = 0; i < 3; ++i) {
    FaultPlan plan = draw_plan(FaultKind::stale_commands, i, 1, 1.0);
    EXPECT_EQ(broken_rule(row, plan, run_fault(params, plan).value(), params), "");
    simulation::Teleoperator::Params off = params;
    row.control.switch_off(off, plan);
    EXPECT_NE(broken_rule(row, plan, run_fault(off, plan).value(), params), "");
  }
}

}  // namespace fault_course_test
}  // namespace tactus::experiments
