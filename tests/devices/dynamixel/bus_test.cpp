#include <tactus/devices/dynamixel/dynamixel_bus.hpp>
#include <tactus/emulation/dynamixel/dynamixel_peer.hpp>
#include <tactus/wire/join.hpp>
#include <tactus/wire/paced.hpp>

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <string>

#include "tests/devices/seeds.hpp"
#include <gtest/gtest.h>
#include <tests/allocation_counter.hpp>

/// The driver joined to its peer in virtual time, over a line that takes the time that a real one takes.
namespace tactus::devices::dynamixel::bus_test {

using emulation::LineFaults;
using emulation::ServoFault;
using emulation::dynamixel::DynamixelPeer;
using wire::Paced;

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t second = 1000 * ms;

struct Setting {
  std::size_t servos = 7;
  std::int64_t bits_per_s = 1'000'000;
  bool fast = true;
  LineFaults line{};
  std::int64_t seed = 1;
  ServoFault fault = ServoFault::none;  ///< of the servo `faulty`
  std::size_t faulty = 2;
  std::int64_t fault_from_ns = 0;
  bool knows_fast = true;
};

/// XL330-M288, of which a current of 100 is 0.1 A and 0.52 / 1.47 N m/A.
constexpr double torque_of_one_Nm = 0.001 * 0.52 / 1.47;

struct Rig {
  explicit Rig(const Setting& setting) : peer(peer_of(setting)), bus(bus_of(setting)) {
    line = std::make_unique<Paced>(peer, wire::byte_ns(setting.bits_per_s), Paced::Line::half_duplex);
  }
  static DynamixelPeer peer_of(const Setting& setting) {
    DynamixelPeer::Params params;
    params.servos.clear();
    for (std::size_t i = 0; i < setting.servos; ++i) {
      DynamixelPeer::Servo servo{.id = static_cast<std::int64_t>(i + 1)};
      if (i == setting.faulty) servo.fault = setting.fault;
      servo.fault_from_ns = setting.fault_from_ns;
      params.servos.push_back(servo);
    }
    params.bits_per_s = setting.bits_per_s;
    params.line = setting.line;
    params.seed = setting.seed;
    params.knows_fast_sync_read = setting.knows_fast;
    return DynamixelPeer::make(params).value();
  }
  static DynamixelBus bus_of(const Setting& setting) {
    DynamixelBus::Params params;
    for (std::size_t i = 0; i < setting.servos; ++i) params.motors.push_back({.id = static_cast<std::int64_t>(i + 1)});
    params.bits_per_s = setting.bits_per_s;
    params.fast_sync_read = setting.fast;
    return DynamixelBus::make(params).value();
  }
  void run(std::int64_t duration_ns) {
    wire::join(bus, *line, now_ns, now_ns + duration_ns);
    now_ns += duration_ns;
    peer.advance(now_ns);
  }
  void command_all(double torque_Nm, std::int64_t enabled) {
    for (std::size_t i = 0; i < bus.motors(); ++i) bus.command(i, {.torque_Nm = torque_Nm, .enabled = enabled});
  }
  std::int64_t goal(std::size_t servo) const { return static_cast<std::int16_t>(peer.stored(servo, 102, 2)); }
  bool torque_on(std::size_t servo) const { return peer.stored(servo, 64, 1) != 0; }

  DynamixelPeer peer;
  DynamixelBus bus;
  std::unique_ptr<Paced> line;
  std::int64_t now_ns = 0;
};

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

/// The page's table, and the same arithmetic for seven: bits of write, read and answers.
double most_cycles_per_s(std::size_t servos, std::int64_t bits_per_s, bool fast) {
  const std::size_t write = 14 + 3 * servos, read = 14 + servos;
  const std::size_t answers = fast ? 8 + 14 * servos : 21 * servos;
  return static_cast<double>(bits_per_s) / (10.0 * static_cast<double>(write + read + answers));
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

TEST(DynamixelBus, ASilentServoCostsNoOtherItsDataButInOneCycle) {
  for (const bool fast : {false, true}) {
    for (std::size_t silent = 0; silent < 7; ++silent) {
      Rig rig({.fast = fast, .fault = ServoFault::silent, .faulty = silent, .fault_from_ns = 600 * ms});
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
      EXPECT_EQ(rig.bus.reading(silent).fault, MotorFault::silent);
      EXPECT_LT(rig.bus.reading(silent).heard_ns, 605 * ms);
      EXPECT_EQ(rig.goal(silent), 0);
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
            "servo 3 tells model number 1220 (XC330-T288) where XL330-M288 is stated: state the model that is there, "
            "or change the servo");
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_FALSE(rig.torque_on(i));
    EXPECT_EQ(rig.peer.largest_current(i), 0);
  }
  EXPECT_EQ(rig.bus.wakes_ns(), wire::never_ns);
}

TEST(DynamixelBus, AServoThatIsNotThereIsNamed) {
  Rig rig({.fault = ServoFault::silent, .faulty = 5});
  rig.command_all(0.05, 1);
  rig.run(500 * ms);
  EXPECT_EQ(rig.bus.state(), BusState::refused);
  EXPECT_EQ(describe(*rig.bus.problem()),
            "servo 6 does not answer at 1000000 bit/s: look at its power, its cable, its id and its bit rate");
  EXPECT_EQ(rig.bus.reading(5).fault, MotorFault::silent);
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
  Rig echo({.line = {.echo = 1}, .fault = ServoFault::silent});
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
  EXPECT_EQ(rig.bus.reading(2).fault, MotorFault::silent);
  EXPECT_GT(rig.bus.reading(2).heard_ns, 3 * second);  // it answers again
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

TEST(DynamixelBus, WhateverTheLineDoesNoServoGivesMoreThanItWasAskedFor) {
  const auto most = std::lround(0.05 / torque_of_one_Nm);
  for (const ServoFault fault : {ServoFault::none, ServoFault::silent, ServoFault::power_cycle, ServoFault::hot}) {
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
        EXPECT_EQ(rig.bus.reading(i).enabled, broken && fault != ServoFault::silent ? 0 : 1) << seed << ' ' << i;
        const MotorFault expected = !broken                    ? MotorFault::none
                                    : fault == ServoFault::hot ? MotorFault::hot
                                                               : MotorFault::silent;
        EXPECT_EQ(rig.bus.reading(i).fault, expected) << seed << ' ' << i;
        EXPECT_EQ(rig.goal(i), broken ? 0 : most);
      }
      EXPECT_EQ(rig.peer.lost_goals(), 0);
    }
  }
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
