#include <tactus/devices/damiao/damiao_bus.hpp>
#include <tactus/emulation/damiao/damiao_peer.hpp>
#include <tactus/wire/join.hpp>
#include <tactus/wire/paced.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <tests/allocation_counter.hpp>

namespace tactus::devices::damiao {
namespace bus_test {

using emulation::damiao::AdapterType;
using emulation::damiao::DamiaoPeer;
using emulation::damiao::FaultKind;
using EmulatedFault = emulation::damiao::Fault;

constexpr std::int64_t ms = 1'000'000;
constexpr double torque_step_Nm = 20.0 / 4095.0;
constexpr std::array all_framings{Framing::usb2can, Framing::slcan, Framing::slcan_fd, Framing::socketcan,
                                  Framing::socketcan_fd};

/// A bus and the emulated motors behind it, in virtual time.
struct Bench {
  struct Setup {
    std::size_t motors = 2;
    Framing framing = Framing::usb2can;
    std::vector<EmulatedFault> faults = {};
    std::uint64_t seed = 1;
  };

  explicit Bench(const Setup& setup) {
    DamiaoBusParams params;
    emulation::damiao::PeerSettings settings;
    params.framing = setup.framing;
    // The same words in another module.
    settings.adapter = static_cast<AdapterType>(setup.framing);
    settings.faults = setup.faults;
    settings.seed = setup.seed;
    for (std::uint32_t id = 1; id <= setup.motors; ++id) {
      params.motors.push_back({.id = id, .feedback_id = id + 0x10, .model = Model::dm4310});
      settings.motors.push_back({.id = id, .feedback_id = id + 0x10});
    }
    bus = *DamiaoBus::make(params);
    peer = *DamiaoPeer::make(settings);
    const bool serial = is_serial(settings.adapter);
    if (serial) paced = std::make_unique<wire::Paced>(*peer, wire::byte_ns(921'600), wire::Paced::Line::full_duplex);
  }

  void run(std::int64_t duration_ns) {
    wire::WireEnd& there = paced ? static_cast<wire::WireEnd&>(*paced) : *peer;
    wire::join(*bus, there, now_ns, now_ns + duration_ns);
    now_ns += duration_ns;
  }
  void command_all(double torque_Nm, bool enabled = true) {
    for (std::size_t motor = 0; motor < bus->motors(); ++motor) {
      bus->command(motor, {.torque_Nm = torque_Nm, .enabled = enabled ? 1 : 0});
    }
  }
  /// Whether no motor ever gave more than is between zero and this torque, but for a step of its number.
  [[nodiscard]] bool never_beyond(double torque_Nm) const {
    for (std::size_t motor = 0; motor < bus->motors(); ++motor) {
      if (peer->motor(motor).most_torque_Nm() > std::max(torque_Nm, 0.0) + torque_step_Nm) return false;
      if (peer->motor(motor).least_torque_Nm() < std::min(torque_Nm, 0.0) - torque_step_Nm) return false;
    }
    return true;
  }
  [[nodiscard]] std::string problem() const { return bus->problem() ? describe(*bus->problem()) : std::string(); }

  std::unique_ptr<DamiaoBus> bus;
  std::unique_ptr<DamiaoPeer> peer;
  std::unique_ptr<wire::Paced> paced;
  std::int64_t now_ns = 0;
};

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
    EXPECT_LT(bench.now_ns - reading.heard_ns, 10 * ms);
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
        oldest_ns = std::max(oldest_ns, bench.now_ns - bench.bus->reading(motor).heard_ns);
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
  EXPECT_EQ(bench.bus->reading(6).fault, MotorFault::silent);
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
  bench.run(60 * ms);
  EXPECT_EQ(bench.bus->reading(1).fault, MotorFault::silent);
  EXPECT_GT(bench.now_ns - bench.bus->reading(1).heard_ns, 40 * ms);
  EXPECT_EQ(bench.bus->reading(0).fault, MotorFault::none);
  bench.run(150 * ms);
  // It lost its master meanwhile; it answers again, and nobody asked anew for its power.
  EXPECT_LT(bench.now_ns - bench.bus->reading(1).heard_ns, 10 * ms);
  EXPECT_EQ(bench.peer->motor(1).status(), 0xd);
  EXPECT_EQ(bench.bus->reading(1).fault, MotorFault::silent);
  EXPECT_EQ(bench.peer->motor(1).torque_Nm(), 0.0);
  bench.command_all(0.3, false);
  bench.run(20 * ms);
  bench.command_all(0.3);
  bench.run(20 * ms);
  EXPECT_EQ(bench.bus->reading(1).fault, MotorFault::none);
  EXPECT_TRUE(bench.peer->motor(1).enabled());
  EXPECT_TRUE(bench.never_beyond(0.3));
}

TEST(DamiaoBus, EveryFaultOfTheMotorsEndsWithoutTorqueBeyondTheCommandAndIsTold) {
  struct Case {
    FaultKind kind;
    MotorFault expected;
    bool stays_driven;
  };
  const std::array cases{Case{FaultKind::silence, MotorFault::silent, false},
                         Case{FaultKind::over_voltage, MotorFault::voltage, false},
                         Case{FaultKind::under_voltage, MotorFault::voltage, false},
                         Case{FaultKind::over_current, MotorFault::current, false},
                         Case{FaultKind::hot_drive, MotorFault::hot, false},
                         Case{FaultKind::hot_winding, MotorFault::hot, false},
                         Case{FaultKind::communication_lost, MotorFault::lost_master, false},
                         Case{FaultKind::overload, MotorFault::overload, false},
                         Case{FaultKind::bus_off, MotorFault::silent, false},
                         Case{FaultKind::register_answer, MotorFault::none, true},
                         Case{FaultKind::garbage, MotorFault::none, true},
                         Case{FaultKind::heartbeat, MotorFault::none, true},
                         Case{FaultKind::split, MotorFault::none, true}};
  for (const Case& c : cases) {
    for (const Framing framing : all_framings) {
      for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        for (const std::uint32_t motor : {0U, 2U}) {
          const std::string what = std::string(name_of(c.kind)) + " " + name_of(framing) + " " + std::to_string(seed);
          const double torque_Nm = seed % 2 == 0 ? 0.4 : -0.4;
          Bench bench(
              {.framing = framing, .faults = {{.kind = c.kind, .motor = motor, .from_ns = 250 * ms}}, .seed = seed});
          bench.run(200 * ms);
          ASSERT_EQ(bench.bus->state(), BusState::ready) << what << bench.problem();
          bench.command_all(torque_Nm);
          bench.run(200 * ms);
          EXPECT_EQ(bench.bus->reading(1).fault, c.expected) << what;
          EXPECT_EQ(bench.peer->motor(1).enabled(), c.stays_driven) << what;
          const bool other_suffers = motor == 0 && !c.stays_driven;
          EXPECT_EQ(bench.bus->reading(0).fault,
                    other_suffers || c.kind == FaultKind::bus_off ? c.expected : MotorFault::none)
              << what;
          EXPECT_TRUE(bench.never_beyond(torque_Nm)) << what;
          const double off_rad = bench.bus->reading(1).position_rad - bench.peer->motor(1).position_rad();
          if (c.stays_driven) {
            EXPECT_LT(std::fabs(off_rad), 0.1) << what;
          }
        }
      }
    }
  }
}

TEST(DamiaoBus, FaultsThatAreThereAtTheStartAreToldAndNoMotorGetsPower) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    for (const FaultKind kind : {FaultKind::silence, FaultKind::wrong_scale}) {
      Bench bench({.motors = 3, .faults = {{.kind = kind, .motor = 2}}, .seed = seed});
      bench.command_all(1.0);
      bench.run(1000 * ms);
      EXPECT_EQ(bench.bus->state(), BusState::refused);
      const std::string why = bench.problem();
      if (kind == FaultKind::silence) {
        EXPECT_EQ(why.find("motor 2 (DM4310) does not answer: look at its power"), 0U) << why;
      } else {
        EXPECT_EQ(why.find("motor 2 (DM4310): its register 22 (VMAX) reads 45 where this model has 30 rad/s: "), 0U)
            << why;
      }
      EXPECT_FALSE(bench.bus->problem(0));
      EXPECT_EQ(bench.bus->facts(2).torque_scale_Nm, 10.0);
      for (std::size_t motor = 0; motor < 3; ++motor) EXPECT_EQ(bench.peer->motor(motor).most_torque_Nm(), 0.0);
      EXPECT_EQ(bench.bus->wakes_ns(), wire::never_ns);
    }
    // A hot one is well but for that; it gets no power.
    Bench bench({.faults = {{.kind = FaultKind::hot_drive, .motor = 2}}, .seed = seed});
    bench.run(200 * ms);
    bench.command_all(1.0);
    bench.run(500 * ms);
    EXPECT_EQ(bench.bus->state(), BusState::ready);
    EXPECT_EQ(bench.bus->reading(1).fault, MotorFault::hot);
    EXPECT_EQ(bench.bus->reading(1).temperature_C, 121.0);
    EXPECT_EQ(bench.peer->motor(1).most_torque_Nm(), 0.0);
  }
}

