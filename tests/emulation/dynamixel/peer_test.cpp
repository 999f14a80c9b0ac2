// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/emulation/dynamixel/dynamixel_peer.hpp>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::emulation::dynamixel::peer_test {

using Bytes = std::vector<std::uint8_t>;
constexpr std::int64_t ms = 1'000'000;
constexpr double step_rad = 2.0 * std::numbers::pi / 4096.0;

/// Speaks to a peer without a line between; ids 1 and so on.
struct Bench {
  explicit Bench(std::vector<DynamixelPeer::Servo> servos = {{.id = 1}, {.id = 2}}, LineFaults line = {})
      : peer(DynamixelPeer::make({.servos = std::move(servos), .line = line}).value()) {}

  /// All that comes within a second of waiting for it.
  Bytes ask(const Bytes& packet) {
    peer.hear(packet, now_ns);
    Bytes answer;
    answered_ns = peer.wakes_ns();
    while (peer.wakes_ns() < now_ns + 1000 * ms) {
      const auto bytes = peer.say(peer.wakes_ns());
      answer.insert(answer.end(), bytes.begin(), bytes.end());
    }
    return answer;
  }
  /// Writes to servo 1 and gives its error byte back.
  int write(std::uint8_t address, Bytes data) {
    Bytes packet{0xff, 0xff, 0xfd, 0, 1, static_cast<std::uint8_t>(5 + data.size()), 0, 3, address, 0};
    packet.insert(packet.end(), data.begin(), data.end());
    const Bytes answer = ask(closed(packet));
    return answer.size() == 11 ? answer[8] : -1;
  }
  int read(std::uint8_t address, std::uint8_t bytes) {
    const Bytes answer = ask(closed({0xff, 0xff, 0xfd, 0, 1, 7, 0, 2, address, 0, bytes, 0}));
    return answer.size() > 8 ? answer[8] : -1;
  }
  /// With its CRC, by long division.
  static Bytes closed(Bytes packet) {
    std::uint32_t rest = 0;
    Bytes padded = packet;
    padded.insert(padded.end(), 2, 0);
    for (const std::uint8_t byte : padded) {
      for (int bit = 7; bit >= 0; --bit) {
        rest = (rest << 1) | ((byte >> bit) & 1U);
        if ((rest & 0x10000U) != 0) rest ^= 0x18005U;
      }
    }
    packet.push_back(static_cast<std::uint8_t>(rest));
    packet.push_back(static_cast<std::uint8_t>(rest >> 8));
    return packet;
  }

  DynamixelPeer peer;
  std::int64_t now_ns = 0, answered_ns = 0;
};

TEST(DynamixelPeer, AnswersTheVectorsOfThePagesWithTheirBytes) {
  Bench bench;
  bench.peer.joint(0).position_rad = 166 * step_rad;
  EXPECT_EQ(bench.ask({0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x07, 0x00, 0x02, 0x84, 0x00, 0x04, 0x00, 0x1D, 0x15}),
            (Bytes{0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x08, 0x00, 0x55, 0x00, 0xA6, 0x00, 0x00, 0x00, 0x8C, 0xC0}));
  // Mode 0, torque on, goal current +100 and -100 by sync write.
  EXPECT_EQ(bench.ask({0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x06, 0x00, 0x03, 0x0B, 0x00, 0x00, 0x42, 0xE3}).size(), 11U);
  EXPECT_EQ(bench.peer.stored(0, 11, 1), 0);
  EXPECT_EQ(bench.ask({0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x06, 0x00, 0x03, 0x40, 0x00, 0x01, 0xDB, 0x66}).size(), 11U);
  EXPECT_EQ(bench.peer.stored(0, 64, 1), 1);
  EXPECT_TRUE(bench
                  .ask({0xFF, 0xFF, 0xFD, 0x00, 0xFE, 0x0D, 0x00, 0x83, 0x66, 0x00,
                        0x02, 0x00, 0x01, 0x64, 0x00, 0x02, 0x9C, 0xFF, 0xE1, 0xDB})
                  .empty());
  EXPECT_EQ(bench.peer.stored(0, 102, 2), 100);
  EXPECT_EQ(bench.peer.stored(1, 102, 2), 0x10000 - 100);
  // Stuffed: goal position FF FF FD FF.
  EXPECT_EQ(
      bench.ask({0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x0A, 0x00, 0x03, 0x74, 0x00, 0xFF, 0xFF, 0xFD, 0xFD, 0xFF, 0x23, 0xE5})
          .size(),
      11U);
  EXPECT_EQ(bench.peer.stored(0, 116, 4), 0xfffdffff);
}

