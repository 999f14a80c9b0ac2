// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/feetech/feetech_bus.hpp>
#include <tactus/hardware/devices/motor_link.hpp>
#include <tactus/hardware/emulation/feetech/feetech_peer.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <cstdint>
#include <string>

#include "tests/devices/dynamixel/bench.hpp"
#include "tests/devices/seeds.hpp"
#include <gtest/gtest.h>

/// Servos that are to have no power, whatever they report of themselves.
namespace tactus::devices {
namespace servo_off_test {

using dynamixel::bus_test::ms;
using emulation::ServoFault;
using emulation::dynamixel::DynamixelPeer;
using emulation::feetech::FeetechPeer;
using wire::Paced;

struct Fault {
  ServoFault kind = ServoFault::none;  ///< of the second
  std::int64_t from_ns = 0;
  std::uint8_t error = 0;
};

/// Three servos of one make behind a line, in virtual time.
template <class Bus, class Peer>
struct Bench {
  explicit Bench(const Fault& fault) : peer(peer_of(fault)), bus(bus_of()) {
    line = std::make_unique<Paced>(peer, wire::byte_ns(1'000'000), Paced::Line::half_duplex);
  }
  static Peer peer_of(const Fault& fault) {
    typename Peer::Params params;
    params.servos.clear();
    for (std::int64_t id = 1; id <= 3; ++id) {
      typename Peer::Servo servo{.id = id};
      if (id == 2) {
        servo.fault = fault.kind;
        servo.fault_from_ns = fault.from_ns;
        servo.error = fault.error;
      }
      params.servos.push_back(servo);
    }
    return Peer::make(params).value();
  }
  static Bus bus_of() {
    typename Bus::Params params;
    for (std::int64_t id = 1; id <= 3; ++id) {
      if constexpr (std::is_same_v<Bus, feetech::FeetechBus>) {
        params.motors.push_back({.id = id, .model = feetech::FeetechModel::hls3625, .torque_Nm_per_A = 0.8});
      } else {
        params.motors.push_back({.id = id});
      }
    }
    return Bus::make(params).value();
  }
  void run(std::int64_t duration_ns) {
    wire::join(bus, *line, now_ns, now_ns + duration_ns);
    now_ns += duration_ns;
    peer.advance(now_ns);
  }
  void run_until(std::int64_t at_ns) { run(at_ns - now_ns); }
  void command_all(std::int64_t enabled) {
    for (std::size_t i = 0; i < bus.motors(); ++i) bus.command(i, {.torque_Nm = 0.05, .enabled = enabled});
  }
  [[nodiscard]] bool torque_on(std::size_t servo) const {
    return peer.stored(servo, std::is_same_v<Bus, feetech::FeetechBus> ? 40 : 64, 1) != 0;
  }

