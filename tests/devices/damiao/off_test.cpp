// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/motor_link.hpp>
#include <tactus/hardware/devices/off_watch.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "tests/devices/damiao/bench.hpp"
#include "tests/devices/seeds.hpp"
#include <gtest/gtest.h>

/// Motors that are to have no power, whatever they report of themselves.
namespace tactus::devices::damiao {
namespace off_test {

using bus_test::Bench;
using bus_test::EmulatedFault;
using bus_test::FaultKind;
using bus_test::ms;

constexpr std::int64_t within_ns = off_within_ns;

std::int64_t between_ms(signal::Random& random, double lower, double upper) {
  return static_cast<std::int64_t>(random.uniform(lower, upper)) * ms;
}

EmulatedFault reports(std::uint8_t status, std::int64_t from_ns, std::int64_t until_ns = wire::never_ns) {
  return {.kind = FaultKind::status, .motor = 2, .from_ns = from_ns, .until_ns = until_ns, .status = status};
}

TEST(DamiaoBus, AStatusThatIsNotKnownOrNotAskedForWhileDrivingIsAFaultAndTakesThePower) {
  for (std::uint8_t status = 0; status < 16; ++status) {
    for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(seeds(2)); ++seed) {
      const std::string what = status_text(status) + " seed " + std::to_string(seed);
      signal::Random random(seed);
      const std::int64_t from_ns = between_ms(random, 250.0, 350.0);
      Bench bench({.faults = {reports(status, from_ns)}, .seed = seed});
      bench.run(200 * ms);
      bench.command_all(0.3);
      bench.run(from_ns - 200 * ms);
      ASSERT_TRUE(bench.peer->motor(1).enabled()) << what;
      bench.run(within_ns);
      EXPECT_EQ(bench.peer->motor(1).enabled(), status == status_enabled) << what;
      EXPECT_EQ(bench.bus->reading(1).fault == MotorFault::none, status == status_enabled) << what;
      EXPECT_EQ(bench.bus->reading(1).status, status) << what;
      if (status > status_enabled && status < 8) {
        EXPECT_EQ(bench.bus->reading(1).fault, MotorFault::unknown_status) << what;
      }
      EXPECT_TRUE(bench.peer->motor(0).enabled()) << what;
    }
  }
}

/// Release, stop and the end of a run are the same to a bus: commands that enable nothing.
TEST(DamiaoBus, WhateverStatusAMotorReportsItIsOffInTimeAndToldWhereItDoesNotSaySo) {
  for (std::uint8_t status = 0; status < 16; ++status) {
    for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(seeds(4)); ++seed) {
      const std::string what = status_text(status) + " seed " + std::to_string(seed);
      signal::Random random(100 * seed + status);
      const std::int64_t release_ns = between_ms(random, 300.0, 400.0);
      // Before, with and after the release.
      const std::int64_t from_ns = release_ns + between_ms(random, -30.0, 3.0);
      Bench bench({.faults = {reports(status, from_ns)}, .seed = seed});
      bench.run(200 * ms);
      bench.command_all(seed % 2 == 0 ? 0.3 : -0.3);
      bench.run(release_ns - 200 * ms);
      bench.command_all(0.3, false);
      bench.run(within_ns);
      for (const std::size_t motor : {0U, 1U}) EXPECT_FALSE(bench.peer->motor(motor).enabled()) << what;
      EXPECT_EQ(bench.bus->reading(0).off, 1) << what;
      bench.run(20 * ms);
      const auto told = powered(1, bench.bus->reading(1));
      const bool off_by_protocol = status == status_disabled || (status >= 8 && status < 15);
      EXPECT_EQ(told.has_value(), !off_by_protocol) << what;
      if (told) {
        EXPECT_EQ(told->status, status) << what;
        EXPECT_EQ(bench.bus->reading(1).fault, MotorFault::stays_on) << what;
      }
    }
  }
}

