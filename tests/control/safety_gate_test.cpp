// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/safety_gate.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include <gtest/gtest.h>

namespace tactus::control {
namespace safety_gate_test {

static_assert(Element<SafetyGate>);

constexpr double tick_s = 200e-6;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

SafetyGate gate(const SafetyGate::Params& params) { return SafetyGate::make(params, Seconds{tick_s}).value(); }

TEST(SafetyGate, WhateverIsReadOrCommandedWhatComesOutIsFiniteWithinTheForceLimitAndNoFasterThanTheRate) {
  constexpr double edges[] = {0.0, -0.0, infinity, -infinity, not_a_number, 1e308, -1e308, 5e-324};
  std::mt19937_64 engine(11);
  std::uniform_real_distribution<double> fraction(0.0, 1.0);
  for (int run = 0; run < 200; ++run) {
    SafetyGate::Params params{.force_limit_N = 10.0 * (1.0 - fraction(engine)), .rate_limit_N_per_s = 2000.0};
    params.energy = {.damp_above_J = 1e-3, .hold_above_J = 2e-3, .credit_J = 0.0, .drain_W = 0.0};
    SafetyGate element = gate(params);
    double before_N = 0.0, position_m = 0.0;
    for (int tick = 0; tick < 1000; ++tick) {
      position_m += 2e-4 * (2.0 * fraction(engine) - 1.0);
      const bool bad = run % 2 == 0 && engine() % 64 == 0;
      const double read_m = bad ? edges[engine() % std::size(edges)] : position_m;
      const double command_N =
          bad ? edges[engine() % std::size(edges)] : 3.0 * params.force_limit_N * (2.0 * fraction(engine) - 1.0);
      if (engine() % 128 == 0) element.rearm();
      const double passed_N = element.step({.command_N = command_N, .position_m = read_m});
      ASSERT_TRUE(std::isfinite(passed_N));
      ASSERT_LE(std::fabs(passed_N), params.force_limit_N);
      ASSERT_LE(std::fabs(passed_N - before_N), params.rate_limit_N_per_s * tick_s + 1e-12);
      before_N = passed_N;
    }
  }
}

TEST(SafetyGate, PassesUnchangedWhatIsWithinEveryLimit) {
  SafetyGate element = gate({});
  for (int tick = 0; tick < 1000; ++tick) {
    const double command_N = 1.9 * std::sin(0.01 * tick);
    ASSERT_EQ(element.step({.command_N = command_N, .position_m = 1e-3 * std::sin(0.02 * tick)}), command_N);
    ASSERT_EQ(element.limit(), ActiveLimit::none);
  }
}

TEST(SafetyGate, AReadingThatIsNoNumberLatchesAndTheForceFallsAtTheRateLimitUntilRearmed) {
  for (const double bad : {not_a_number, infinity, -infinity}) {
    SafetyGate element = gate({.force_limit_N = 1.0, .rate_limit_N_per_s = 500.0});
    for (int tick = 0; tick < 20; ++tick) element.step({.command_N = 0.8});
    EXPECT_EQ(element.believe(bad), 0.0) << "the reading before stands in its place";
    EXPECT_NEAR(element.pass(0.8), 0.7, 1e-12);
    EXPECT_EQ(element.fault(), GateFault::not_finite);
    for (int tick = 2; tick <= 20; ++tick) {
      EXPECT_NEAR(element.step({.command_N = 0.8}), std::max(0.0, 0.8 - 0.1 * tick), 1e-12);
    }
    element.rearm();
    EXPECT_EQ(element.fault(), GateFault::none);
    EXPECT_NEAR(element.step({.command_N = 0.05}), 0.05, 1e-15);
  }
}

TEST(SafetyGate, BeyondTheWorkspaceAForceThatPushesOnFadesOneThatPullsBackPassesAndAtAQuarterMoreItLatches) {
  const SafetyGate::Params params{.position_limit_m = 0.1};
  SafetyGate element = gate(params);
  for (int tick = 0; tick <= 1300; ++tick) {
    const double position_m = 1e-4 * tick;
    const double outward_N = element.step({.command_N = tick % 2 == 0 ? 1.0 : -1.0, .position_m = position_m});
    const double share = std::clamp((0.125 - position_m) / 0.025, 0.0, 1.0);
    if (position_m >= 0.125) {
      ASSERT_EQ(element.fault(), GateFault::workspace);
      ASSERT_EQ(outward_N, 0.0);
    } else {
      ASSERT_EQ(element.fault(), GateFault::none);
      ASSERT_NEAR(outward_N, tick % 2 == 0 ? share : -1.0, 1e-12) << position_m;
      if (tick == 1000) continue;  // exactly at the limit: rounding decides which of the two it is
      ASSERT_EQ(element.limit(), share < 1.0 && tick % 2 == 0 ? ActiveLimit::workspace : ActiveLimit::none);
    }
  }
}

TEST(SafetyGate, AboveTheSpeedLimitAForceAlongTheMotionFadesAndAtAQuarterMoreItLatches) {
  for (const double speed_m_per_s : {0.4, 0.55, 0.7}) {
    SafetyGate element = gate({.velocity_limit_m_per_s = 0.5});
    double along_N = 0.0, against_N = 0.0;
    for (int tick = 0; tick < 400; ++tick) {
      const double position_m = speed_m_per_s * tick_s * tick;
      (tick % 2 == 0 ? along_N : against_N) =
          element.step({.command_N = tick % 2 == 0 ? 1.0 : -1.0, .position_m = position_m});
    }
    if (speed_m_per_s < 0.625) {
      EXPECT_NEAR(along_N, speed_m_per_s < 0.5 ? 1.0 : 0.6, 1e-9);
      EXPECT_EQ(against_N, -1.0);
      EXPECT_EQ(element.fault(), GateFault::none);
    } else {
      EXPECT_EQ(along_N, 0.0);
      EXPECT_EQ(element.fault(), GateFault::velocity);
    }
  }
}

/// A controller that is a negative damper pumps b·v² into a device that swings. The oracle is the integral in closed
/// form: over whole half periods it is b·V²·t/2.
TEST(SafetyGate, AnActiveControllerIsDampedFirstThenHeldAndThenTheForceOnlyOpposesTheMotion) {
  SafetyGate::Params params;
  params.energy = {
      .damp_above_J = 0.02, .hold_above_J = 0.05, .credit_J = 0.0, .drain_W = 0.0, .damping_N_s_per_m = 2.0};
  SafetyGate element = gate(params);
  constexpr double pump_N_s_per_m = 4.0, speed_m_per_s = 0.2, omega = 2.0 * std::numbers::pi * 5.0;
  double damped_at_s = -1.0, held_at_s = -1.0;
  for (int tick = 0; tick < 10000; ++tick) {
    const double time_s = tick * tick_s;
    const double position_m = speed_m_per_s / omega * std::sin(omega * time_s);
    const double velocity = speed_m_per_s * std::cos(omega * time_s);
    const double passed_N = element.step({.command_N = pump_N_s_per_m * velocity, .position_m = position_m});
    if (damped_at_s < 0.0 && element.limit() == ActiveLimit::energy) damped_at_s = time_s;
    if (held_at_s < 0.0 && element.fault() == GateFault::energy) held_at_s = time_s;
    if (held_at_s >= 0.0 && time_s > held_at_s + 0.01) {
      // Low-passed at 200 Hz the velocity lags 5 Hz by 1.4 degrees.
      ASSERT_NEAR(passed_N, -2.0 * velocity, 0.05 * 2.0 * speed_m_per_s);
    }
  }
  const double power_W = 0.5 * pump_N_s_per_m * speed_m_per_s * speed_m_per_s;
  EXPECT_NEAR(damped_at_s, 0.02 / power_W, 0.05);
  EXPECT_GT(held_at_s, damped_at_s);
}

/// What passes in a wall and comes out again is not given: a spring pressed a thousand times trips nothing.
TEST(SafetyGate, AWallThatGivesBackWhatItTookTripsNothing) {
  SafetyGate::Params params;
  params.energy = {.damp_above_J = 0.002, .hold_above_J = 0.004, .credit_J = 0.01, .drain_W = 0.0};
  SafetyGate element = gate(params);
  for (int tick = 0; tick < 200000; ++tick) {
    const double position_m = 0.005 * (1.0 - std::cos(0.03 * tick));
    // Held over a tick a spring gives a little back too much, K·T·v²/2 (Colgate and Brown); a damper makes it good.
    const double velocity = 0.005 * 0.03 / tick_s * std::sin(0.03 * tick);
    element.step({.command_N = -100.0 * position_m - 0.05 * velocity, .position_m = position_m});
    ASSERT_EQ(element.limit(), ActiveLimit::none) << tick;
  }
  EXPECT_EQ(element.fault(), GateFault::none);
}

TEST(SafetyGate, AfterAStallTheWayInBetweenIsWorkAndSpeedAndNoJumpWhereTheTimeWasEnough) {
  SafetyGate element = gate({.energy = {.drain_W = 0.0}});
  for (int tick = 0; tick < 100; ++tick) element.step({.command_N = 1.0});
  EXPECT_EQ(element.believe(0.05, 500), 0.05);
  EXPECT_EQ(element.fault(), GateFault::none);
  EXPECT_NEAR(element.given_J(), 1.0 * 0.05, 1e-15);
  EXPECT_NEAR(element.velocity_m_per_s(), 0.05 / 0.1, 1e-9);
}

TEST(SafetyGate, SpeedAndJumpAreJudgedOverTheTimeBetweenMeasurementsWhateverTheTicks) {
  // A bus of 297 cycles a second beside ticks of 500, which once stands still for 24 ms: a joint at 4 rad/s.
  constexpr double period_s = 2e-3, cycle_s = 1.0 / 297.0, speed = 4.0;
  const SafetyGate::Params params{.velocity_limit_m_per_s = 4.5,
                                  .encoder = {.fastest_m_per_s = 6.0, .frozen_force_N = 0.2, .frozen_after_s = 0.01}};
  const auto fault_at = [&](bool age_is_told) {
    SafetyGate element = SafetyGate::make(params, Seconds{period_s}).value();
    for (int tick = 0; tick < 500; ++tick) {
      const double now_s = period_s * tick;
      const double looked_s = tick >= 300 && tick < 312 ? period_s * 300 : now_s;
      const double measured_s = cycle_s * std::floor(looked_s / cycle_s);
      element.believe(speed * measured_s, 1, std::nullopt, age_is_told ? now_s - measured_s : 0.0);
      // The force changes, so an encoder that gave no count would be frozen.
      element.pass(0.5 * std::sin(0.2 * tick));
      if (age_is_told && tick > 20) {
        EXPECT_NEAR(element.velocity_m_per_s(), speed, 1e-6) << tick;
      }
    }
    return element.fault();
  };
  EXPECT_EQ(fault_at(true), GateFault::none);
  EXPECT_NE(fault_at(false), GateFault::none) << "or the limits of this test say nothing";
  // What is beyond them over that time is still found.
  SafetyGate element = SafetyGate::make(params, Seconds{period_s}).value();
  element.believe(0.0, 1, std::nullopt, 0.0);
  element.believe(0.0, 1, std::nullopt, period_s);
  element.believe(6.1 * 2.0 * period_s, 1, std::nullopt, 0.0);
  EXPECT_EQ(element.fault(), GateFault::encoder_jump);
}

TEST(SafetyGate, AMotorThatNothingResistsAndThatStandsStillHasAFrozenEncoder) {
  const SafetyGate made = gate({.encoder = {.unbalanced_force_N = 0.5}});
  const auto fault_after = [&](std::optional<double> resisting_N) {
    SafetyGate element = made;
    for (int tick = 0; tick < 500; ++tick) {
      element.believe(0.0, 1, resisting_N);
      element.pass(1.0);
    }
    return element.fault();
  };
  EXPECT_EQ(fault_after(0.6), GateFault::none) << "pressed against a wall";
  EXPECT_EQ(fault_after(std::nullopt), GateFault::none) << "nobody measures what resists";
  EXPECT_EQ(fault_after(0.0), GateFault::encoder_frozen);
}

TEST(SafetyGate, ConfigurationCanTightenEveryLimitAndLoosenNone) {
  const auto refused = [](auto&& spoil) {
    SafetyGate::Params params;
    spoil(params);
    const auto made = SafetyGate::make(params, Seconds{tick_s});
    if (made) return std::string("accepted");
    EXPECT_NE(made.error().message.find("must"), std::string::npos) << made.error().message;
    return made.error().parameter;
  };
  for (const double loose : {infinity, not_a_number, 0.0, -1.0, 1e7}) {
    EXPECT_EQ(refused([=](auto& p) { p.force_limit_N = loose; }), "force_limit_N");
    EXPECT_EQ(refused([=](auto& p) { p.rate_limit_N_per_s = loose; }), "rate_limit_N_per_s");
    EXPECT_EQ(refused([=](auto& p) { p.velocity_limit_m_per_s = loose; }), "velocity_limit_m_per_s");
    EXPECT_EQ(refused([=](auto& p) { p.position_limit_m = loose; }), "position_limit_m");
    EXPECT_EQ(refused([=](auto& p) { p.encoder.fastest_m_per_s = loose; }), "encoder.fastest_m_per_s");
    EXPECT_EQ(refused([=](auto& p) { p.encoder.frozen_force_N = loose; }), "encoder.frozen_force_N");
    EXPECT_EQ(refused([=](auto& p) { p.encoder.unbalanced_force_N = loose; }), "encoder.unbalanced_force_N");
    EXPECT_EQ(refused([=](auto& p) { p.energy.damp_above_J = loose; }), "energy.damp_above_J");
    EXPECT_EQ(refused([=](auto& p) { p.energy.hold_above_J = loose; }), "energy.hold_above_J");
  }
  EXPECT_TRUE(SafetyGate::make(
      {.force_limit_N = 0.1, .rate_limit_N_per_s = 10.0, .velocity_limit_m_per_s = 0.1, .position_limit_m = 0.01},
      Seconds{tick_s}));
}

}  // namespace safety_gate_test
}  // namespace tactus::control
