// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/architecture.hpp>
#include <tactus/kernel/control/architectures/energy_tank.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "tests/control/random_line.hpp"
#include <gtest/gtest.h>

namespace tactus::control {
namespace energy_tank_test {

static_assert(Element<TankMaster>);
static_assert(Element<TankSlave>);

constexpr double tick_s = 200e-6;

TankMaster master_of(const TankMaster::Params& params) { return TankMaster::make(params, Seconds{tick_s}).value(); }
TankSlave slave_of(const TankSlave::Params& params) { return TankSlave::make(params, Seconds{tick_s}).value(); }

EnergyTank::Params any_tank(Draw& draw) {
  EnergyTank::Params tank;
  tank.desired_level_J = draw.between(1e-5, 5e-3);
  tank.capacity_J = tank.desired_level_J * draw.between(1.0, 10.0);
  tank.transfer_per_s = draw.between(0.0, 200.0);
  tank.refill_damping_N_s_per_m = draw.between(0.0, 50.0);
  tank.fastest_m_per_s = draw.between(0.1, 2.0);
  return tank;
}

TEST(EnergyTank, NoTankFallsBelowZeroAndTheTwoNeverGiveMoreThanTheyStartedWith) {
  double least_share = 1.0;
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    Draw draw(seed);
    const EnergyTank::Params tank = any_tank(draw);
    TankMaster::Params params{.display = {}, .tank = tank};
    params.display.cancellation = seed % 2 == 0 ? CancellationMode::on : CancellationMode::off;
    params.display.force_gain = draw.between(0.0, 15.0);
    params.display.force_limit_N = draw.between(0.5, 20.0);
    TankMaster master = master_of(params);
    TankSlave slave = slave_of({.slave = {}, .tank = tank});
    RandomLine to_slave = RandomLine::any(draw);
    RandomLine to_master = RandomLine::any(draw);
    const double longest_m = tank.fastest_m_per_s * tick_s;
    RandomMotion hand(draw, longest_m * draw.between(0.1, 1.0), seed % 3 != 0);
    RandomMotion tool(draw, longest_m * draw.between(0.1, 1.0), seed % 3 == 1);
    Arrival back;
    double hand_m = 0.0, tool_m = 0.0, hand_N = 0.0, tool_N = 0.0, given_J = 0.0;
    for (int tick = 0; tick < 5000; ++tick) {
      const double hand_before_m = std::exchange(hand_m, hand.step());
      const double tool_before_m = std::exchange(tool_m, tool.step());
      if (tick > 0) given_J += hand_N * (hand_m - hand_before_m) + tool_N * (tool_m - tool_before_m);
      const auto out = master.step({.motor_position_m = hand_m, .arrival = back});
      // Somebody leans on the tool with whatever force it likes.
      const auto answer = slave.step(
          {.motor_position_m = tool_m, .tip_force_N = draw.between(-2.0, 2.0), .arrival = to_slave.step(out.message)});
      back = to_master.step(answer.message);
      hand_N = out.motor_force_N;
      tool_N = answer.motor_force_N;
      const double start_J = tank.desired_level_J;
      ASSERT_GE(master.level_J(), -1e-12 * start_J) << "seed " << seed << ", tick " << tick;
      ASSERT_GE(slave.level_J(), -1e-12 * start_J) << "seed " << seed << ", tick " << tick;
      ASSERT_LE(given_J, 2.0 * start_J * (1.0 + 1e-9)) << "seed " << seed << ", tick " << tick;
      least_share = std::min(least_share, std::min(master.level_J(), slave.level_J()) / start_J);
    }
  }
  EXPECT_LT(least_share, 1e-3) << "no tank was ever drained, so the limit was not tried";
}

TEST(EnergyTank, OnALineThatLosesNothingAtTheEndEveryJouleIsSomewhere) {
  EnergyTank::Params tank;
  tank.capacity_J = 1000.0;
  TankMaster master = master_of({.display = {}, .tank = tank});
  TankSlave slave = slave_of({.slave = {}, .tank = tank});
  Draw draw(3);
  RandomLine to_slave(draw, 40, 20, 0.5), to_master(draw, 60, 20, 0.5);
  RandomMotion hand(draw, 5e-5, true), tool(draw, 5e-5, true);
  Arrival back, forth;
  double hand_m = 0.0, tool_m = 0.0, hand_N = 0.0, tool_N = 0.0, put_in_J = 2.0 * tank.desired_level_J;
  for (int tick = 0; tick < 5000; ++tick) {
    const double hand_before_m = std::exchange(hand_m, hand.step());
    const double tool_before_m = std::exchange(tool_m, tool.step());
    if (tick > 0) put_in_J -= hand_N * (hand_m - hand_before_m) + tool_N * (tool_m - tool_before_m);
    const double master_got_J = back.message.energy_J;
    const auto out = master.step({.motor_position_m = hand_m, .arrival = back});
    forth = to_slave.step(out.message);
    const auto answer = slave.step({.motor_position_m = tool_m, .tip_force_N = 0.2, .arrival = forth});
    back = to_master.step(answer.message);
    hand_N = out.motor_force_N;
    tool_N = answer.motor_force_N;
    // Lost packets are not lost energy: what is under way is what was sent in all less what arrived in all.
    const double under_way_J = out.message.energy_J - forth.message.energy_J + answer.message.energy_J - master_got_J;
    ASSERT_NEAR(master.level_J() + slave.level_J() + under_way_J, put_in_J, 1e-13) << tick;
  }
}

TEST(EnergyTank, WhileTheLevelIsAmpleTheSitesArePositionForce) {
  EnergyTank::Params tank;
  tank.desired_level_J = tank.capacity_J = 50.0;
  tank.refill_damping_N_s_per_m = 0.0;
  TankMaster master = master_of({.display = {}, .tank = tank});
  TankSlave slave = slave_of({.slave = {}, .tank = tank});
  PositionForceMaster reference = PositionForceMaster::make({}, Seconds{tick_s}).value();
  PositionForceSlave reference_slave = PositionForceSlave::make({}, Seconds{tick_s}).value();
  Draw draw(1);
  RandomMotion hand(draw, 5e-5, true);
  for (int tick = 0; tick < 500; ++tick) {
    const Message message{.position_m = hand.step(), .force_N = draw.between(-2.0, 2.0)};
    const MasterInput input{.motor_position_m = hand.step(), .arrival = {.message = message, .fresh = true}};
    const auto out = master.step(input);
    const auto expected = reference.step(input);
    ASSERT_EQ(out.motor_force_N, expected.motor_force_N);
    ASSERT_EQ(out.message.position_m, expected.message.position_m);
    const SlaveInput slave_input{.motor_position_m = 0.0, .tip_force_N = 0.3, .arrival = input.arrival};
    const auto answer = slave.step(slave_input);
    ASSERT_EQ(answer.motor_force_N, reference_slave.step(slave_input).motor_force_N);
    ASSERT_EQ(answer.message.force_N, 0.3);
  }
}

TEST(EnergyTank, AHandThatMovesFillsTheTankToTheDesiredLevelAndFeelsNothingFromThere) {
  TankMaster::Params params;
  params.tank.transfer_per_s = 0.0;
  TankMaster master = master_of(params);
  // Someone on the line takes all but a tenth.
  const Arrival robbed{.message = {.energy_J = -0.9 * params.tank.desired_level_J}, .fresh = true};
  double before_N = 0.0;
  for (int tick = 0; tick < 30000; ++tick) {
    const double force_N = master.step({.motor_position_m = 0.2 * tick * tick_s, .arrival = robbed}).motor_force_N;
    // The damper's law: 5 N s/m at 0.2 m/s less the share of the level.
    const double share = master.level_J() / params.tank.desired_level_J;
    if (tick > 50) {
      ASSERT_NEAR(force_N, -5.0 * 0.2 * (1.0 - share), 1e-6) << tick;
      ASSERT_GE(force_N, before_N - 1e-12);
    }
    before_N = force_N;
  }
  EXPECT_NEAR(master.level_J(), params.tank.desired_level_J, 1e-6 * params.tank.desired_level_J);
}

TEST(EnergyTank, AForceFadesWithTheLevelThatHasToPayForIt) {
  TankSlave::Params params;
  params.tank.transfer_per_s = 0.0;
  params.tank.fastest_m_per_s = 0.5;
  params.slave.derivative_N_s_per_m = 0.0;
  params.slave.proportional_N_per_m = 100.0;
  TankSlave slave = slave_of(params);
  // The servo asks for 1 N ahead of a tool that runs away at 0.1 m/s: once less than 1 N can be paid for the level
  // falls by the share 0.1 / 0.5 in every tick.
  double level_J = params.tank.desired_level_J, held_N = 0.0;
  for (int tick = 0; tick < 200; ++tick) {
    const double tool_m = 0.1 * tick * tick_s;
    level_J -= held_N * (tick > 0 ? 0.1 * tick_s : 0.0);
    held_N = std::min(1.0, level_J / (0.5 * tick_s));
    const auto out =
        slave.step({.motor_position_m = tool_m, .arrival = {.message = {.position_m = tool_m + 0.01}, .fresh = true}});
    ASSERT_NEAR(out.motor_force_N, held_N, 1e-9) << tick;
  }
  EXPECT_LT(held_N, 1e-3);
}

TEST(EnergyTank, ALevelThatIsNotANumberReachesTheGate) {
  constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
  TankSlave slave = slave_of({});
  const auto out = slave.step({.arrival = {.message = {.position_m = 0.01, .energy_J = not_a_number}, .fresh = true}});
  EXPECT_TRUE(std::isnan(out.motor_force_N));
}

TEST(EnergyTank, ErrorsNameTheKeyOfTheFile) {
  ControlParams params;
  params.architecture = "energy-tank";
  params.own<EnergyTank::Params>().capacity_J = 1e-3;
  EXPECT_EQ(describe(make_sites(params, Seconds{tick_s}).error()),
            "tank.capacity_J: 0.001 J is less than desired_level_J, 0.002 J: raise one or lower the other");
  params.own<EnergyTank::Params>() = {};
  params.model.cable.damping_N_s_per_m = 0.0;
  params.cancellation_step = CancellationStep::euler;
  EXPECT_EQ(make_sites(params, Seconds{tick_s}).error().parameter, "cancellation_step");
}

}  // namespace energy_tank_test
}  // namespace tactus::control
