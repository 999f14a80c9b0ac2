// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <tests/allocation_counter.hpp>
#include <tests/runtime/site_loop_test.hpp>

namespace tactus::runtime {
namespace site_loop_test {

using control::GateFault;
using control::SiteCause;

TEST_F(Sites, GoThroughTheirStatesAsAPersonAsks) {
  open();
  run(5005);
  expect(SiteState::align, SiteState::align);
  ask(master, SiteWord::arm);
  expect(SiteState::active, SiteState::active);
  EXPECT_EQ(master.second.cause, SiteCause::none);
  EXPECT_GT(slave.second.peak_force_N, 0.01);
  ask(master, SiteWord::release);
  expect(SiteState::armed, SiteState::armed);
  EXPECT_EQ(master.second.cause, SiteCause::dead_man);
  ask(master, SiteWord::press);
  expect(SiteState::active, SiteState::active);
  ask(master, SiteWord::clutch);
  expect(SiteState::active, SiteState::active);
  ask(master, SiteWord::unclutch);
  const auto table = close(master, SiteRole::master);
  const auto told = column(table, "sent_position_m"), read = column(table, "position_m");
  const auto spread = [](const std::vector<double>& all, std::size_t begin, std::size_t end) {
    const auto [low, high] = std::minmax_element(all.begin() + static_cast<std::ptrdiff_t>(begin),
                                                 all.begin() + static_cast<std::ptrdiff_t>(end));
    return *high - *low;
  };
  // From one second to the next with the clutch pressed.
  EXPECT_EQ(spread(told, 20'010, 25'000), 0.0);
  EXPECT_GT(spread(read, 20'010, 25'000), 1e-3) << "the hand moves on";
  EXPECT_GT(spread(told, 25'010, 30'000), 1e-3);
}

TEST_F(Sites, ThatAreCutOffHoldUntilAPersonArms) {
  open(true);
  run(5005);
  expect(SiteState::active, SiteState::active);
  run(600, true, false);
  run(5000);
  expect(SiteState::hold, SiteState::hold);
  EXPECT_EQ(master.second.cause, SiteCause::timed_out);
  run(5000);
  expect(SiteState::hold, SiteState::hold);
  ask(master, SiteWord::arm);
  expect(SiteState::active, SiteState::active);
  const SiteTotals totals = master.loop->totals();
  EXPECT_EQ(totals.armings, 2);
  EXPECT_EQ(totals.holds[SiteCause::timed_out], 1);
  EXPECT_NEAR(totals.longest_silence_at_hold_s, 0.1, 0.001);
  EXPECT_EQ(master.loop->link_totals().stale_applied, 0);
  EXPECT_EQ(totals.steps_above_limit, 0);
}

// The slave's gate is set so that the taps are too fast for it.
TEST_F(Sites, AFaultIsLeftByClearingAtThatSiteAndAnArmingThatGoesUnansweredIsGivenUp) {
  params.control.slave_gate.velocity_limit_m_per_s = 0.01;
  open(true);
  run(10'005);
  expect(SiteState::hold, SiteState::fault);
  EXPECT_EQ(slave.second.fault, GateFault::velocity);
  EXPECT_EQ(slave.second.cause, SiteCause::gate);
  EXPECT_EQ(master.second.fault, GateFault::none) << "state and cause of the master, no fault of its gate";
  EXPECT_EQ(master.second.cause, SiteCause::peer);
  ask(master, SiteWord::clear);
  expect(SiteState::hold, SiteState::fault);
  ask(master, SiteWord::arm);
  run(1000);
  EXPECT_EQ(master.loop->totals().holds[SiteCause::unanswered], 1);
  run(4000);
  expect(SiteState::hold, SiteState::fault);
  ask(slave, SiteWord::clear);
  expect(SiteState::hold, SiteState::align);
  EXPECT_EQ(slave.second.fault, GateFault::none);
  ask(master, SiteWord::arm);
  EXPECT_EQ(slave.loop->totals().armings, 2);
}

// What a site does to its last tick is in its log, and its last second in what the report is made from.
TEST_F(Sites, TheLastSecondIsInTheLogAndInTheReport) {
  open(true);
  run(7'777);
  const auto table = close(slave, SiteRole::slave);
  const auto servo = telemetry::read_log(folder / "slave", "/servo").value().tables.at(0);
  EXPECT_EQ(metadata["site"], "slave");
  EXPECT_EQ(metadata["configuration"], configuration::to_toml(params));
  EXPECT_TRUE(std::filesystem::exists(folder / "slave" / "metadata.yaml"));
  ASSERT_EQ(table.times_ns.size(), 7'777U);
  ASSERT_EQ(servo.times_ns.size(), 7'777U);
  EXPECT_EQ(table.times_ns.back(), static_cast<std::uint64_t>(now_ns));
  const SiteTotals totals = slave.loop->totals();
  EXPECT_EQ(totals.ticks, 7'777);
  EXPECT_DOUBLE_EQ(slave.second.time_s, totals.duration_s);
  EXPECT_NEAR(totals.duration_s, 7'776 * 200e-6, 1e-9);

  // State, cause, active limit and fault are four columns; the link's facts and both forces beside them.
  const auto state = column(table, "state"), cause = column(table, "cause");
  EXPECT_EQ(state.back(), static_cast<double>(SiteState::active));
  EXPECT_EQ(cause.back(), static_cast<double>(SiteCause::none));
  EXPECT_EQ(cause.front(), static_cast<double>(SiteCause::started));
  EXPECT_EQ(std::set<double>(state.begin(), state.end()), (std::set<double>{0, 1, 2, 3}));
  for (const char* name : {"limit", "fault"}) EXPECT_EQ(column(table, name).back(), 0.0) << name;
  EXPECT_GT(column(table, "round_trip_s").back(), 0.0);
  EXPECT_EQ(column(table, "link_silence_s").back(), 0.0);
  EXPECT_EQ(column(table, "sent_sequence").back(), 7'777.0);
  EXPECT_EQ(column(table, "applied_sequence").back(), 7'777.0) << "the master is stepped first";
  const auto forces = column(table, "motor_force_N");
  EXPECT_GT(*std::ranges::max_element(forces), 0.01);
}

/// First tick at which a logged state was left that had lasted.
std::size_t end_of(const std::vector<double>& states, SiteState state) {
  const auto value = static_cast<double>(state);
  const auto begin = std::find(states.begin(), states.end(), value);
  return static_cast<std::size_t>(std::find_if(begin, states.end(), [&](double one) { return one != value; }) -
                                  states.begin());
}

TEST_F(Sites, WithoutThePersonBothStandAtTheNextTickAndNoWordMakesThemFollow) {
  open(true);
  run(5005);
  expect(SiteState::active, SiteState::active);
  master.exchange.person_lost = true;
  run(5000);
  expect(SiteState::armed, SiteState::armed);
  EXPECT_EQ(master.second.cause, SiteCause::dead_man);
  for (const SiteWord word : {SiteWord::press, SiteWord::arm}) {
    ask(master, word);
    expect(SiteState::armed, SiteState::armed);
  }
  const auto at_master = column(close(master, SiteRole::master), "state");
  const auto at_slave = column(close(slave, SiteRole::slave), "state");
  EXPECT_EQ(end_of(at_master, SiteState::active), 5005U);
  EXPECT_EQ(end_of(at_slave, SiteState::active), 5005U) << "it is told in the same tick";
  EXPECT_EQ(std::count(at_master.begin() + 5005, at_master.end(), static_cast<double>(SiteState::active)), 0);
}

/// The end of either site as it is seen at both.
class EndOfASite : public Sites, public ::testing::WithParamInterface<SiteRole> {};

TEST_P(EndOfASite, IsALossOfForceAtTheRateLimitAndTheOtherHolds) {
  constexpr double rate_limit_N_per_s = 500.0;
  constexpr double largest_step_N = rate_limit_N_per_s * 200e-6 * (1.0 + 1e-9);
  params.control.gate.rate_limit_N_per_s = params.control.slave_gate.rate_limit_N_per_s = rate_limit_N_per_s;
  open(true);
  run(pressing_tick);
  expect(SiteState::active, SiteState::active);
  const bool at_master = GetParam() == SiteRole::master;
  Site& ending = at_master ? master : slave;
  Site& other = at_master ? slave : master;
  ending.exchange.end.ask();
  int ticks = 0;
  for (; ending.more && ticks < 2500; ++ticks) run(1);
  EXPECT_LT(ticks, 750) << "it took more than 0.15 s";
  EXPECT_EQ(ending.loop->totals().steps_above_limit, 0);
  run(2, !at_master, at_master);
  const auto table = close(ending, GetParam());
  EXPECT_EQ(ending.second.state, SiteState::configure);
  EXPECT_EQ(ending.second.cause, SiteCause::dead_man);
  const auto states = column(table, "state"), force_N = column(table, "motor_force_N");
  EXPECT_EQ(end_of(states, SiteState::active), std::size_t{pressing_tick});
  EXPECT_GT(std::fabs(force_N[pressing_tick - 1]), 0.1) << "there was nothing to lose";
  for (std::size_t i = pressing_tick; i < force_N.size(); ++i) {
    EXPECT_LE(std::fabs(force_N[i] - force_N[i - 1]), largest_step_N) << "tick " << i;
  }
  EXPECT_EQ(force_N.back(), 0.0);
  const auto elsewhere = column(close(other, at_master ? SiteRole::slave : SiteRole::master), "state");
  EXPECT_LE(end_of(elsewhere, SiteState::active), std::size_t{pressing_tick} + 1) << "it was told at once";
  EXPECT_EQ(other.second.state, SiteState::hold);
  EXPECT_EQ(other.second.cause, SiteCause::peer);
}
INSTANTIATE_TEST_SUITE_P(, EndOfASite, ::testing::Values(SiteRole::master, SiteRole::slave),
                         [](const auto& role) { return std::string(name_of(role.param)); });

TEST_F(Sites, AnEmergencyStopAtEitherIsLeftByClearingThere) {
  open(true);
  run(5005);
  expect(SiteState::active, SiteState::active);
  ask(slave, SiteWord::stop);
  expect(SiteState::hold, SiteState::fault);
  EXPECT_EQ(slave.second.cause, SiteCause::emergency_stop);
  ask(slave, SiteWord::clear);
  expect(SiteState::hold, SiteState::align);
  ask(master, SiteWord::stop);
  expect(SiteState::fault, SiteState::align);
  ask(master, SiteWord::clear);
  ask(master, SiteWord::arm);
  expect(SiteState::active, SiteState::active);
}

TEST_F(Sites, AnEndThatIsInsistedOnIsNoTickMore) {
  open(true);
  run(5005);
  slave.exchange.end.insist();
  run(1);
  EXPECT_FALSE(slave.more);
  EXPECT_EQ(slave.loop->totals().ticks, 5005);
}

TEST_F(Sites, ATickWithItsLogDoesNotAllocate) {
  open(true);
  run(5005);
  expect(SiteState::active, SiteState::active);
  const std::uint64_t before = laws::own_allocation_count();
  run(3000);
  EXPECT_EQ(laws::own_allocation_count(), before);
}

}  // namespace site_loop_test
}  // namespace tactus::runtime
