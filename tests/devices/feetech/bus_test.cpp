// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/feetech/feetech_bus.hpp>
#include <tactus/hardware/emulation/feetech/feetech_peer.hpp>
#include <tactus/hardware/wire/join.hpp>
#include <tactus/hardware/wire/paced.hpp>

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>

#include "tests/devices/seeds.hpp"
#include <gtest/gtest.h>
#include <tests/allocation_counter.hpp>

/// The driver joined to its peer in virtual time, over a line that takes the time that a real one takes.
namespace tactus::devices::feetech::bus_test {

using emulation::LineFaults;
using emulation::ServoFault;
using emulation::feetech::FeetechPeer;
using emulation::feetech::Make;
using wire::Paced;

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t second = 1000 * ms;
constexpr double torque_Nm_per_A = 0.8;
constexpr double torque_of_one_Nm = 0.0065 * torque_Nm_per_A;

struct Setting {
  std::size_t servos = 6;
  Make make = Make::hls3625;
  LineFaults line{};
  std::int64_t seed = 1;
  ServoFault fault = ServoFault::none;  ///< of the third
  std::int64_t fault_from_ns = 0;
};

struct Rig {
  explicit Rig(const Setting& setting) : peer(peer_of(setting)), bus(bus_of(setting)) {
    line = std::make_unique<Paced>(peer, wire::byte_ns(1'000'000), Paced::Line::half_duplex);
  }
  static FeetechPeer peer_of(const Setting& setting) {
    FeetechPeer::Params params;
    params.servos.clear();
    for (std::size_t i = 0; i < setting.servos; ++i) {
      params.servos.push_back({.id = static_cast<std::int64_t>(i + 1),
                               .make = setting.make,
                               .fault = i == 2 ? setting.fault : ServoFault::none,
                               .fault_from_ns = setting.fault_from_ns});
    }
    params.line = setting.line;
    params.seed = setting.seed;
    return FeetechPeer::make(params).value();
  }
  static FeetechBus bus_of(const Setting& setting) {
    FeetechBus::Params params;
    const bool takes_current = setting.make == Make::hls3625;
    for (std::size_t i = 0; i < setting.servos; ++i) {
      params.motors.push_back({.id = static_cast<std::int64_t>(i + 1),
                               .model = takes_current ? FeetechModel::hls3625 : FeetechModel::sts3215,
                               .torque_Nm_per_A = takes_current ? torque_Nm_per_A : 0.0});
    }
    return FeetechBus::make(params).value();
  }
  void run(std::int64_t duration_ns) {
    wire::join(bus, *line, now_ns, now_ns + duration_ns);
    now_ns += duration_ns;
    peer.advance(now_ns);
  }
  void command_all(double torque_Nm, std::int64_t enabled) {
    for (std::size_t i = 0; i < bus.motors(); ++i) bus.command(i, {.torque_Nm = torque_Nm, .enabled = enabled});
  }
  std::int64_t goal(std::size_t servo) const { return peer.stored(servo, 44, 2); }
  bool torque_on(std::size_t servo) const { return peer.stored(servo, 40, 1) != 0; }

  FeetechPeer peer;
  FeetechBus bus;
  std::unique_ptr<Paced> line;
  std::int64_t now_ns = 0;
};

TEST(FeetechBus, AnStsIsALeaderWithoutForceWhateverIsCommanded) {
  Rig rig({.make = Make::sts3215});
  rig.run(300 * ms);
  ASSERT_EQ(rig.bus.state(), BusState::ready);
  rig.command_all(0.5, 1);
  rig.peer.joint(1).position_rad = 1.0;
  rig.peer.joint(1).velocity_rad_per_s = -2.0;
  rig.run(2 * ms);
  rig.peer.joint(1).velocity_rad_per_s = -2.0;
  rig.run(2 * ms);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_FALSE(rig.torque_on(i));
    EXPECT_EQ(rig.bus.reading(i).enabled, 0);
    EXPECT_EQ(rig.bus.reading(i).fault, MotorFault::none);
    EXPECT_EQ(rig.bus.reading(i).torque_Nm, 0.0);
    EXPECT_EQ(rig.peer.stored(i, 7, 1), 0);  // return delay
    EXPECT_EQ(rig.goal(i), 0);               // there it would be a time
  }
  EXPECT_NEAR(rig.bus.reading(1).position_rad, 1.0, 0.02);
  EXPECT_NEAR(rig.bus.reading(1).velocity_rad_per_s, -2.0, 0.1);
  EXPECT_EQ(rig.bus.reading(1).temperature_C, 31.0);
  EXPECT_EQ(rig.bus.limited(), 6);
}

