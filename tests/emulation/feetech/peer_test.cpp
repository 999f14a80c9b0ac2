// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/emulation/feetech/feetech_peer.hpp>

#include <cstdint>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::emulation::feetech::peer_test {

using Bytes = std::vector<std::uint8_t>;
constexpr std::int64_t ms = 1'000'000;

struct Bench {
  explicit Bench(std::vector<FeetechPeer::Servo> servos)
      : peer(FeetechPeer::make({.servos = std::move(servos), .line = {}}).value()) {}
  Bytes ask(const Bytes& packet) {
    peer.hear(packet, now_ns);
    Bytes answer;
    while (peer.wakes_ns() < now_ns + 1000 * ms) {
      const auto bytes = peer.say(peer.wakes_ns());
      answer.insert(answer.end(), bytes.begin(), bytes.end());
    }
    return answer;
  }
  /// Without an answer that matters.
  void write(std::uint8_t address, Bytes data) {
    Bytes packet{0xff, 0xff, 1, static_cast<std::uint8_t>(3 + data.size()), 3, address};
    packet.insert(packet.end(), data.begin(), data.end());
    unsigned sum = 0;
    for (std::size_t i = 2; i < packet.size(); ++i) sum += packet[i];
    packet.push_back(static_cast<std::uint8_t>(~sum));
    ask(packet);
  }

  FeetechPeer peer;
  std::int64_t now_ns = 0;
};

TEST(FeetechPeer, AFaultThatIsInjectedCountsFromThenOn) {
  Bench bench({{.id = 1}, {.id = 2}});
  bench.write(40, {1});
  EXPECT_TRUE(bench.peer.has_power(0));
  EXPECT_FALSE(bench.peer.has_power(1));
  bench.now_ns = 100 * ms;
  ASSERT_FALSE(bench.peer.inject({.servo = ServoFault::ignores_disable, .id = 1, .from_ns = 50 * ms}, bench.now_ns));
  bench.now_ns = 160 * ms;
  bench.write(40, {0});
  EXPECT_TRUE(bench.peer.has_power(0));
  ASSERT_FALSE(bench.peer.inject({.servo = ServoFault::silence}, bench.now_ns));
  bench.write(40, {0});
  EXPECT_FALSE(bench.peer.has_power(0)) << "in place of the fault that it had";
  EXPECT_TRUE(bench.peer.inject({.servo = ServoFault::wrong_model}, bench.now_ns)) << "from the start only";
}

TEST(FeetechPeer, AnswersTheVectorsOfThePageWithTheirBytes) {
  Bench bench({{.id = 1, .make = Make::sts3215}, {.id = 2, .make = Make::sts3215}});
  EXPECT_EQ(bench.ask({0xFF, 0xFF, 0x01, 0x02, 0x01, 0xFB}), (Bytes{0xFF, 0xFF, 0x01, 0x02, 0x00, 0xFC}));
  EXPECT_EQ(bench.ask({0xFF, 0xFF, 0x01, 0x04, 0x03, 0x28, 0x01, 0xCE}), (Bytes{0xFF, 0xFF, 0x01, 0x02, 0x00, 0xFC}));
  EXPECT_EQ(bench.peer.stored(0, 40, 1), 1);
  // Goal positions 2048 and 1024 by sync write.
  EXPECT_TRUE(bench.ask({0xFF, 0xFF, 0xFE, 0x0A, 0x83, 0x2A, 0x02, 0x01, 0x00, 0x08, 0x02, 0x00, 0x04, 0x39}).empty());
  EXPECT_EQ(bench.peer.stored(0, 42, 2), 2048);
  EXPECT_EQ(bench.peer.stored(1, 42, 2), 1024);
  // Position 2048, velocity -10.
  bench.peer.joint(0).position_rad = std::numbers::pi;
  bench.peer.joint(0).velocity_rad_per_s = -10.0 * 2.0 * std::numbers::pi / 4096.0;
  EXPECT_EQ(bench.ask({0xFF, 0xFF, 0x01, 0x04, 0x02, 0x38, 0x04, 0xBC}),
            (Bytes{0xFF, 0xFF, 0x01, 0x06, 0x00, 0x00, 0x08, 0x0A, 0x80, 0x66}));
  // A sync read of six, of which two are there: 8 bytes each.
  EXPECT_EQ(bench.ask({0xFF, 0xFF, 0xFE, 0x0A, 0x82, 0x38, 0x08, 0x01, 0x02, 0x03, 0x04, 0x05, 0x06, 0x20}).size(),
            28U);
}

