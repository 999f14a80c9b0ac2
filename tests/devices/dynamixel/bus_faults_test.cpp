// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "tests/devices/dynamixel/bench.hpp"
#include "tests/devices/seeds.hpp"
#include <gtest/gtest.h>

namespace tactus::devices::dynamixel::bus_test {

TEST(DynamixelBus, ASilentServoCostsNoOtherItsDataButInOneCycle) {
  for (const bool fast : {false, true}) {
    for (std::size_t silent = 0; silent < 7; ++silent) {
      Rig rig({.fast = fast, .fault = ServoFault::silence, .faulty = silent, .fault_from_ns = 600 * ms});
      rig.run(300 * ms);
      rig.command_all(0.01, 1);
      rig.run(290 * ms);
      std::array<std::int64_t, 7> before{};
      for (std::size_t i = 0; i < 7; ++i) before[i] = rig.bus.reading(i).answers;
      const std::int64_t cycles = rig.bus.cycles();
      rig.run(2 * second);
      const std::int64_t ran = rig.bus.cycles() - cycles;
      // Of the plain reads of six, with a few pauses for the seventh.
      EXPECT_GT(static_cast<double>(ran), 0.9 * 2.0 * most_cycles_per_s(7, 1'000'000, false));
      for (std::size_t i = 0; i < 7; ++i) {
        if (i == silent) continue;
        // One lost where the read was a fast one, one under way at either end.
        EXPECT_GE(rig.bus.reading(i).answers - before[i], ran - (fast ? 2 : 1)) << silent << ' ' << i;
        EXPECT_EQ(rig.bus.reading(i).fault, MotorFault::none);
        EXPECT_EQ(rig.bus.reading(i).enabled, 1);
      }
      EXPECT_EQ(rig.bus.reading(silent).fault, MotorFault::not_responding);
      EXPECT_LT(rig.bus.reading(silent).received_ns, 605 * ms);
      EXPECT_EQ(rig.goal(silent), 0);
    }
  }
}

/// Counts the reads of all servos that pass.
class Reads final : public wire::WireEnd {
 public:
  explicit Reads(wire::WireEnd& behind) : behind_(behind) {}
  void hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) noexcept override {
    const bool is_fast = bytes.size() > 7 && bytes[7] == 0x8a, is_plain = bytes.size() > 7 && bytes[7] == 0x82;
    if (is_fast || is_plain) {
      turns += is_fast == last_was_fast ? 0 : 1;
      last_was_fast = is_fast;
      ++(is_fast ? fast : plain);
    }
    behind_.hear(bytes, now_ns);
  }
  std::span<const std::uint8_t> say(std::int64_t now_ns) noexcept override { return behind_.say(now_ns); }
  [[nodiscard]] std::int64_t wakes_ns() const noexcept override { return behind_.wakes_ns(); }

  std::int64_t fast = 0, plain = 0, turns = 0;
  bool last_was_fast = true;

 private:
  wire::WireEnd& behind_;
};

TEST(DynamixelBus, AfterALostAnswerAThousandPlainReadsFollowAndThenFastOnesAgain) {
  // It is off for 300 ms, in which it is asked again every 50 ms.
  Rig rig({.fault = ServoFault::power_cycle, .fault_from_ns = 600 * ms});
  Reads reads(*rig.line);
  wire::join(rig.bus, reads, 0, 590 * ms);
  EXPECT_GT(reads.fast, 0);
  EXPECT_EQ(reads.plain, 0);
  wire::join(rig.bus, reads, 590 * ms, 960 * ms);
  EXPECT_GT(rig.bus.reading(2).received_ns, 900 * ms);
  EXPECT_FALSE(reads.last_was_fast);
  const std::int64_t until_it_was_back = reads.plain;
  wire::join(rig.bus, reads, 960 * ms, 4 * second);
  EXPECT_TRUE(reads.last_was_fast);
  EXPECT_EQ(reads.turns, 2);  // once to plain reads, once back
  EXPECT_GE(reads.plain, 1000);
  EXPECT_LE(reads.plain - until_it_was_back, 1000);
}

TEST(DynamixelBus, AServoThatIsNotThereIsNamed) {
  Rig rig({.fault = ServoFault::silence, .faulty = 5});
  rig.command_all(0.05, 1);
  rig.run(500 * ms);
  EXPECT_EQ(rig.bus.state(), BusState::refused);
  EXPECT_EQ(describe(*rig.bus.problem()),
            "servo 6 does not answer at 1000000 bit/s: look at its power, its cable, its id and its bit rate");
  EXPECT_EQ(rig.bus.reading(5).fault, MotorFault::not_responding);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(rig.peer.largest_current(i), 0);
}

TEST(DynamixelBus, TwoServosWithOneIdAreToldWhetherTheirAnswersMeetOrNot) {
  Rig twins({.fault = ServoFault::twin});
  twins.run(500 * ms);
  EXPECT_EQ(twins.bus.state(), BusState::refused);
  EXPECT_EQ(describe(*twins.bus.problem()),
            "servo 3 answers twice: two servos have this id: unplug one of them, and give the other one of its own");
  Rig clash({.fault = ServoFault::clash});
  clash.run(500 * ms);
  EXPECT_EQ(clash.bus.state(), BusState::refused);
  EXPECT_EQ(describe(*clash.bus.problem())
                .find("servo 3 is answered for by bytes that are no packet: two servos have "
                      "this id and talk at once, or the line is disturbed"),
            0U)
      << describe(*clash.bus.problem());
  // What an adapter sends back of a question is no such bytes.
  Rig echo({.line = {.echo = 1}, .fault = ServoFault::silence});
  echo.run(500 * ms);
  EXPECT_EQ(describe(*echo.bus.problem()).find("servo 3 does not answer at 1000000 bit/s"), 0U);
}