TEST(DamiaoBus, StatusesThatChangeAtRandomKeepNoMotorOnOnceItIsToBeOff) {
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(seeds(30)); ++seed) {
    signal::Random random(seed);
    std::vector<EmulatedFault> faults;
    for (std::int64_t at_ns = 250 * ms; at_ns < 800 * ms;) {
      const std::int64_t until_ns = at_ns + between_ms(random, 1.0, 20.0);
      if (random.uniform() < 0.7)
        faults.push_back(reports(static_cast<std::uint8_t>(random.bits() % 16), at_ns, until_ns));
      at_ns = until_ns;
    }
    Bench bench({.faults = faults, .seed = seed});
    bench.run(200 * ms);
    bench.command_all(0.3);
    bench.run(between_ms(random, 60.0, 300.0));
    bench.command_all(0.3, false);
    bench.run(within_ns);
    while (bench.now_ns < 900 * ms) {
      EXPECT_FALSE(bench.peer->motor(0).enabled()) << seed;
      EXPECT_FALSE(bench.peer->motor(1).enabled()) << seed;
      bench.run(5 * ms);
    }
  }
}

/// Counts what passes to motor 2 behind SocketCAN, a frame at a time.
class Frames final : public wire::WireEnd {
 public:
  explicit Frames(wire::WireEnd& behind) : behind_(behind) {}
  void hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) noexcept override {
    FrameReader(Framing::socketcan).take(bytes, [&](const CanFrame& frame) {
      if (frame == order_frame(2, Order::disable)) {
        if (disables++ > 0) longest_gap_ns = std::max(longest_gap_ns, now_ns - last_ns_);
        if (now_ns - first_ns_ > within_ns + 2 * ms && disables > 1) {
          shortest_late_gap_ns = std::min(shortest_late_gap_ns, now_ns - last_ns_);
        }
        if (disables == 1) first_ns_ = now_ns;
        last_ns_ = now_ns;
      } else if (frame == refresh_frame(2)) {
        ++refreshes;
      } else if (frame.id == 2) {
        ++others;
      }
    });
    behind_.hear(bytes, now_ns);
  }
  std::span<const std::uint8_t> say(std::int64_t now_ns) noexcept override { return behind_.say(now_ns); }
  [[nodiscard]] std::int64_t wakes_ns() const noexcept override { return behind_.wakes_ns(); }

  int disables = 0, refreshes = 0, others = 0;
  std::int64_t longest_gap_ns = 0, shortest_late_gap_ns = wire::never_ns;

 private:
  wire::WireEnd& behind_;
  std::int64_t first_ns_ = 0, last_ns_ = 0;
};

TEST(DamiaoBus, DisableIsSentInEachCycleUntilTheMotorSaysThatItIsOff) {
  for (const std::uint8_t status : std::array<std::uint8_t, 3>{0x0, 0x1, 0x7}) {
    const EmulatedFault lie = reports(status, 310 * ms);
    Bench bench({.framing = Framing::socketcan, .faults = {lie}});
    bench.run(200 * ms);
    bench.command_all(0.3);
    bench.run(110 * ms);
    bench.command_all(0.3, false);
    const std::int64_t cycles = bench.bus->cycles();
    Frames frames(*bench.peer);
    wire::join(*bench.bus, frames, bench.now_ns, bench.now_ns + 90 * ms);
    bench.now_ns += 90 * ms;
    const auto ran = static_cast<int>(bench.bus->cycles() - cycles);
    EXPECT_GT(ran, 90);
    EXPECT_LE(frames.others, 1) << "one was under way";
    if (status == status_disabled) {
      EXPECT_EQ(frames.disables, 3);
      EXPECT_GE(frames.refreshes, ran - 5);
      continue;
    }
    EXPECT_GE(frames.disables, ran - 1);
    EXPECT_EQ(frames.refreshes, 0) << int{status};
  }
}