TEST(DamiaoBus, AFaultFromBeforeIsClearedWhenPowerIsAskedFor) {
  const EmulatedFault past{.kind = FaultKind::under_voltage, .from_ns = 0, .until_ns = 100 * ms};
  Bench bench({.faults = {past}});
  bench.run(200 * ms);
  EXPECT_EQ(bench.bus->reading(0).fault, MotorFault::voltage);
  bench.command_all(0.1);
  bench.run(50 * ms);
  EXPECT_EQ(bench.bus->reading(0).fault, MotorFault::none);
  EXPECT_TRUE(bench.peer->motor(0).enabled());
}

TEST(DamiaoBus, AFaultUnderPowerStaysTakenUntilPowerIsAskedForAnew) {
  const EmulatedFault passing{.kind = FaultKind::overload, .motor = 1, .from_ns = 300 * ms, .until_ns = 320 * ms};
  Bench bench({.faults = {passing}});
  bench.run(200 * ms);
  bench.command_all(0.1);
  bench.run(300 * ms);
  EXPECT_EQ(bench.bus->reading(0).fault, MotorFault::overload);
  EXPECT_FALSE(bench.peer->motor(0).enabled());
  EXPECT_TRUE(bench.peer->motor(1).enabled());
  bench.command_all(0.1, false);
  bench.run(10 * ms);
  bench.command_all(0.1);
  bench.run(30 * ms);
  EXPECT_EQ(bench.bus->reading(0).fault, MotorFault::none);
  EXPECT_TRUE(bench.peer->motor(0).enabled());
}

