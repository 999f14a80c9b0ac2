// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/reversal_check.hpp>
#include <tactus/kernel/control/safety_gate.hpp>
#include <tactus/kernel/control/sign_probe.hpp>
#include <tactus/kernel/control/thermal_limit.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

#include "tests/control/rubbing_device.hpp"
#include <gtest/gtest.h>

/// What looks at the motor itself: is it too warm, does it push the way it should, does it push at all.
namespace tactus::control {
namespace motor_checks_test {

using test::Device;

constexpr double tick_s = 200e-6;
constexpr Seconds tick{tick_s};

// ---- warmth ----

TEST(ThermalLimit, APeakIsGivenAsLongAsTheFormulaSaysThenFoldsBackWithoutAStepToTheContinuousForceAndStaysThere) {
  constexpr double continuous_N = 2.0, time_constant_s = 0.5, peak_N = 5.0;
  ThermalLimit limit =
      ThermalLimit::make({.continuous_force_N = continuous_N, .time_constant_s = time_constant_s}, tick).value();
  double folds_at_s = -1.0, given_N = peak_N, largest_step_N = 0.0, square = 0.0;
  const int ticks = 50000;
  for (int i = 0; i < ticks; ++i) {
    const double allowed_N = limit.step({.acted_N = given_N, .peak_N = peak_N});
    ASSERT_GE(allowed_N, continuous_N);
    if (folds_at_s < 0.0 && allowed_N < peak_N) folds_at_s = i * tick_s;
    largest_step_N = std::max(largest_step_N, std::fabs(allowed_N - given_N));
    given_N = allowed_N;
    if (i >= ticks / 2) square += given_N * given_N;
  }
  const double expected_s = -time_constant_s * std::log(1.0 - 0.75 * continuous_N * continuous_N / (peak_N * peak_N));
  EXPECT_NEAR(folds_at_s, expected_s, 2.0 * tick_s);
  EXPECT_LT(largest_step_N, 0.05);
  EXPECT_NEAR(std::sqrt(square / (ticks / 2)), continuous_N, 1e-3);
}

TEST(ThermalLimit, WhatALateLoopGaveCountsForTheTimeThatPassedAndWhatIsBelowTheRatingAlwaysPasses) {
  const ThermalLimit::Params params{.continuous_force_N = 2.0, .time_constant_s = 0.5};
  ThermalLimit late = ThermalLimit::make(params, tick).value(), timely = late;
  for (int i = 0; i < 100; ++i) {
    late.step({.acted_N = 3.0, .peak_N = 5.0, .elapsed_ticks = 9});
    for (int k = 0; k < 9; ++k) timely.step({.acted_N = 3.0, .peak_N = 5.0});
  }
  EXPECT_NEAR(late.warmth(), timely.warmth(), 1e-12);
  EXPECT_EQ(late.step({.acted_N = 1.0, .peak_N = 1.9}), 1.9);
}

TEST(SafetyGate, AForceAboveTheContinuousRatingFoldsBackAndReArmingCoolsNoMotor) {
  SafetyGate::Params params{.force_limit_N = 5.0, .rate_limit_N_per_s = 1000.0};
  params.thermal = {.continuous_force_N = 2.0, .time_constant_s = 0.5};
  SafetyGate gate = SafetyGate::make(params, tick).value();
  double before_N = 0.0;
  for (int i = 0; i < 10000; ++i) {
    const double passed_N = gate.step({.command_N = 4.0, .position_m = 0.0});
    ASSERT_LE(std::fabs(passed_N - before_N), 1000.0 * tick_s + 1e-12);
    before_N = passed_N;
  }
  EXPECT_NEAR(before_N, 2.0, 1e-3);
  EXPECT_EQ(gate.limit(), ActiveLimit::thermal);
  EXPECT_EQ(gate.fault(), GateFault::none);
  gate.rearm();
  EXPECT_NEAR(gate.step({.command_N = 4.0, .position_m = 0.0}), 2.0, 2e-3);
  gate.reset();
  for (int i = 0; i < 30; ++i) before_N = gate.step({.command_N = 4.0, .position_m = 0.0});
  EXPECT_EQ(before_N, 4.0) << "as made";
}

// ---- reversal ----

constexpr ReversalCheck::Params reversal{.force_N = 0.1, .gained_m_per_s = 0.05, .lasting_s = 0.005};

/// A device under a servo that pulls it to where it is told, and a wall at 5 mm.
struct Servoed {
  Device device;
  SafetyGate gate;
  double stiffness_N_per_m = 100.0, damping_N_s_per_m = 0.65;
  double wall_N_per_m = 20000.0;
  double before_m = 0.0;
  double fastest_m_per_s = 0.0;

