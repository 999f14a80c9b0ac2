// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>

#include "tests/devices/damiao/bench.hpp"
#include <gtest/gtest.h>

namespace tactus::devices::damiao {
namespace bus_test {

TEST(DamiaoBus, EveryFramingAsksTheMotorsThenReadsAndDrivesThem) {
  for (const Framing framing : all_framings) {
    Bench bench({.motors = 3, .framing = framing});
    EXPECT_EQ(bench.bus->state(), BusState::asking);
    bench.run(200 * ms);
    ASSERT_EQ(bench.bus->state(), BusState::ready) << name_of(framing) << bench.problem();
    EXPECT_EQ(bench.bus->facts(2).velocity_scale_rad_per_s, 30.0);
    EXPECT_EQ(bench.bus->facts(2).timeout, 1000);
    EXPECT_EQ(bench.bus->facts(2).software_version, 5013);
    EXPECT_EQ(bench.bus->reading(1).enabled, 0);
    EXPECT_EQ(bench.bus->reading(1).temperature_C, 30.0);
    bench.bus->command(1, {.torque_Nm = 0.5, .enabled = 1});
    bench.run(100 * ms);
    const MotorReading& reading = bench.bus->reading(1);
    EXPECT_EQ(reading.enabled, 1) << name_of(framing);
    EXPECT_EQ(reading.fault, MotorFault::none);
    EXPECT_NEAR(reading.torque_Nm, 0.5, 2.0 * torque_step_Nm);
    EXPECT_NEAR(reading.position_rad, bench.peer->motor(1).position_rad(), 0.03);
    EXPECT_GT(reading.position_rad, 0.05);
    EXPECT_LT(bench.now_ns - reading.received_ns, 10 * ms);
    EXPECT_TRUE(bench.never_beyond(0.5));
    EXPECT_EQ(bench.peer->motor(0).most_torque_Nm(), 0.0);
    bench.command_all(0.0, false);
    bench.run(20 * ms);
    EXPECT_FALSE(bench.peer->motor(1).enabled());
    EXPECT_EQ(bench.bus->reading(1).enabled, 0);
  }
}

/// What passes on the bus of a Linux interface, each with its bits.
class Tap final : public wire::WireEnd {
 public:
  Tap(wire::WireEnd& peer, bool flexible) : peer_(&peer), flexible_(flexible) {}
  void hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) noexcept override {
    count(bytes);
    peer_->hear(bytes, now_ns);
  }
  std::span<const std::uint8_t> say(std::int64_t now_ns) noexcept override {
    const auto said = peer_->say(now_ns);
    count(said);
    return said;
  }
  [[nodiscard]] std::int64_t wakes_ns() const noexcept override { return peer_->wakes_ns(); }
  std::int64_t taken_ns = 0;