TEST(DynamixelPeer, TellsItsStateAsThePageDoes) {
  Bench bench(std::vector{DynamixelPeer::Servo{.id = 1}});
  EXPECT_EQ(bench.write(11, {0}), 0);
  EXPECT_EQ(bench.write(102, {5, 0}), 0);
  EXPECT_EQ(bench.write(64, {1}), 0);
  bench.peer.joint(0).position_rad = 2048 * step_rad;
  bench.peer.joint(0).velocity_rad_per_s = -3 * 0.229 * 2.0 * std::numbers::pi / 60.0;
  EXPECT_EQ(bench.ask(Bench::closed({0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x07, 0x00, 0x02, 0x7E, 0x00, 0x0A, 0x00})),
            (Bytes{0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x0E, 0x00, 0x55, 0x00, 0x05, 0x00,
                   0xFD, 0xFF, 0xFF, 0xFF, 0x00, 0x08, 0x00, 0x00, 0x7A, 0xB2}));
  // What must be stuffed is.
  bench.peer.joint(0).position_rad = 0x00fdffff * step_rad;
  EXPECT_EQ(bench.ask({0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x07, 0x00, 0x02, 0x84, 0x00, 0x04, 0x00, 0x1D, 0x15}),
            (Bench::closed({0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x09, 0x00, 0x55, 0x00, 0xFF, 0xFF, 0xFD, 0xFD, 0x00})));
}

TEST(DynamixelPeer, AnswersAFastReadAsTheEManualsExample) {
  Bench bench({{.id = 3}, {.id = 7}, {.id = 4}});
  const std::array<int, 3> steps{166, 2079, 1023};
  for (std::size_t i = 0; i < 3; ++i) bench.peer.joint(i).position_rad = steps[i] * step_rad;
  const Bytes all{0xFF, 0xFF, 0xFD, 0x00, 0xFE, 0x19, 0x00, 0x55, 0x00, 0x03, 0xA6, 0x00, 0x00, 0x00, 0x84, 0x08,
                  0x00, 0x07, 0x1F, 0x08, 0x00, 0x00, 0x16, 0xCA, 0x00, 0x04, 0xFF, 0x03, 0x00, 0x00, 0xD1, 0x9E};
  const Bytes request{0xFF, 0xFF, 0xFD, 0x00, 0xFE, 0x0A, 0x00, 0x8A, 0x84, 0x00, 0x04, 0x00, 0x03, 0x07, 0x04};
  EXPECT_EQ(bench.ask(Bench::closed(request)), all);
}