TEST(FeetechBus, AnHlsGivesTheTorqueThatIsCommanded) {
  Rig rig({});
  rig.run(300 * ms);
  ASSERT_EQ(rig.bus.state(), BusState::ready);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_FALSE(rig.torque_on(i));
    EXPECT_EQ(rig.peer.stored(i, 33, 1), 2);
    EXPECT_EQ(rig.peer.stored(i, 55, 1), 1);  // locked again
  }
  rig.command_all(-0.1, 1);
  rig.run(100 * ms);
  const std::int64_t units = std::lround(0.1 / torque_of_one_Nm);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_TRUE(rig.torque_on(i));
    EXPECT_EQ(rig.goal(i), 0x8000 + units);
    EXPECT_NEAR(rig.bus.reading(i).torque_Nm, -0.1, torque_of_one_Nm);
    EXPECT_LT(rig.bus.reading(i).velocity_rad_per_s, -0.1);
    EXPECT_NEAR(rig.bus.reading(i).velocity_rad_per_s, rig.peer.joint(i).velocity_rad_per_s, 0.1);
    EXPECT_EQ(rig.peer.largest_current(i), units);
  }
  rig.command_all(0.1, 0);
  rig.run(50 * ms);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_FALSE(rig.torque_on(i));
    EXPECT_EQ(rig.goal(i), 0);
  }
}

TEST(FeetechBus, ItsCyclesTakeTheTimeOfTheirBytesAndHardlyMore) {
  // The page's: six servos, 8 bytes read, 2 written, 800 Hz; here each servo's answer has 15 bytes.
  const auto most = [](double servos, double written, double read) {
    return 1e6 / 10.0 / (written + 8.0 + servos + servos * (6.0 + read));
  };
  EXPECT_NEAR(most(6, 8 + 18, 8), 806, 1);
  for (const std::size_t servos : {6U, 7U, 8U}) {
    for (const Make make : {Make::sts3215, Make::hls3625}) {
      Rig rig({.servos = servos, .make = make});
      rig.run(300 * ms);
      rig.command_all(0.01, 1);
      rig.run(100 * ms);
      const std::int64_t before = rig.bus.cycles();
      rig.run(2 * second);
      const auto n = static_cast<double>(servos);
      const double limit = make == Make::hls3625 ? most(n, 8 + 3 * n, 15) : most(n, 0, 8);
      const double share = static_cast<double>(rig.bus.cycles() - before) / 2.0 / limit;
      EXPECT_GE(share, 0.95) << servos;
      EXPECT_LE(share, 1.0 + 0.5 / limit) << servos;  // one may have begun before
    }
  }
}

TEST(FeetechBus, ASilentServoCostsNoOtherItsData) {
  Rig rig({.fault = ServoFault::silence, .fault_from_ns = 600 * ms});
  rig.run(300 * ms);
  rig.command_all(0.01, 1);
  rig.run(290 * ms);
  const std::int64_t cycles = rig.bus.cycles(), before = rig.bus.reading(3).answers;
  rig.run(2 * second);
  EXPECT_GE(rig.bus.reading(3).answers - before, rig.bus.cycles() - cycles - 1);
  EXPECT_EQ(rig.bus.reading(2).fault, MotorFault::not_responding);
  EXPECT_EQ(rig.bus.reading(3).fault, MotorFault::none);
  EXPECT_EQ(rig.goal(2), 0);
}

TEST(FeetechBus, PositionsGoOnWhereTheWiresNumberWraps) {
  Rig rig({.make = Make::sts3215});
  rig.run(300 * ms);
  for (int turn = 0; turn < 50; ++turn) {
    rig.peer.joint(0).position_rad -= 0.7;
    rig.peer.joint(5).position_rad += 0.7;
    rig.run(3 * ms);
  }
  EXPECT_NEAR(rig.bus.reading(0).position_rad, -35.0, 0.01 + 2 * std::numbers::pi / 4096);
  EXPECT_NEAR(rig.bus.reading(5).position_rad, 35.0, 0.01);
}