  static Servoed make(double gain, bool checked = true) {
    SafetyGate::Params params{.force_limit_N = 5.0, .rate_limit_N_per_s = 2000.0};
    if (checked) params.reversal = reversal;
    return {.device = {.gain = gain}, .gate = SafetyGate::make(params, tick).value()};
  }
  void follow(double told_m, int elapsed = 1) {
    const double tip_N = std::max(0.0, wall_N_per_m * (device.position_m - 0.005));
    const double read_m = device.read_m();
    gate.believe(read_m, elapsed, tip_N);
    const double rate = (read_m - before_m) / (tick_s * elapsed);
    before_m = read_m;
    const double force_N = gate.pass(stiffness_N_per_m * (told_m - read_m) - damping_N_s_per_m * rate);
    for (int i = 0; i < elapsed; ++i) {
      device.push(force_N, -std::max(0.0, wall_N_per_m * (device.position_m - 0.005)));
    }
    fastest_m_per_s = std::max(fastest_m_per_s, std::fabs(device.velocity_m_per_s));
  }
};

TEST(ReversalCheck, AMotorTheWrongWayRoundIsLatchedBeforeTheDeviceIsFast) {
  Servoed unchecked = Servoed::make(-1.0, false);
  for (int i = 0; i < 400; ++i) unchecked.follow(0.002);
  EXPECT_GT(unchecked.fastest_m_per_s, 3.0) << "runs away where nothing looks";
  for (const int elapsed : {1, 2, 7}) {
    Servoed servoed = Servoed::make(-1.0);
    for (int i = 0; i < 400; ++i) servoed.follow(0.002, elapsed);
    EXPECT_EQ(servoed.gate.fault(), GateFault::reversed);
    EXPECT_LT(servoed.fastest_m_per_s, 0.3) << elapsed;
  }
}

TEST(ReversalCheck, ChatterOnAWallABrisklyMovedCommandAndReleaseFromContactAreNoReversal) {
  Servoed servoed = Servoed::make(1.0);
  for (int i = 0; i < 100000; ++i) {
    const double time_s = i * tick_s;
    const double told_m = 0.01 * std::sin(2.0 * std::numbers::pi * 1.3 * time_s) + (i / 5000 % 2 == 0 ? 0.003 : -0.003);
    servoed.follow(told_m);
    ASSERT_EQ(servoed.gate.fault(), GateFault::none) << time_s;
  }
  EXPECT_GT(servoed.fastest_m_per_s, 0.2);
}

/// A person pushes the handle against a displayed force. With a sensor in the hand that is no reversal; without one,
/// only the default that is out of reach lets it pass.
TEST(ReversalCheck, AHandMayPushAgainstTheForceWhereASensorMeasuresTheHand) {
  for (const bool sensed : {true, false}) {
    SafetyGate::Params params;
    params.reversal = reversal;
    SafetyGate gate = SafetyGate::make(params, tick).value();
    Device handle{.mass_kg = 0.3, .friction_N = 0.05};
    for (int i = 0; i < 2000; ++i) {
      const double hand_N = 4.0 * std::sin(2.0 * std::numbers::pi * 2.0 * i * tick_s);
      gate.believe(handle.read_m(), 1, sensed ? std::optional(-hand_N) : std::nullopt);
      handle.push(gate.pass(-1.0), hand_N);
    }
    EXPECT_EQ(gate.fault(), sensed ? GateFault::none : GateFault::reversed);
  }
}

// ---- probe ----

struct Probed {
  ProbeVerdict verdict = ProbeVerdict::none;
  double impulse_N_s = 0.0;
  double largest_N = 0.0;
  double steepest_N_per_s = 0.0;
  double ends_at_m = 0.0;
};

Probed probe(Device device, const SignProbe::Params& params = {.force_N = 0.3, .duration_s = 0.1}, int elapsed = 1) {
  SignProbe element = SignProbe::make(params, tick).value();
  Probed probed;
  double before_N = 0.0;
  for (int i = 0; i < 1000 && element.verdict() == ProbeVerdict::none; ++i) {
    const double force_N = element.step({.probing = true, .position_m = device.read_m(), .elapsed_ticks = elapsed});
    for (int k = 0; k < elapsed; ++k) device.push(force_N);
    probed.impulse_N_s += force_N * tick_s * elapsed;
    probed.largest_N = std::max(probed.largest_N, std::fabs(force_N));
    probed.steepest_N_per_s = std::max(probed.steepest_N_per_s, std::fabs(force_N - before_N) / tick_s);
    before_N = force_N;
  }
  probed.verdict = element.verdict();
  probed.ends_at_m = device.position_m;
  return probed;
}

TEST(SignProbe, AMassASpringAndADamperThatFollowTheMotorPassAndTheForceIsSmoothAndHasNoImpulse) {
  const Device free{}, sprung{.spring_N_per_m = 500.0, .damper_N_s_per_m = 4.0}, viscous{.damper_N_s_per_m = 3.0},
      heavy{.mass_kg = 0.3}, rubbing{.friction_N = 0.15};
  for (const Device& device : {free, sprung, viscous, heavy, rubbing}) {
    const Probed probed = probe(device);
    EXPECT_EQ(probed.verdict, ProbeVerdict::passed) << device.mass_kg << ' ' << device.friction_N;
    EXPECT_NEAR(probed.impulse_N_s, 0.0, 1e-9);
    EXPECT_NEAR(probed.largest_N, 0.3, 1e-3);
    EXPECT_LT(probed.steepest_N_per_s, 0.3 * std::numbers::pi * 5.0 / 0.1 * 1.001);
    EXPECT_LT(std::fabs(probed.ends_at_m), 1e-3);
    EXPECT_EQ(probe(device, {.force_N = 0.3}, 3).verdict, ProbeVerdict::passed) << "a late loop";
  }
}

TEST(SignProbe, AMotorOrAnEncoderTheWrongWayRoundIsFound) {
  for (Device device : {Device{}, Device{.spring_N_per_m = 500.0, .damper_N_s_per_m = 4.0}, Device{.mass_kg = 0.004}}) {
    device.gain = -1.0;
    EXPECT_EQ(probe(device).verdict, ProbeVerdict::reversed);
  }
}

TEST(SignProbe, ADeadActuatorAClampedHandleAndAFrozenEncoderDoNotMove) {
  EXPECT_EQ(probe({.gain = 0.0}).verdict, ProbeVerdict::still);
  EXPECT_EQ(probe({.friction_N = 1.0}).verdict, ProbeVerdict::still);
  EXPECT_EQ(probe({.spring_N_per_m = 1e5, .damper_N_s_per_m = 30.0}).verdict, ProbeVerdict::still);
}

TEST(SignProbe, ADeviceThatGoesTooFarOrIsMovedBySomebodyElseDoesNotPass) {
  EXPECT_EQ(probe({.mass_kg = 0.003, .friction_N = 0.0}).verdict, ProbeVerdict::astray);
  EXPECT_EQ(probe({.spring_N_per_m = 5000.0, .damper_N_s_per_m = 20.0, .drift_m_per_s = 0.05}).verdict,
            ProbeVerdict::astray);
  EXPECT_EQ(SignProbe::make({.least_m = 0.01, .most_m = 0.01}, tick).error().parameter, "most_m");
}

/// Joints from a trigger to an arm's shoulder, in kg m², by one set of parameters: that of examples/rigs/joints.toml.
/// A free mass moves by F·T²/(50·m).
TEST(SignProbe, ADeviceThatDoesNotMoveIsTriedWithTwiceTheForceUpToTheMost) {
  const SignProbe::Params params{
      .force_N = 0.2, .most_force_N = 1.5, .duration_s = 0.2, .least_m = 0.002, .most_m = 0.2};
  struct Case {
    Device device;
    ProbeVerdict verdict;
    double force_N;  ///< of the last trial
  };
  const Case cases[] = {{{.mass_kg = 0.0025, .friction_N = 0.0}, ProbeVerdict::passed, 0.2},
                        {{.mass_kg = 0.07, .friction_N = 0.0}, ProbeVerdict::passed, 0.2},
                        {{.mass_kg = 0.15, .friction_N = 0.0}, ProbeVerdict::passed, 0.4},
                        {{.mass_kg = 0.3, .friction_N = 0.0}, ProbeVerdict::passed, 0.8},
                        {{.mass_kg = 0.5, .friction_N = 0.0}, ProbeVerdict::passed, 1.5},
                        {{.mass_kg = 0.7, .friction_N = 0.0}, ProbeVerdict::still, 1.5},
                        {{.mass_kg = 0.03, .friction_N = 0.5}, ProbeVerdict::passed, 1.5},
                        {{.mass_kg = 0.3, .friction_N = 0.0, .gain = -1.0}, ProbeVerdict::reversed, 0.8},
                        {{.gain = 0.0}, ProbeVerdict::still, 1.5}};
  for (const Case& one : cases) {
    SignProbe element = SignProbe::make(params, tick).value();
    Device device = one.device;
    double largest_N = 0.0, time_s = 0.0;
    for (; element.verdict() == ProbeVerdict::none && time_s < 2.0; time_s += tick_s) {
      const double force_N = element.step({.probing = true, .position_m = device.read_m()});
      largest_N = std::max(largest_N, std::fabs(force_N));
      device.push(force_N);
    }
    SCOPED_TRACE(one.device.mass_kg);
    EXPECT_EQ(element.verdict(), one.verdict);
    EXPECT_LE(largest_N, one.force_N);
    EXPECT_LE(time_s, SignProbe::longest_s(params) + tick_s);
    element.step({});
    EXPECT_EQ(element.report().verdict, one.verdict) << "kept after the trial";
    EXPECT_NEAR(element.report().force_N, one.force_N, 1e-12);
    if (one.verdict == ProbeVerdict::still) {
      EXPECT_LT(element.report().moved_m, params.least_m);
    }
    if (one.force_N > 0.2 && one.device.friction_N == 0.0) {
      EXPECT_LT(element.report().moved_m, 4.0 * params.least_m) << "none is thrown";
    }
  }
  SignProbe::Params once = params;
  once.force_N = 0.4;
  once.most_force_N = 0.0;
  EXPECT_EQ(SignProbe::longest_s(params), 4 * 0.2);
  EXPECT_EQ(SignProbe::longest_s(once), 0.2);
  EXPECT_EQ(SignProbe::make({.force_N = 0.3, .most_force_N = 0.2}, tick).error().parameter, "most_force_N");
}

TEST(SignProbe, WhereNobodyAsksOrTheTrialIsGivenUpThereIsNoForceAndNoVerdict) {
  SignProbe element = SignProbe::make({.force_N = 0.3}, tick).value();
  for (int i = 0; i < 100; ++i) EXPECT_EQ(element.step({.position_m = 0.01 * i}), 0.0);
  for (int i = 0; i < 100; ++i) element.step({.probing = true});
  EXPECT_EQ(element.step({}), 0.0);
  EXPECT_EQ(element.step({.probing = true, .position_m = 5.0}), 0.0) << "begins anew, where the device is";
  EXPECT_EQ(element.verdict(), ProbeVerdict::none);
}

}  // namespace motor_checks_test
}  // namespace tactus::control