  Peer peer;
  Bus bus;
  std::unique_ptr<Paced> line;
  std::int64_t now_ns = 0;
};
using DynamixelBench = Bench<dynamixel::DynamixelBus, DynamixelPeer>;
using FeetechBench = Bench<feetech::FeetechBus, FeetechPeer>;

template <class OneBench>
class ServoOff : public testing::Test {};
using Makes = testing::Types<DynamixelBench, FeetechBench>;
TYPED_TEST_SUITE(ServoOff, Makes);

constexpr std::int64_t ready_ns = 250 * ms;

TYPED_TEST(ServoOff, AnErrorByteThatIsNotExplainedWhileDrivingIsAFaultAndTakesThePower) {
  for (int byte = 0; byte < 256; ++byte) {
    for (std::int64_t seed = 1; seed <= seeds(1); ++seed) {
      const std::string what = std::to_string(byte) + " seed " + std::to_string(seed);
      signal::Random random(static_cast<std::uint64_t>(1000 * seed + byte));
      const std::int64_t from_ns = 320 * ms + static_cast<std::int64_t>(random.uniform(0.0, 30e6));
      TypeParam bench({ServoFault::error, from_ns, static_cast<std::uint8_t>(byte)});
      bench.run(ready_ns);
      ASSERT_EQ(bench.bus.state(), BusState::ready) << what;
      bench.command_all(1);
      bench.run_until(from_ns);
      ASSERT_TRUE(bench.torque_on(1)) << what;
      // A known refusal is a mistake of the line until it lasts for as long as a silence may.
      bench.run(150 * ms);
      EXPECT_EQ(bench.torque_on(1), byte == 0) << what;
      EXPECT_EQ(bench.bus.reading(1).fault == MotorFault::none, byte == 0) << what;
      EXPECT_EQ(bench.bus.reading(1).status & 0xff, byte) << what;
      EXPECT_TRUE(bench.torque_on(0)) << what;
      EXPECT_EQ(bench.bus.reading(0).fault, MotorFault::none) << what;
    }
  }
}

TYPED_TEST(ServoOff, WhateverErrorByteAServoReportsItIsOffInTimeAndToldWhereItDoesNotSaySo) {
  for (int byte = 0; byte < 256; ++byte) {
    for (std::int64_t seed = 1; seed <= seeds(1); ++seed) {
      const std::string what = std::to_string(byte) + " seed " + std::to_string(seed);
      signal::Random random(static_cast<std::uint64_t>(1000 * seed + byte));
      const std::int64_t release_ns = 340 * ms;
      const std::int64_t from_ns = release_ns + static_cast<std::int64_t>(random.uniform(-20e6, 2e6));
      TypeParam bench({ServoFault::error, from_ns, static_cast<std::uint8_t>(byte)});
      bench.run(ready_ns);
      bench.command_all(1);
      bench.run_until(release_ns);
      bench.command_all(0);
      bench.run(off_within_ns);
      for (const std::size_t servo : {0U, 1U, 2U}) EXPECT_FALSE(bench.torque_on(servo)) << what << ' ' << servo;
      for (const std::size_t servo : {0U, 2U}) EXPECT_EQ(bench.bus.reading(servo).off, 1) << what << ' ' << servo;
      // One that does not answer to the question whether it is off has not said so.
      const bool answers = std::is_same_v<TypeParam, FeetechBench> || (byte & 0x7f) == 0;
      if (from_ns > release_ns) continue;  // it may have said so before
      EXPECT_EQ(powered(1, bench.bus.reading(1)).has_value(), !answers) << what;
    }
  }
}

TYPED_TEST(ServoOff, AServoThatIgnoresItIsToldAndGetsNoPowerAgain) {
  TypeParam bench({ServoFault::ignores_disable, 300 * ms});
  bench.run(ready_ns);
  bench.command_all(1);
  bench.run_until(340 * ms);
  ASSERT_TRUE(bench.torque_on(1));
  bench.command_all(0);
  bench.run(off_within_ns + 10 * ms);
  EXPECT_FALSE(bench.torque_on(0));
  EXPECT_EQ(bench.bus.reading(0).off, 1);
  EXPECT_EQ(bench.bus.reading(1).fault, MotorFault::stays_on);
  const auto told = powered(1, bench.bus.reading(1));
  ASSERT_TRUE(told);
  EXPECT_EQ(servo_status_text(told->status), "error byte 0x00, torque enable 1");
  bench.run(400 * ms);
  if (std::is_same_v<TypeParam, DynamixelBench>) {
    EXPECT_EQ(bench.peer.stored(1, 98, 1), 0xff) << "its watchdog found the bus silent";
  }
  bench.command_all(1);
  bench.run(300 * ms);
  EXPECT_EQ(bench.bus.reading(1).fault, MotorFault::stays_on);
  EXPECT_EQ(bench.bus.reading(1).enabled, 1) << "it may have power";
}

TYPED_TEST(ServoOff, AServoThatIsOnAndStaysOnWhenItIsAskedMakesTheBusRefused) {
  // Another program left it with power.
  TypeParam bench({ServoFault::ignores_disable, 300 * ms});
  bench.run(ready_ns);
  bench.command_all(1);
  bench.run_until(340 * ms);
  ASSERT_TRUE(bench.torque_on(1));
  bench.bus = TypeParam::bus_of();
  bench.run(300 * ms);
  EXPECT_EQ(bench.bus.state(), BusState::refused);
  EXPECT_EQ(bench.bus.reading(1).fault, MotorFault::stays_on);
  EXPECT_EQ(
      describe(*bench.bus.problem()),
      "servo 2 was commanded to switch off and does not report that it is off (error byte 0x00, torque enable 1): "
      "switch off its supply, wait until it is at rest, and switch it on again");
}

}  // namespace servo_off_test
}  // namespace tactus::devices
