// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "tests/devices/damiao/bench.hpp"
#include "tests/devices/seeds.hpp"
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <tests/allocation_counter.hpp>

namespace tactus::devices::damiao {
namespace bus_test {

TEST(DamiaoBus, EveryFaultOfTheMotorsEndsWithoutTorqueBeyondTheCommandAndIsTold) {
  struct Case {
    FaultKind kind;
    MotorFault expected;
    bool stays_driven;
  };
  const std::array cases{Case{FaultKind::silence, MotorFault::not_responding, false},
                         Case{FaultKind::over_voltage, MotorFault::voltage, false},
                         Case{FaultKind::under_voltage, MotorFault::voltage, false},
                         Case{FaultKind::over_current, MotorFault::current, false},
                         Case{FaultKind::hot_drive, MotorFault::hot, false},
                         Case{FaultKind::hot_winding, MotorFault::hot, false},
                         Case{FaultKind::communication_lost, MotorFault::lost_master, false},
                         Case{FaultKind::overload, MotorFault::overload, false},
                         Case{FaultKind::bus_off, MotorFault::not_responding, false},
                         Case{FaultKind::register_answer, MotorFault::none, true},
                         Case{FaultKind::garbage, MotorFault::none, true},
                         Case{FaultKind::heartbeat, MotorFault::none, true},
                         Case{FaultKind::split, MotorFault::none, true}};
  for (const Case& c : cases) {
    for (const Framing framing : all_framings) {
      for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(seeds(5)); ++seed) {
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
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(seeds(5)); ++seed) {
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
      EXPECT_FALSE(bench.bus->sheet(0).problem);
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

TEST(DamiaoBus, SilenceShorterThanTheWatchdogOfTheMotorsIsNoFault) {
  for (const Framing framing : all_framings) {
    for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(seeds(20)); ++seed) {
      for (const std::uint32_t motor : {0U, 2U}) {
        for (const std::int64_t silent_ns : {5 * ms, 15 * ms, 35 * ms}) {
          const std::string what =
              std::string(name_of(framing)) + " " + std::to_string(seed) + " " + std::to_string(silent_ns);
          const EmulatedFault silence{
              .kind = FaultKind::silence, .motor = motor, .from_ns = 300 * ms, .until_ns = 300 * ms + silent_ns};
          Bench bench({.framing = framing, .faults = {silence}, .seed = seed});
          bench.run(200 * ms);
          bench.command_all(0.1);
          bench.run(100 * ms + silent_ns - ms);
          EXPECT_LT(bench.bus->reading(1).received_ns, 302 * ms) << what << ": it tells how old it is";
          bench.run(30 * ms);
          for (const std::size_t each : {0U, 1U}) {
            EXPECT_EQ(bench.bus->reading(each).fault, MotorFault::none) << what;
            EXPECT_TRUE(bench.peer->motor(each).enabled()) << what;
            EXPECT_GT(bench.bus->reading(each).received_ns, bench.now_ns - 5 * ms) << what;
          }
          EXPECT_TRUE(bench.never_beyond(0.1)) << what;
        }
      }
    }
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

TEST(DamiaoBus, TwoMotorsWithOneIdentifierAreTold) {
  for (const Framing framing : all_framings) {
    for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(seeds(20)); ++seed) {
      Bench bench({.motors = 3, .framing = framing, .faults = {{.kind = FaultKind::twin, .motor = 2}}, .seed = seed});
      bench.run(1000 * ms);
      EXPECT_EQ(bench.bus->state(), BusState::refused) << name_of(framing) << " " << seed;
      EXPECT_EQ(
          bench.problem().find("motor 2 (DM4310) answers twice to one question: two motors have the identifier 2"), 0U)
          << name_of(framing) << " " << seed << " " << bench.problem();
    }
  }
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