TEST(DamiaoBus, PositionsGoOnWhereTheirNumberGoesAround) {
  Bench bench({.faults = {{.kind = FaultKind::wrap}}});
  bench.run(200 * ms);
  ASSERT_EQ(bench.bus->state(), BusState::ready) << bench.problem();
  const double first_rad = bench.bus->reading(0).position_rad;
  const double true_first_rad = bench.peer->motor(0).position_rad();
  bench.run(12'000 * ms);
  // The first number says nothing of turns before.
  const double turned_rad = bench.bus->reading(0).position_rad - first_rad;
  EXPECT_GT(turned_rad, 50.0);
  EXPECT_NEAR(turned_rad, bench.peer->motor(0).position_rad() - true_first_rad, 0.03);
}

TEST(DamiaoBus, AMotorThatCouldHaveTurnedTooFarInSilenceDoesNotKnowWhereItIs) {
  for (const std::int64_t silent_ns : {300 * ms, 600 * ms}) {
    const EmulatedFault silence{
        .kind = FaultKind::silence, .motor = 1, .from_ns = 300 * ms, .until_ns = 300 * ms + silent_ns};
    Bench bench({.faults = {silence}});
    bench.run(1000 * ms);
    const bool lost = silent_ns > 417 * ms;  // 12.5 rad at 30 rad/s
    EXPECT_EQ(bench.bus->reading(0).fault, lost ? MotorFault::encoder : MotorFault::none);
    bench.command_all(0.1);
    bench.run(100 * ms);
    EXPECT_EQ(bench.peer->motor(0).enabled(), !lost);
  }
}

TEST(DamiaoBus, ATorqueBeyondTheMotorIsCutAndOneThatIsNoNumberTakesThePower) {
  Bench bench({});
  bench.run(200 * ms);
  bench.command_all(1e9);
  bench.run(50 * ms);
  EXPECT_NEAR(bench.peer->motor(0).torque_Nm(), 10.0, 1e-9);
  for (const double wrong : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    bench.command_all(0.1);
    bench.run(50 * ms);
    EXPECT_TRUE(bench.peer->motor(0).enabled());
    bench.command_all(wrong);
    bench.run(50 * ms);
    EXPECT_FALSE(bench.peer->motor(0).enabled());
  }
}

TEST(DamiaoBus, AMotorLeftWithPowerByAnotherProgramLosesItBeforeAnythingIsAsked) {
  Bench bench({});
  bench.run(200 * ms);
  bench.command_all(0.5);
  bench.run(50 * ms);
  ASSERT_TRUE(bench.peer->motor(0).enabled());
  DamiaoBusParams params;
  params.motors = {{.id = 1, .feedback_id = 0x11}, {.id = 2, .feedback_id = 0x12}};
  bench.bus = *DamiaoBus::make(params);
  bench.run(10 * ms);
  EXPECT_FALSE(bench.peer->motor(0).enabled());
}

TEST(DamiaoBus, WhenItFallsSilentTheMotorsOwnWatchdogTakesThePower) {
  Bench bench({});
  bench.run(200 * ms);
  bench.command_all(0.5);
  bench.run(50 * ms);
  ASSERT_TRUE(bench.peer->motor(0).enabled());
  bench.now_ns += 51 * ms;  // killed
  bench.peer->say(bench.now_ns);
  EXPECT_EQ(bench.peer->motor(0).status(), 0xd);
}

TEST(DamiaoBus, AnIdentifierThatDiffersIsNamedWithBoth) {
  Bench bench({});
  DamiaoBusParams params;
  params.motors = {{.id = 1, .feedback_id = 0x11}, {.id = 2, .feedback_id = 0x22}};
  bench.bus = *DamiaoBus::make(params);
  bench.run(300 * ms);
  EXPECT_EQ(bench.bus->state(), BusState::refused);
  EXPECT_EQ(bench.problem().find("motor 2 (DM4310) gives feedback with the identifier 18 where 34 is stated"), 0U)
      << bench.problem();
}

TEST(DamiaoBus, ParametersThatCannotBeAreRefused) {
  const auto refusal = [](std::vector<MotorParams> motors) {
    DamiaoBusParams params;
    params.motors = std::move(motors);
    const auto bus = DamiaoBus::make(params);
    return bus ? std::string("no error") : describe(bus.error());
  };
  EXPECT_EQ(refusal({}).find("motors: "), 0U);
  EXPECT_EQ(refusal(std::vector<MotorParams>(16)).find("motors: "), 0U);
  EXPECT_NE(refusal({{.id = 0}}).find("at least 1 and at most 15"), std::string::npos) << refusal({{.id = 0}});
  EXPECT_NE(refusal({{.id = 1}, {.id = 1}}).find("two motors have this identifier"), std::string::npos);
  EXPECT_NE(refusal({{.id = 1, .feedback_id = 2}, {.id = 2}}).find("takes commands"), std::string::npos);
}

TEST(DamiaoBus, NoBytesMakeItAllocateOrCrash) {
  EXPECT_TRUE(rc::check([] {
    for (const Framing framing : all_framings) {
      DamiaoBusParams params;
      params.framing = framing;
      params.motors = {{.id = 1, .feedback_id = 0x11}, {.id = 2, .feedback_id = 0x12}};
      const auto bus = *DamiaoBus::make(params);
      const auto bytes = *rc::gen::arbitrary<std::vector<std::uint8_t>>();
      const std::uint64_t before = laws::own_allocation_count();
      for (std::int64_t at_ns = 0; at_ns < 500 * ms; at_ns += 5 * ms) {
        bus->hear(bytes, at_ns);
        while (!bus->say(at_ns).empty()) continue;
      }
      const std::uint64_t after = laws::own_allocation_count();
      RC_ASSERT(after == before);
    }
  }));
}

}  // namespace bus_test
}  // namespace tactus::devices::damiao