TEST(DamiaoBus, AMotorThatIgnoresDisableIsLeftToItsOwnWatchdogAndNeverGetsPowerAgain) {
  constexpr std::int64_t watchdog_ns = 50 * ms;
  Bench bench({.framing = Framing::socketcan, .faults = {{.kind = FaultKind::ignores_disable, .motor = 2}}});
  bench.run(200 * ms);
  bench.command_all(0.1);
  bench.run(100 * ms);
  bench.command_all(0.1, false);
  Frames frames(*bench.peer);
  wire::join(*bench.bus, frames, bench.now_ns, bench.now_ns + within_ns + 2 * ms);
  bench.now_ns += within_ns + 2 * ms;
  EXPECT_TRUE(bench.peer->motor(1).enabled());
  EXPECT_EQ(bench.bus->reading(1).fault, MotorFault::stays_on);
  EXPECT_EQ(bench.bus->reading(1).status, status_enabled);
  ASSERT_TRUE(powered(1, bench.bus->reading(1)));
  EXPECT_FALSE(powered(1, bench.bus->reading(1))->off);
  wire::join(*bench.bus, frames, bench.now_ns, bench.now_ns + 400 * ms);
  bench.now_ns += 400 * ms;
  EXPECT_GT(frames.shortest_late_gap_ns, watchdog_ns);
  EXPECT_EQ(bench.peer->motor(1).status(), 0xd) << "its watchdog";
  EXPECT_FALSE(bench.peer->motor(0).enabled());
  EXPECT_GT(bench.bus->reading(0).received_ns, bench.now_ns - 5 * ms) << "the other one is spoken to all the time";
  ASSERT_TRUE(powered(1, bench.bus->reading(1)));
  EXPECT_TRUE(powered(1, bench.bus->reading(1))->off);
  bench.command_all(0.1);
  bench.run(200 * ms);
  EXPECT_FALSE(bench.peer->motor(1).enabled());
  EXPECT_EQ(bench.bus->reading(1).fault, MotorFault::stays_on);
}

TEST(DamiaoBus, AMotorThatFellSilentUnderPowerCountsAsPoweredUntilItAnswers) {
  const EmulatedFault silence{.kind = FaultKind::silence, .motor = 2, .from_ns = 300 * ms, .until_ns = 600 * ms};
  Bench bench({.faults = {silence}});
  bench.run(200 * ms);
  bench.command_all(0.1);
  bench.run(300 * ms);
  bench.command_all(0.1, false);
  bench.run(90 * ms);
  EXPECT_EQ(bench.bus->reading(0).off, 1);
  EXPECT_EQ(bench.bus->reading(1).off, 0);
  EXPECT_TRUE(powered(1, bench.bus->reading(1)));
  bench.run(400 * ms);
  EXPECT_EQ(bench.bus->reading(1).off, 1);
  EXPECT_FALSE(powered(1, bench.bus->reading(1)));
}

TEST(DamiaoBus, AMotorThatDoesNotSayThatItIsOffWhenItIsAskedMakesTheBusRefused) {
  for (const std::uint8_t status : std::array<std::uint8_t, 4>{0x1, 0x2, 0x7, 0xf}) {
    Bench bench({.faults = {reports(status, 0)}});
    bench.command_all(0.3);
    bench.run(500 * ms);
    EXPECT_EQ(bench.bus->state(), BusState::refused);
    EXPECT_EQ(bench.problem(),
              "motor 2 (DM4310) was commanded 5 times to switch off and does not report that it is off (" +
                  status_text(status) + "): switch off its supply, wait until it is at rest, and switch it on again");
    EXPECT_EQ(bench.peer->motor(1).most_torque_Nm(), 0.0);
  }
}

TEST(OffWatch, OnlyReportsAfterTheMotorWasToldCount) {
  OffWatch watch;
  for (int i = 0; i < 10; ++i) watch.reported(true);
  EXPECT_FALSE(watch.confirmed());
  watch.told(0);
  watch.reported(true);
  watch.reported(true);
  EXPECT_FALSE(watch.confirmed());
  watch.reported(false);
  watch.reported(true);
  watch.reported(true);
  EXPECT_FALSE(watch.confirmed()) << "three in a row";
  watch.reported(true);
  EXPECT_TRUE(watch.confirmed());
  watch.reported(false);
  EXPECT_FALSE(watch.confirmed());
  EXPECT_TRUE(watch.due(10'000 * ms, ms)) << "the time begins anew";
}

}  // namespace off_test
}  // namespace tactus::devices::damiao