 private:
  void count(std::span<const std::uint8_t> bytes) noexcept {
    if (bytes.empty()) return;
    emulation::damiao::Frame frame{.id = static_cast<std::uint32_t>(bytes[0] | bytes[1] << 8), .bytes = {}};
    std::copy_n(bytes.begin() + 8, 8, frame.bytes.begin());
    taken_ns += frame_ns(frame, flexible_);
  }
  wire::WireEnd* peer_;
  bool flexible_;
};

TEST(DamiaoBus, ACycleTakesWhatItsFramesTakeOnTheBus) {
  for (const Framing framing : {Framing::socketcan, Framing::socketcan_fd}) {
    for (const std::size_t motors : {7U, 8U}) {
      Bench bench({.motors = motors, .framing = framing});
      Tap tap(*bench.peer, framing == Framing::socketcan_fd);
      wire::join(*bench.bus, tap, 0, 200 * ms);
      ASSERT_EQ(bench.bus->state(), BusState::ready);
      bench.command_all(0.2);
      wire::join(*bench.bus, tap, 200 * ms, 300 * ms);
      const std::int64_t before = bench.bus->cycles(), taken_before_ns = tap.taken_ns;
      wire::join(*bench.bus, tap, 300 * ms, 1300 * ms);
      const auto cycles = static_cast<double>(bench.bus->cycles() - before);
      const double limit_Hz = cycles / (static_cast<double>(tap.taken_ns - taken_before_ns) * 1e-9);
      EXPECT_GE(cycles, 0.95 * limit_Hz) << name_of(framing) << " " << motors;
      RecordProperty(std::string(name_of(framing)) + "_" + std::to_string(motors), std::to_string(cycles));
    }
  }
}

TEST(DamiaoBus, ACycleBehindASerialAdapterTakesWhatItsBytesAndItsLastMotorTake) {
  struct Case {
    Framing framing;
    double there_bytes, back_bytes, frame_us;
  };
  // 115 µs are a frame with few bits to stuff; a motor answers after 155 µs on average.
  for (const Case& c :
       {Case{Framing::usb2can, 30, 16, 115}, Case{Framing::slcan, 22, 22, 115}, Case{Framing::slcan_fd, 22, 22, 66}}) {
    for (const std::size_t motors : {7U, 8U}) {
      Bench bench({.motors = motors, .framing = c.framing});
      bench.run(400 * ms);
      ASSERT_EQ(bench.bus->state(), BusState::ready) << bench.problem();
      bench.command_all(0.2);
      bench.run(100 * ms);
      const std::int64_t before = bench.bus->cycles();
      bench.run(1000 * ms);
      const double byte_us = 1e7 / 921'600.0;
      const double cycle_us = static_cast<double>(motors) * c.there_bytes * byte_us + c.frame_us + 155.0 + c.frame_us +
                              c.back_bytes * byte_us;
      EXPECT_GE(static_cast<double>(bench.bus->cycles() - before), 0.95 * 1e6 / cycle_us)
          << name_of(c.framing) << " " << motors;
      RecordProperty(std::string(name_of(c.framing)) + "_" + std::to_string(motors),
                     std::to_string(bench.bus->cycles() - before));
    }
  }
}

TEST(DamiaoBus, OneSilentMotorCostsNoOtherItsData) {
  for (const Framing framing : all_framings) {
    const auto answers_of_the_others = [framing](std::vector<EmulatedFault> faults) {
      Bench bench({.motors = 7, .framing = framing, .faults = std::move(faults)});
      bench.run(500 * ms);
      bench.command_all(0.2);
      bench.run(500 * ms);
      std::int64_t fewest = std::numeric_limits<std::int64_t>::max(), oldest_ns = 0;
      for (const std::size_t motor : {0U, 1U, 2U, 4U, 5U, 6U}) {
        const std::int64_t before = bench.bus->reading(motor).answers;
        bench.run(300 * ms);
        fewest = std::min(fewest, bench.bus->reading(motor).answers - before);
        oldest_ns = std::max(oldest_ns, bench.now_ns - bench.bus->reading(motor).received_ns);
        EXPECT_EQ(bench.bus->reading(motor).fault, MotorFault::none);
      }
      EXPECT_LT(oldest_ns, 8 * ms);
      return static_cast<double>(fewest);
    };
    const double alone = answers_of_the_others({{.kind = FaultKind::silence, .motor = 4, .from_ns = 600 * ms}});
    EXPECT_GE(alone, answers_of_the_others({})) << name_of(framing);
  }
}

TEST(DamiaoBus, ALostAnswerCostsNoLaterCycleItsTime) {
  const auto cycles = [](std::vector<EmulatedFault> faults) {
    Bench bench({.motors = 4, .faults = std::move(faults)});
    bench.run(350 * ms);
    const std::int64_t before = bench.bus->cycles();
    bench.run(1000 * ms);
    return static_cast<double>(bench.bus->cycles() - before);
  };
  const EmulatedFault lost{.kind = FaultKind::silence, .motor = 2, .from_ns = 300 * ms, .until_ns = 302 * ms};
  EXPECT_GE(cycles({lost}), 0.99 * cycles({}));
}

/// Counts what the driver says.
class Counted final : public wire::WireEnd {
 public:
  explicit Counted(wire::WireEnd& peer) : peer_(&peer) {}
  void hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) noexcept override {
    ++packets;
    peer_->hear(bytes, now_ns);
  }
  std::span<const std::uint8_t> say(std::int64_t now_ns) noexcept override { return peer_->say(now_ns); }
  [[nodiscard]] std::int64_t wakes_ns() const noexcept override { return peer_->wakes_ns(); }
  std::int64_t packets = 0;

 private:
  wire::WireEnd* peer_;
};