TEST(FeetechPeer, AllAnswerAPingToAllInTurn) {
  Bench bench({{.id = 1, .make = Make::sts3215}, {.id = 7}});
  EXPECT_EQ(bench.ask({0xFF, 0xFF, 0xFE, 0x02, 0x01, 0xFE}),
            (Bytes{0xFF, 0xFF, 0x01, 0x02, 0x00, 0xFC, 0xFF, 0xFF, 0x07, 0x02, 0x00, 0xF6}));
}

TEST(FeetechPeer, ItsHomingOffsetIsTakenOffThePosition) {
  Bench bench(std::vector{FeetechPeer::Servo{.id = 1, .make = Make::sts3215}});
  const auto told = [&bench] {
    bench.peer.advance(bench.now_ns);
    return bench.peer.stored(0, 56, 2);
  };
  bench.peer.joint(0).position_rad = std::numbers::pi;
  bench.write(31, {100, 0});
  EXPECT_EQ(told(), 1948);
  bench.write(31, {0xff, 0x0f});  // -2047
  EXPECT_EQ(told(), 4095);
  bench.peer.joint(0).position_rad = 0.0;
  EXPECT_EQ(told(), 2047);
}

TEST(FeetechPeer, AWrongChecksumIsNotHeard) {
  Bench bench(std::vector{FeetechPeer::Servo{.id = 1}});
  EXPECT_TRUE(bench.ask({0xFF, 0xFF, 0x01, 0x02, 0x01, 0xFA}).empty());
  EXPECT_FALSE(bench.ask({0xFF, 0xFF, 0xFF, 0x01, 0x02, 0x01, 0xFB}).empty());
}

TEST(FeetechPeer, WhatIsWrittenBehindTheLockLastsUntilThePowerGoes) {
  Bench bench(std::vector{FeetechPeer::Servo{.id = 1, .fault = ServoFault::power_cycle, .fault_from_ns = 10 * ms}});
  bench.write(33, {2});
  bench.write(55, {0});
  bench.write(21, {9});
  EXPECT_EQ(bench.peer.stored(0, 33, 1), 2);
  bench.peer.advance(400 * ms);
  EXPECT_EQ(bench.peer.stored(0, 33, 1), 0);
  EXPECT_EQ(bench.peer.stored(0, 21, 1), 9);
  EXPECT_EQ(bench.peer.stored(0, 44, 2), 500);  // the protection current, as goal
}

TEST(FeetechPeer, AnHlsTurnsByItsCurrentAndLetsGoBeyondItsProtection) {
  Bench bench(std::vector{FeetechPeer::Servo{.id = 1}});
  bench.write(44, {100, 0x80});
  bench.write(33, {2});
  bench.write(40, {1});
  bench.peer.advance(100 * ms);
  EXPECT_LT(bench.peer.joint(0).velocity_rad_per_s, -1.0);
  EXPECT_EQ(bench.peer.largest_current(0), 100);
  bench.now_ns = 100 * ms;
  bench.write(44, {0xf5, 0x01});  // 501
  bench.peer.advance(101 * ms);
  EXPECT_EQ(bench.peer.stored(0, 40, 1), 0);
  EXPECT_EQ(bench.peer.stored(0, 65, 1), 8);
}

}  // namespace tactus::emulation::feetech::peer_test