TEST(DynamixelBus, AHotServoTellsSoAndStaysOffUntilItHasCooled) {
  Rig rig({.fault = ServoFault::hot, .fault_from_ns = 700 * ms});
  rig.run(300 * ms);
  rig.command_all(0.05, 1);
  rig.run(390 * ms);
  EXPECT_EQ(rig.bus.reading(2).fault, MotorFault::none);
  rig.run(100 * ms);
  EXPECT_EQ(rig.bus.reading(2).fault, MotorFault::hot);
  EXPECT_EQ(rig.bus.reading(2).enabled, 0);
  EXPECT_EQ(rig.goal(2), 0);
  rig.run(second);
  EXPECT_EQ(rig.bus.reading(2).temperature_C, 81.0);
  EXPECT_EQ(rig.bus.reading(1).enabled, 1);
  // To ask for no power and for power again changes nothing while it is hot.
  rig.command_all(0.05, 0);
  rig.run(200 * ms);
  rig.command_all(0.05, 1);
  rig.run(second);
  EXPECT_EQ(rig.bus.reading(2).fault, MotorFault::hot);
  EXPECT_FALSE(rig.torque_on(2));
  EXPECT_TRUE(rig.torque_on(1));
}

TEST(DynamixelBus, WhoWasOffGetsNoPowerByItself) {
  Rig rig({.fault = ServoFault::power_cycle, .fault_from_ns = 600 * ms});
  rig.run(300 * ms);
  rig.command_all(0.05, 1);
  rig.run(3 * second);
  EXPECT_EQ(rig.bus.reading(2).fault, MotorFault::not_responding);
  EXPECT_GT(rig.bus.reading(2).received_ns, 3 * second);  // it answers again
  EXPECT_FALSE(rig.torque_on(2));
  EXPECT_EQ(rig.bus.reading(2).enabled, 0);
  // Asked anew it gets it, behind its watchdog and with the goal that is commanded, not that of its own start.
  rig.bus.command(2, {});
  rig.run(200 * ms);
  EXPECT_EQ(rig.bus.reading(2).fault, MotorFault::none);
  rig.bus.command(2, {.torque_Nm = 0.02, .enabled = 1});
  rig.run(200 * ms);
  EXPECT_TRUE(rig.torque_on(2));
  EXPECT_EQ(rig.peer.stored(2, 98, 1), 5);
  EXPECT_EQ(rig.peer.largest_current(2), std::lround(0.05 / torque_of_one_Nm));
}

TEST(DynamixelBus, WhenNothingIsSaidTheServosLetGoAndTheBusSaysWhy) {
  Rig rig({});
  rig.run(300 * ms);
  rig.command_all(0.05, 1);
  rig.run(200 * ms);
  rig.now_ns += 150 * ms;  // the program stood still
  rig.run(300 * ms);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_EQ(rig.bus.reading(i).fault, MotorFault::lost_master);
    EXPECT_FALSE(rig.torque_on(i));
  }
  rig.command_all(0.05, 0);
  rig.run(100 * ms);
  rig.command_all(0.05, 1);
  rig.run(200 * ms);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_EQ(rig.bus.reading(i).fault, MotorFault::none);
    EXPECT_TRUE(rig.torque_on(i));
    EXPECT_EQ(rig.goal(i), std::lround(0.05 / torque_of_one_Nm));
  }
}

TEST(DynamixelBus, WhateverTheLineDoesNoServoGivesMoreThanItWasAskedFor) {
  const auto most = std::lround(0.05 / torque_of_one_Nm);
  for (const ServoFault fault : {ServoFault::none, ServoFault::silence, ServoFault::power_cycle, ServoFault::hot}) {
    for (std::int64_t seed = 1; seed <= seeds(25); ++seed) {
      const LineFaults line{.corrupt = seed % 2 == 0 ? 0.01 : 0.0,
                            .garbage = seed % 3 == 0 ? 0.05 : 0.0,
                            .split = seed % 4 == 1 ? 0.05 : 0.0,
                            .echo = seed / 4 % 2};
      Rig rig({.line = line, .seed = seed, .fault = fault, .fault_from_ns = second});
      rig.run(600 * ms);
      ASSERT_EQ(rig.bus.state(), BusState::ready) << seed;
      rig.command_all(0.05, 1);
      rig.run(2 * second);
      for (std::size_t i = 0; i < 7; ++i) {
        const bool broken = i == 2 && fault != ServoFault::none;
        EXPECT_LE(rig.peer.largest_current(i), most) << seed;
        EXPECT_EQ(rig.bus.reading(i).enabled, broken && fault != ServoFault::silence ? 0 : 1) << seed << ' ' << i;
        const MotorFault expected = !broken                    ? MotorFault::none
                                    : fault == ServoFault::hot ? MotorFault::hot
                                                               : MotorFault::not_responding;
        EXPECT_EQ(rig.bus.reading(i).fault, expected) << seed << ' ' << i;
        EXPECT_EQ(rig.goal(i), broken ? 0 : most);
      }
      EXPECT_EQ(rig.peer.lost_goals(), 0);
    }
  }
}

}  // namespace tactus::devices::dynamixel::bus_test
