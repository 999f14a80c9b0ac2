// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>

#include "tests/devices/dynamixel/bench.hpp"
#include <gtest/gtest.h>
#include <tests/allocation_counter.hpp>

namespace tactus::devices::dynamixel::bus_test {

TEST(DynamixelBus, BeforeACommandEveryServoIsSetUpAndHasNoPower) {
  Rig rig({});
  EXPECT_EQ(rig.bus.state(), BusState::asking);
  rig.run(300 * ms);
  ASSERT_EQ(rig.bus.state(), BusState::ready);
  EXPECT_FALSE(rig.bus.problem());
  for (std::size_t i = 0; i < rig.bus.motors(); ++i) {
    EXPECT_FALSE(rig.torque_on(i));
    EXPECT_EQ(rig.peer.stored(i, 9, 1), 0);   // return delay
    EXPECT_EQ(rig.peer.stored(i, 11, 1), 0);  // current mode
    EXPECT_EQ(rig.goal(i), 0);
    EXPECT_EQ(rig.bus.reading(i).enabled, 0);
    EXPECT_EQ(rig.bus.reading(i).fault, MotorFault::none);
  }
  EXPECT_EQ(rig.bus.reading(6).temperature_C, 35.0);
}

TEST(DynamixelBus, PowerComesBehindAWatchdogAndTheGoalIsTheCommandedTorque) {
  Rig rig({});
  rig.run(300 * ms);
  rig.command_all(-0.05, 1);
  rig.run(200 * ms);
  for (std::size_t i = 0; i < rig.bus.motors(); ++i) {
    EXPECT_TRUE(rig.torque_on(i));
    EXPECT_EQ(rig.peer.stored(i, 98, 1), 5);
    EXPECT_EQ(rig.bus.reading(i).enabled, 1);
    EXPECT_EQ(rig.goal(i), -std::lround(0.05 / torque_of_one_Nm));
    // What it tells is what it does.
    EXPECT_NEAR(rig.bus.reading(i).torque_Nm, -0.05, torque_of_one_Nm);
    EXPECT_NEAR(rig.bus.reading(i).position_rad, rig.peer.joint(i).position_rad, 0.02);
    EXPECT_NEAR(rig.bus.reading(i).velocity_rad_per_s, rig.peer.joint(i).velocity_rad_per_s, 0.05);
    EXPECT_LT(rig.peer.joint(i).velocity_rad_per_s, -0.1);
  }
  rig.command_all(-0.05, 0);
  rig.run(100 * ms);
  for (std::size_t i = 0; i < rig.bus.motors(); ++i) {
    EXPECT_FALSE(rig.torque_on(i));
    EXPECT_EQ(rig.goal(i), 0);
    EXPECT_EQ(rig.bus.reading(i).enabled, 0);
  }
}

TEST(DynamixelBus, ItsCyclesTakeTheTimeOfTheirBytesAndHardlyMore) {
  // From the page, to see that the arithmetic is the same.
  EXPECT_NEAR(most_cycles_per_s(8, 4'000'000, false), 1754, 1);
  EXPECT_NEAR(most_cycles_per_s(8, 4'000'000, true), 2222, 1);
  EXPECT_NEAR(most_cycles_per_s(8, 1'000'000, false), 439, 1);
  for (const std::size_t servos : {7U, 8U}) {
    for (const std::int64_t rate : {1'000'000, 2'000'000, 4'000'000}) {
      for (const bool fast : {false, true}) {
        Rig rig({.servos = servos, .bits_per_s = rate, .fast = fast});
        rig.run(300 * ms);
        rig.command_all(0.01, 1);
        rig.run(200 * ms);
        const std::int64_t before = rig.bus.cycles();
        rig.run(2 * second);
        const double share =
            static_cast<double>(rig.bus.cycles() - before) / 2.0 / most_cycles_per_s(servos, rate, fast);
        EXPECT_GE(share, 0.95) << servos << " at " << rate << (fast ? " fast" : " plain");
        EXPECT_LE(share, 1.0);
        RecordProperty("share_" + std::to_string(servos) + "_" + std::to_string(rate) + (fast ? "_fast" : "_plain"),
                       std::to_string(share));
      }
    }
  }
}

TEST(DynamixelBus, FirmwareWithoutFastReadsIsReadPlainly) {
  Rig rig({.knows_fast = false});
  rig.run(300 * ms);
  ASSERT_EQ(rig.bus.state(), BusState::ready);
  const std::int64_t before = rig.bus.reading(3).answers, cycles = rig.bus.cycles();
  rig.run(5 * second);
  EXPECT_GE(rig.bus.reading(3).answers - before, (rig.bus.cycles() - cycles) * 99 / 100);
  EXPECT_EQ(rig.bus.reading(3).fault, MotorFault::none);
}

TEST(DynamixelBus, ATorqueBeyondTheLimitIsSentAsTheLimitAndCounted) {
  Rig rig({.fault = ServoFault::low_limit});
  rig.run(300 * ms);
  ASSERT_EQ(rig.bus.state(), BusState::ready);
  rig.command_all(0.1, 1);  // of 283 units
  rig.run(200 * ms);
  EXPECT_EQ(rig.bus.limited(), 1);
  EXPECT_EQ(rig.goal(2), 175);
  EXPECT_EQ(rig.goal(3), 283);
  rig.command_all(1e300, 1);
  rig.run(50 * ms);
  EXPECT_EQ(rig.goal(2), 175);
  EXPECT_EQ(rig.goal(3), 1750);
  rig.command_all(-std::numeric_limits<double>::infinity(), 1);
  rig.run(50 * ms);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_FALSE(rig.torque_on(i));
  EXPECT_EQ(rig.peer.lost_goals(), 0);
}

TEST(DynamixelBus, ACommandThatIsNoNumberTakesThePower) {
  Rig rig({});
  rig.run(300 * ms);
  rig.command_all(0.05, 1);
  rig.run(100 * ms);
  rig.bus.command(4, {.torque_Nm = std::numeric_limits<double>::quiet_NaN(), .enabled = 1});
  rig.run(50 * ms);
  EXPECT_FALSE(rig.torque_on(4));
  EXPECT_TRUE(rig.torque_on(3));
}

TEST(DynamixelBus, AnotherModelIsRefusedByItsNameBeforeAnythingHasPower) {
  Rig rig({.fault = ServoFault::wrong_model});
  rig.command_all(0.05, 1);
  rig.run(500 * ms);
  EXPECT_EQ(rig.bus.state(), BusState::refused);
  ASSERT_TRUE(rig.bus.problem());
  EXPECT_EQ(describe(*rig.bus.problem()),
            "servo 3 reports model number 1220 (XC330-T288) where XL330-M288 is stated: state the model that is there, "
            "or change the servo");
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_FALSE(rig.torque_on(i));
    EXPECT_EQ(rig.peer.largest_current(i), 0);
  }
  EXPECT_EQ(rig.bus.wakes_ns(), wire::never_ns);
}

