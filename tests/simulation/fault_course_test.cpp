#include <tactus/control/agreed_parameters.hpp>
#include <tactus/simulation/fault_pairs.hpp>
#include <tactus/simulation/fault_process.hpp>
#include <tactus/simulation/fault_table.hpp>
#include <tactus/simulation/faulty_configuration.hpp>

#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::simulation {
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
  FaultyPeer peer({.kind = FaultKind::peer_repeats, .site = FaultSite::slave, .impairment = {}}, FaultSite::slave);
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
                         .length_s = 0.0035 + forgotten_s,
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

/// A control that survives would say that the row shows nothing.
TEST(FaultsOfTheCourse, ADriveThatKeepsAnOldCommandPushesOnAndOneThatLetsGoDoesNot) {
  const FaultsParams params;
  const FaultRow row = fault_rows("stale-commands").front();
  for (std::int64_t i = 0; i < 3; ++i) {
    FaultPlan plan = draw_plan(FaultKind::stale_commands, i, 1, 1.0);
    EXPECT_EQ(broken_rule(row, plan, run_fault(params, plan).value(), params), "");
    Teleoperator::Params off = params;
    row.control.switch_off(off, plan);
    EXPECT_NE(broken_rule(row, plan, run_fault(off, plan).value(), params), "");
  }
}

}  // namespace fault_course_test
}  // namespace tactus::simulation