TEST(DynamixelPeer, BehindASilentServoAFastReadEndsAndAPlainOneLeavesItsPlaceEmpty) {
  Bench bench({{.id = 3}, {.id = 7, .fault = ServoFault::silence}, {.id = 4}});
  const Bytes ids{0x84, 0x00, 0x04, 0x00, 0x03, 0x07, 0x04};
  Bytes fast{0xFF, 0xFF, 0xFD, 0x00, 0xFE, 0x0A, 0x00, 0x8A}, plain{0xFF, 0xFF, 0xFD, 0x00, 0xFE, 0x0A, 0x00, 0x82};
  fast.insert(fast.end(), ids.begin(), ids.end());
  plain.insert(plain.end(), ids.begin(), ids.end());
  EXPECT_EQ(bench.ask(Bench::closed(fast)).size(), 16U);  // header, and the block of servo 3
  EXPECT_EQ(bench.ask(Bench::closed(plain)).size(), 30U);
  bench.peer.hear(Bench::closed(plain), 0);
  EXPECT_EQ(bench.peer.wakes_ns(), 500'000);  // the factory's return delay
  bench.peer.say(500'000);
  EXPECT_EQ(bench.peer.wakes_ns(), 2 * 500'000 + 2 * 150'000);  // 15 bytes at 1 Mbit/s, twice
}

TEST(DynamixelPeer, AnswersAfterTheReturnDelay) {
  Bench bench;
  EXPECT_EQ(bench.read(132, 4), 0);
  EXPECT_EQ(bench.answered_ns, 500'000);
  EXPECT_EQ(bench.write(9, {0}), 0);
  EXPECT_EQ(bench.read(132, 4), 0);
  EXPECT_EQ(bench.answered_ns, 0);
}

TEST(DynamixelPeer, RefusesWhatAServoRefuses) {
  Bench bench;
  EXPECT_EQ(bench.write(11, {17}), 4);           // range
  EXPECT_EQ(bench.write(102, {0xd7, 6}), 4);     // 1751 of 1750
  EXPECT_EQ(bench.write(102, {0x29, 0xf9}), 4);  // -1751
  EXPECT_EQ(bench.write(102, {0x2a, 0xf9}), 0);
  EXPECT_EQ(bench.write(102, {1}), 5);           // half of it
  EXPECT_EQ(bench.write(132, {0, 0, 0, 0}), 7);  // read only
  EXPECT_EQ(bench.write(101, {0}), 7);           // within another
  EXPECT_EQ(bench.read(66, 1), 7);
  EXPECT_EQ(bench.read(146, 2), 4);
  EXPECT_EQ(bench.write(64, {1}), 0);
  EXPECT_EQ(bench.write(11, {0}), 7);  // locked while torque is on
  EXPECT_EQ(bench.peer.stored(0, 11, 1), 3);
  EXPECT_EQ(bench.write(64, {0}), 0);
  EXPECT_EQ(bench.write(11, {0}), 0);
  const Bytes wrong{0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x03, 0x00, 0x01, 0x19, 0x4F};
  EXPECT_EQ(bench.ask(wrong)[8], 3);
  EXPECT_EQ(bench.ask(Bench::closed({0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x03, 0x00, 0x77}))[8], 2);
}

TEST(DynamixelPeer, TheWatchdogTakesTheForceAndTheGoalUntilItIsToldZero) {
  Bench bench(std::vector{DynamixelPeer::Servo{.id = 1}});
  bench.write(11, {0});
  bench.write(102, {100, 0});
  bench.write(98, {5});
  bench.write(64, {1});
  bench.now_ns = 99 * ms;
  EXPECT_EQ(bench.read(98, 1), 0);
  EXPECT_EQ(bench.peer.stored(0, 98, 1), 5);
  bench.peer.advance(198 * ms);
  EXPECT_GT(bench.peer.joint(0).velocity_rad_per_s, 0.0);
  bench.peer.advance(1000 * ms);  // it coasts from 199 ms on, and friction stops it
  EXPECT_EQ(bench.peer.stored(0, 98, 1), 0xff);
  EXPECT_EQ(bench.peer.joint(0).velocity_rad_per_s, 0.0);
  EXPECT_EQ(bench.peer.stored(0, 126, 2), 0);
  bench.now_ns = 1000 * ms;
  EXPECT_EQ(bench.write(102, {1, 0}), 4);
  EXPECT_EQ(bench.write(98, {0}), 0);
  EXPECT_EQ(bench.write(102, {1, 0}), 0);
}

TEST(DynamixelPeer, AHotServoTakesItsTorqueAwayAndAlerts) {
  Bench bench(std::vector{DynamixelPeer::Servo{.id = 1, .fault = ServoFault::hot, .fault_from_ns = 10 * ms}});
  bench.write(64, {1});
  bench.now_ns = 20 * ms;
  EXPECT_EQ(bench.read(132, 4), 0x80);
  EXPECT_EQ(bench.peer.stored(0, 70, 1), 4);
  EXPECT_EQ(bench.peer.stored(0, 64, 1), 0);
  EXPECT_EQ(bench.write(64, {1}), 0x81);
}

TEST(DynamixelPeer, TheJointObeysItsLaw) {
  ServoJoint joint;
  joint.advance(1000 * ms, 0.99 * joint.friction_Nm);
  EXPECT_EQ(joint.position_rad, 0.0);
  // (0.05 - 0.02) N m against 0.02 N m s/rad, with 0.01 kg m^2: the speed nears 1.5 rad/s in half a second.
  joint.advance(1500 * ms, 0.05);
  EXPECT_NEAR(joint.velocity_rad_per_s, 1.5 * (1.0 - std::exp(-1.0)), 1e-3);
  EXPECT_NEAR(joint.position_rad, 1.5 * 0.5 * std::exp(-1.0), 1e-3);
  joint.advance(10'000 * ms, 0.0);
  EXPECT_EQ(joint.velocity_rad_per_s, 0.0);
}

TEST(ServoFaults, AreReadAsTheyAreWritten) {
  const auto fault = parse_servo_fault("power-cycle:12@0.5");
  ASSERT_TRUE(fault) << describe(fault.error());
  EXPECT_EQ(fault->servo, ServoFault::power_cycle);
  EXPECT_EQ(fault->id, 12);
  EXPECT_EQ(fault->from_ns, 500 * ms);
  EXPECT_EQ(parse_servo_fault("hot")->id, -1);
  EXPECT_EQ(parse_servo_fault("garbage")->line.garbage, 0.01);
  EXPECT_EQ(parse_servo_fault("echo")->line.echo, 1);
  const auto error = parse_servo_fault("error=0x24:2@5");
  ASSERT_TRUE(error) << describe(error.error());
  EXPECT_EQ(error->servo, ServoFault::error);
  EXPECT_EQ(error->error, 0x24);
  EXPECT_EQ(error->id, 2);
  EXPECT_EQ(parse_servo_fault("error=255")->error, 255);
  EXPECT_EQ(parse_servo_fault("ignores-disable")->servo, ServoFault::ignores_disable);
  for (const char* wrong : {"", "none", "hot:", "hot:x", "hot:1.5", "hot:-1", "hot@x", "hot@nan", "echo:1", "split@2",
                            "error", "error=", "error=256", "error=0xg", "hot=1"}) {
    const auto refused = parse_servo_fault(wrong);
    ASSERT_FALSE(refused) << wrong;
    EXPECT_EQ(refused.error().code, ErrorCode::syntax);
    EXPECT_NE(refused.error().message.find("KIND[:ID][@SECONDS]"), std::string::npos);
  }
}

TEST(DynamixelPeer, AFaultBeginsByTheTimeOfTheFirstByte) {
  Bench bench(std::vector{DynamixelPeer::Servo{.id = 1, .fault = ServoFault::silence, .fault_from_ns = 10 * ms}});
  bench.now_ns = 5'000'000 * ms;
  EXPECT_EQ(bench.read(132, 4), 0);
  bench.now_ns += 9 * ms;
  EXPECT_EQ(bench.read(132, 4), 0);
  bench.now_ns += 2 * ms;
  EXPECT_EQ(bench.read(132, 4), -1);
}

TEST(DynamixelPeer, AFaultThatIsInjectedCountsFromThenOn) {
  Bench bench(std::vector{DynamixelPeer::Servo{.id = 1}});
  bench.now_ns = 5'000'000 * ms;
  EXPECT_EQ(bench.read(132, 4), 0);
  ASSERT_FALSE(bench.peer.inject({.servo = ServoFault::silence, .id = 1, .from_ns = 10 * ms}, bench.now_ns));
  bench.now_ns += 9 * ms;
  EXPECT_EQ(bench.read(132, 4), 0);
  bench.now_ns += 2 * ms;
  EXPECT_EQ(bench.read(132, 4), -1);
  EXPECT_TRUE(bench.peer.inject({.servo = ServoFault::none}, bench.now_ns)) << "of the line";
  EXPECT_TRUE(bench.peer.inject({.servo = ServoFault::low_limit}, bench.now_ns)) << "from the start only";
}

TEST(DynamixelPeer, ItHasPowerUntilItsWatchdogActs) {
  Bench bench(std::vector{DynamixelPeer::Servo{.id = 1}});
  EXPECT_FALSE(bench.peer.has_power(0));
  EXPECT_EQ(bench.write(64, {1}), 0);
  EXPECT_TRUE(bench.peer.has_power(0));
  EXPECT_EQ(bench.write(98, {5}), 0);  // 100 ms
  bench.peer.advance(bench.now_ns + 90 * ms);
  EXPECT_TRUE(bench.peer.has_power(0));
  bench.peer.advance(bench.now_ns + 110 * ms);
  EXPECT_FALSE(bench.peer.has_power(0));
}

TEST(DynamixelPeer, WithoutPowerItLosesTheTurnsThatItCounted) {
  Bench bench(std::vector{DynamixelPeer::Servo{.id = 1, .fault = ServoFault::power_cycle, .fault_from_ns = 10 * ms}});
  bench.peer.joint(0).position_rad = 3.25 * 2.0 * std::numbers::pi;
  EXPECT_EQ(bench.read(132, 4), 0);
  EXPECT_EQ(bench.peer.stored(0, 132, 4), 3 * 4096 + 1024);
  bench.now_ns += 400 * ms;
  EXPECT_EQ(bench.read(132, 4), 0);
  EXPECT_EQ(bench.peer.stored(0, 132, 4), 1024);
  // From there it counts turns again.
  bench.peer.joint(0).position_rad -= 2.0 * std::numbers::pi;
  bench.now_ns += ms;
  EXPECT_EQ(bench.read(132, 4), 0);
  EXPECT_EQ(static_cast<std::int32_t>(bench.peer.stored(0, 132, 4)), 1024 - 4096);
}

TEST(DynamixelPeer, FaultsOfTheLineAreThoseOfTheSeed) {
  const auto run = [](std::int64_t seed) {
    auto peer = DynamixelPeer::make({.line = {.corrupt = 0.3, .garbage = 0.3, .split = 0.3, .echo = 1}, .seed = seed});
    Bytes all;
    for (int i = 0; i < 50; ++i) {
      const Bytes ping{0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x03, 0x00, 0x01, 0x19, 0x4E};
      peer->hear(ping, i * ms);
      for (auto bytes = peer->say(i * ms + 900'000); !bytes.empty(); bytes = peer->say(i * ms + 900'000)) {
        all.insert(all.end(), bytes.begin(), bytes.end());
      }
    }
    return all;
  };
  EXPECT_EQ(run(3), run(3));
  EXPECT_NE(run(3), run(4));
  EXPECT_GT(run(3).size(), 50U * 24U);  // echo and answer of each, and garbage
}

}  // namespace tactus::emulation::dynamixel::peer_test