TEST(FeetechBus, ATorqueBeyondTheProtectionCurrentIsSentAsThatAndCounted) {
  Rig rig({.fault = ServoFault::low_limit});
  rig.run(300 * ms);
  rig.command_all(0.5, 1);  // of 96 units
  rig.run(100 * ms);
  EXPECT_EQ(rig.bus.limited(), 1);
  EXPECT_EQ(rig.goal(2), 50);
  EXPECT_EQ(rig.goal(3), 96);
  EXPECT_EQ(rig.bus.reading(2).fault, MotorFault::none);
}

TEST(FeetechBus, TwoServosWithOneIdAreToldWhetherTheirAnswersMeetOrNot) {
  for (const std::int64_t echo : {0, 1}) {
    Rig twins({.line = {.echo = echo}, .fault = ServoFault::twin});
    twins.run(500 * ms);
    EXPECT_EQ(twins.bus.state(), BusState::refused);
    EXPECT_EQ(describe(*twins.bus.problem()).find("servo 3 answers twice: two servos have this id"), 0U);
    Rig clash({.line = {.echo = echo}, .fault = ServoFault::clash});
    clash.run(500 * ms);
    EXPECT_EQ(describe(*clash.bus.problem()).find("servo 3 is answered for by bytes that are no packet: "), 0U);
  }
}

TEST(FeetechBus, AnotherModelIsRefusedByItsName) {
  Rig rig({.fault = ServoFault::wrong_model});
  rig.command_all(0.05, 1);
  rig.run(500 * ms);
  EXPECT_EQ(rig.bus.state(), BusState::refused);
  EXPECT_EQ(describe(*rig.bus.problem()),
            "servo 3 reports model number 777 (STS3215) where HLS3625 is stated: state the model that is there, or "
            "change the servo");
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(rig.peer.largest_current(i), 0);
}

TEST(FeetechBus, WhateverTheLineDoesNoServoGivesMoreThanItWasAskedFor) {
  const auto most = std::lround(0.1 / torque_of_one_Nm);
  for (const ServoFault fault : {ServoFault::none, ServoFault::silence, ServoFault::power_cycle, ServoFault::hot}) {
    for (std::int64_t seed = 1; seed <= seeds(25); ++seed) {
      const LineFaults line{.corrupt = seed % 2 == 0 ? 0.01 : 0.0,
                            .garbage = seed % 3 == 0 ? 0.05 : 0.0,
                            .split = seed % 4 == 1 ? 0.05 : 0.0,
                            .echo = seed / 4 % 2};
      Rig rig({.line = line, .seed = seed, .fault = fault, .fault_from_ns = second});
      rig.run(600 * ms);
      ASSERT_EQ(rig.bus.state(), BusState::ready) << seed;
      rig.command_all(0.1, 1);
      rig.run(2 * second);
      for (std::size_t i = 0; i < 6; ++i) {
        const bool broken = i == 2 && fault != ServoFault::none;
        EXPECT_LE(rig.peer.largest_current(i), most) << seed;
        EXPECT_EQ(rig.peer.stored(i, 33, 1), 2) << seed;  // also of whom was without power: it was unlocked
        const MotorFault expected = !broken                    ? MotorFault::none
                                    : fault == ServoFault::hot ? MotorFault::hot
                                                               : MotorFault::not_responding;
        EXPECT_EQ(rig.bus.reading(i).fault, expected) << seed << ' ' << i;
        EXPECT_EQ(rig.goal(i), broken ? 0 : most) << seed << " " << i;
        EXPECT_EQ(rig.torque_on(i), !broken) << seed << ' ' << i;  // also of whom hears and does not answer
      }
    }
  }
}

TEST(FeetechBus, NeitherItNorItsPeerAllocatesOnceMade) {
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

TEST(FeetechBus, WhatCannotBeABusIsRefused) {
  const auto error_of = [](FeetechBus::Params params) { return describe(FeetechBus::make(params).error()); };
  EXPECT_EQ(error_of({.motors = {{.id = 254}}}), "motors[0].id: 254 must lie between 0 and 253");
  EXPECT_EQ(error_of({.motors = {{.id = 1, .model = FeetechModel::hls3625}}}),
            "motors[0].torque_Nm_per_A: state how much torque a current of this servo gives: its stall torque over its "
            "stall current");
  EXPECT_EQ(error_of({.motors = {{.id = 1}}, .bits_per_s = 4'000'000}),
            "bits_per_s: 4000000 bit/s: the servos do 38400, 57600, 76800, 115200, 128000, 250000, 500000 and 1000000");
}

}  // namespace tactus::devices::feetech::bus_test