TEST(DynamixelBus, PositionsGoOnWhereTheWiresNumberWraps) {
  Rig rig({.servos = 1});
  // 2^31 steps are 524,288 turns. The servo stands half a turn before.
  rig.peer.joint(0).position_rad = (524'288.0 - 0.5) * 2.0 * std::numbers::pi;
  rig.run(300 * ms);
  const double first = rig.bus.reading(0).position_rad;
  rig.peer.joint(0).position_rad += 2.0 * std::numbers::pi;
  rig.run(10 * ms);
  EXPECT_NEAR(rig.bus.reading(0).position_rad - first, 2.0 * std::numbers::pi, 1e-3);
}

TEST(DynamixelBus, NeitherItNorItsPeerAllocatesOnceMade) {
  Rig rig({.line = {.corrupt = 0.01, .garbage = 0.01, .split = 0.01, .echo = 1},
           .fault = ServoFault::power_cycle,
           .fault_from_ns = 700 * ms});
  const std::uint64_t before = laws::own_allocation_count();
  rig.run(600 * ms);
  rig.command_all(0.05, 1);
  rig.run(second);
  EXPECT_EQ(laws::own_allocation_count(), before);
  EXPECT_GT(rig.bus.cycles(), 100);
}

TEST(DynamixelBus, WhatCannotBeABusIsRefused) {
  const auto error_of = [](DynamixelBus::Params params) { return describe(DynamixelBus::make(params).error()); };
  EXPECT_EQ(error_of({}), "motors: 0 motors: a bus has 1 to 16");
  EXPECT_EQ(error_of({.motors = {{.id = 253}}}), "motors[0].id: 253 must lie between 0 and 252");
  EXPECT_EQ(error_of({.motors = {{.id = 3}, {.id = 4}, {.id = 3}}}),
            "motors[2].id: 3 is that of motors[0] too: give each its own");
  EXPECT_EQ(error_of({.motors = {{.id = 3}}, .bits_per_s = 500'000}),
            "bits_per_s: 500000 bit/s: the servos do 9600, 57600, 115200, 1000000, 2000000, 3000000 and 4000000");
}

}  // namespace tactus::devices::dynamixel::bus_test