TEST(DamiaoBus, WhereAllAreSilentEachIsAskedEvery10msSoThatNothingPilesUpInAnAdapter) {
  Bench bench(
      {.motors = 7, .framing = Framing::socketcan, .faults = {{.kind = FaultKind::silence, .from_ns = 300 * ms}}});
  Counted counted(*bench.peer);
  wire::join(*bench.bus, counted, 0, 400 * ms);
  EXPECT_EQ(bench.bus->reading(6).fault, MotorFault::not_responding);
  const std::int64_t before = counted.packets;
  wire::join(*bench.bus, counted, 400 * ms, 500 * ms);
  EXPECT_LE(counted.packets - before, 7 * 11);
  EXPECT_GE(counted.packets - before, 7 * 8);
}

/// Holds back what the peer says, and counts what is under way.
class Held final : public wire::WireEnd {
 public:
  explicit Held(wire::WireEnd& peer) : peer_(&peer) {}
  void hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) noexcept override {
    most_under_way = std::max(most_under_way, ++under_way);
    peer_->hear(bytes, now_ns);
  }
  std::span<const std::uint8_t> say(std::int64_t now_ns) noexcept override {
    for (auto said = peer_->say(now_ns); !said.empty(); said = peer_->say(now_ns)) held_.put(said, now_ns + by_ns);
    const auto said = held_.take(now_ns);
    if (!said.empty()) --under_way;
    return said;
  }
  [[nodiscard]] std::int64_t wakes_ns() const noexcept override { return std::min(peer_->wakes_ns(), held_.due_ns()); }
  std::int64_t by_ns = 0;
  int under_way = 0, most_under_way = 0;

 private:
  wire::WireEnd* peer_;
  wire::Outbox held_{1 << 14};
};

TEST(DamiaoBus, AnAnswerThatWasLateIsNotTakenForThatOfALaterCycle) {
  for (std::int64_t by_ns = ms / 2; by_ns < 4 * ms; by_ns += ms / 8) {
    Bench bench({.motors = 3, .framing = Framing::socketcan});
    Held held(*bench.peer);
    wire::join(*bench.bus, held, 0, 200 * ms);
    ASSERT_EQ(bench.bus->state(), BusState::ready);
    held.by_ns = by_ns;
    wire::join(*bench.bus, held, 200 * ms, 201 * ms);
    held.by_ns = 0;
    wire::join(*bench.bus, held, 201 * ms, 250 * ms);
    held.most_under_way = 0;
    wire::join(*bench.bus, held, 250 * ms, 300 * ms);
    EXPECT_EQ(held.most_under_way, 3) << by_ns;
  }
}

TEST(DamiaoBus, ASilentMotorIsToldAndComesBackWithoutPower) {
  const EmulatedFault silence{.kind = FaultKind::silence, .motor = 2, .from_ns = 300 * ms, .until_ns = 400 * ms};
  Bench bench({.faults = {silence}});
  bench.run(200 * ms);
  bench.command_all(0.3);
  bench.run(90 * ms);
  EXPECT_EQ(bench.bus->reading(1).enabled, 1);
  bench.run(50 * ms);
  EXPECT_EQ(bench.bus->reading(1).fault, MotorFault::none) << "its own watchdog waits for 50 ms";
  EXPECT_GT(bench.now_ns - bench.bus->reading(1).received_ns, 38 * ms);
  bench.run(15 * ms);
  EXPECT_EQ(bench.bus->reading(1).fault, MotorFault::not_responding);
  EXPECT_EQ(bench.bus->reading(0).fault, MotorFault::none);
  bench.run(145 * ms);
  // It lost its master meanwhile; it answers again, and nobody asked anew for its power.
  EXPECT_LT(bench.now_ns - bench.bus->reading(1).received_ns, 10 * ms);
  EXPECT_EQ(bench.peer->motor(1).status(), 0xd);
  EXPECT_EQ(bench.bus->reading(1).fault, MotorFault::not_responding);
  EXPECT_EQ(bench.peer->motor(1).torque_Nm(), 0.0);
  bench.command_all(0.3, false);
  bench.run(20 * ms);
  bench.command_all(0.3);
  bench.run(20 * ms);
  EXPECT_EQ(bench.bus->reading(1).fault, MotorFault::none);
  EXPECT_TRUE(bench.peer->motor(1).enabled());
  EXPECT_TRUE(bench.never_beyond(0.3));
}

}  // namespace bus_test
}  // namespace tactus::devices::damiao
