// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/architecture.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "tests/control/rivals.hpp"
#include <gtest/gtest.h>

// The remedies of paper A, Sec. IV, together: their order in the site, what is off, and what ends in a gate.
namespace tactus::control {
namespace rivals_order_test {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// A site with every stage at work.
Params everything() {
  Params params;
  params.force_gain = 3.0;
  params.damping.damping_N_s_per_m = 5.0;
  params.command_filter = {.kind = Shaping::low_pass, .frequency_Hz = 30.0};
  params.force_filter = {.kind = Shaping::notch, .frequency_Hz = 75.0, .notch_width_Hz = 50.0};
  params.crossover.frequency_Hz = 40.0;
  return params;
}

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }

TEST(Rivals, SwitchedOffTheyChangeNoBitWhateverElseIsSetOfThem) {
  Params params;
  params.cancellation = CancellationMode::off;
  params.position_scale = 0.3;
  params.force_gain = 2.0;
  // None of these could run at this servo rate.
  params.damping.velocity.cutoff_Hz = 1e6;
  params.command_filter.frequency_Hz = 1e6;
  params.force_filter.notch_width_Hz = 1e6;
  PositionForceMaster site = master(params);
  for (int tick = 0; tick < 1000; ++tick) {
    const double position_m = tick % 7 == 0 ? -0.0 : 0.02 * std::sin(0.01 * tick);
    const double tip_force_N = tick % 5 == 0 ? -0.0 : std::cos(0.02 * tick);
    const auto out = site.step(input(position_m, tip_force_N));
    ASSERT_EQ(bits(out.message.position_m), bits(0.3 * position_m));
    ASSERT_EQ(bits(out.motor_force_N), bits(-std::clamp(2.0 * tip_force_N, -1.0, 1.0)));
    ASSERT_EQ(out.handle_force_N, 0.0);
  }
}

TEST(Rivals, TheCommandFilterComesAfterCancellation) {
  Params params;
  params.force_limit_N = 100.0;
  params.damping.damping_N_s_per_m = 4.0;
  PositionForceMaster unfiltered = master(params);
  params.command_filter = {.kind = Shaping::low_pass, .frequency_Hz = 25.0};
  PositionForceMaster filtered = master(params);

  // The same low-pass as a difference equation over the commands of the other site.
  const double k = std::tan(0.5 * angle_of(25.0));
  const double scale = 1.0 / (1.0 + std::numbers::sqrt2 * k + k * k);
  std::vector<double> x{0.05, 0.05}, y{0.05, 0.05};
  for (int tick = 0; tick < 2000; ++tick) {
    const MasterInput in = input(0.05 + 1e-3 * std::sin(0.02 * tick), tick % 400 < 200 ? 0.7 : 0.0);
    x.push_back(unfiltered.step(in).message.position_m);
    const std::size_t n = x.size() - 1;
    y.push_back(scale * (k * k * (x[n] + 2.0 * x[n - 1] + x[n - 2]) - 2.0 * (k * k - 1.0) * y[n - 1] -
                         (1.0 - std::numbers::sqrt2 * k + k * k) * y[n - 2]));
    if (tick == 0) {
      // The first sample stands for all before it.
      x = {x[n], x[n], x[n]};
      y = {x[n], x[n], x[n]};
    }
    ASSERT_NEAR(filtered.step(in).message.position_m, y.back(), 1e-12) << tick;
  }
}

TEST(Rivals, DampingComesAfterForceFilterAndCrossover) {
  Params damped = plain();
  damped.damping.damping_N_s_per_m = 3.0;
  Params all = damped;
  all.force_filter = {.kind = Shaping::low_pass, .frequency_Hz = 10.0};
  all.crossover.frequency_Hz = 10.0;
  PositionForceMaster with = master(all), without = master(damped);
  for (int tick = 0; tick < 500; ++tick) {
    const MasterInput in = input(1e-3 * std::sin(0.3 * tick), 0.0);
    const auto out = with.step(in);
    ASSERT_EQ(out.motor_force_N, without.step(in).motor_force_N);
    ASSERT_EQ(out.handle_force_N, 0.0);
  }
}

TEST(Rivals, SaturationComesLastAndBoundsMotorAndHandleEach) {
  Params params = plain();
  params.force_limit_N = 0.6;
  params.damping.damping_N_s_per_m = 50.0;
  params.crossover.frequency_Hz = 50.0;
  PositionForceMaster site = master(params);
  double motor_N = 0.0, handle_N = 0.0;
  for (int tick = 0; tick < 2000; ++tick) {
    const auto out = site.step(input(0.01 * std::sin(0.1 * tick), 20.0 * std::sin(0.03 * tick)));
    motor_N = std::max(motor_N, std::fabs(out.motor_force_N));
    handle_N = std::max(handle_N, std::fabs(out.handle_force_N));
  }
  EXPECT_EQ(motor_N, 0.6);
  EXPECT_EQ(handle_N, 0.6);
}

TEST(Rivals, TheModelOfCancellationIsDrivenByTheDampingAndNotByTheHandle) {
  Params params;
  params.model.linkage.hysteretic_fraction = 0.0;
  params.cancellation_friction = ModelFriction::at_rest;
  params.damping.damping_N_s_per_m = 4.0;
  params.crossover.frequency_Hz = 50.0;
  PositionForceMaster site = master(params);
  InducedMotionModel reference =
      InducedMotionModel::make({.master = params.model, .friction = ModelFriction::at_rest}, Seconds{tick_s}).value();
  double largest_m = 0.0;
  for (int tick = 0; tick < 1000; ++tick) {
    const auto out = site.step(input(1e-3 * std::sin(0.05 * tick), tick % 200 < 100 ? 0.5 : 0.0));
    ASSERT_EQ(out.induced_position_m, reference.motor_position_m());
    reference.step({.motor_force_N = out.motor_force_N});
    largest_m = std::max(largest_m, std::fabs(out.induced_position_m));
  }
  EXPECT_GT(largest_m, 1e-4);
}

MasterSite gated(const Params& params, const ForceGate::Params& handle = {}) {
  ControlParams control;
  static_cast<Params&>(control) = params;
  control.handle_gate = handle;
  return make_sites(control, Seconds{tick_s}).value().master;
}

TEST(Rivals, ANumberLostAnywhereReleasesMotorAndHandleAtTheRateLimitUntilReset) {
  for (const MasterInput& bad : {input(not_a_number, 0.2), input(0.01, not_a_number)}) {
    MasterSite site = gated(everything());
    MasterOutput before;
    for (int tick = 0; tick < 60; ++tick) before = site.step(input(0.01, tick < 55 ? 0.0 : 0.25));
    ASSERT_GT(std::fabs(before.handle_force_N), 0.1);
    EXPECT_EQ(site.fault(), GateFault::none);
    for (int tick = 0; tick < 10; ++tick) {
      const auto out = site.step(tick == 0 ? bad : input(0.01, 0.25));
      EXPECT_EQ(out.motor_force_N, 0.0);
      EXPECT_EQ(out.handle_force_N, 0.0);
      EXPECT_EQ(site.fault(), GateFault::not_finite);
    }
    site.reset();
    EXPECT_EQ(site.fault(), GateFault::none);
    MasterSite fresh = gated(everything());
    for (int tick = 0; tick < 100; ++tick) {
      const MasterInput in = input(0.01 + 1e-5 * tick, 0.1);
      const auto out = site.step(in), expected = fresh.step(in);
      ASSERT_EQ(out.motor_force_N, expected.motor_force_N);
      ASSERT_EQ(out.handle_force_N, expected.handle_force_N);
      ASSERT_EQ(out.message.position_m, expected.message.position_m);
    }
  }
}

TEST(Rivals, APositionThatIsNoNumberClosesTheMastersGateAndDoesNotReachTheCommandFilter) {
  Params params = plain();
  params.command_filter.kind = Shaping::low_pass;
  MasterSite site = gated(params);
  auto slave = make_sites({}, Seconds{tick_s}).value().slave;
  slave.step({.arrival = {.message = site.step(input(0.01, 0.0)).message, .fresh = true}});
  for (const double position_m : {not_a_number, 0.01}) {
    const auto sent = site.step(input(position_m, 0.0)).message;
    EXPECT_EQ(site.fault(), GateFault::not_finite);
    ASSERT_TRUE(is_finite(sent));
    EXPECT_TRUE(std::isfinite(slave.step({.arrival = {.message = sent, .fresh = true}}).motor_force_N));
    EXPECT_EQ(slave.fault(), GateFault::none);
  }
}

TEST(Rivals, TheHandlesForceStaysWithinTheLimitsOfItsOwnGate) {
  Params params = plain();
  params.crossover.frequency_Hz = 20.0;
  MasterSite site = gated(params, {.force_limit_N = 0.25, .rate_limit_N_per_s = 250.0});
  double before_N = 0.0, largest_N = 0.0;
  for (int tick = 0; tick < 3000; ++tick) {
    const double handle_N = site.step(input(0.0, tick % 300 < 150 ? 5.0 : -5.0)).handle_force_N;
    ASSERT_LE(std::fabs(handle_N - before_N), 0.05 + 1e-12);
    largest_N = std::max(largest_N, std::fabs(handle_N));
    before_N = handle_N;
  }
  EXPECT_EQ(largest_N, 0.25);
}

/// A master that answers with what the test says.
struct Scripted {
  double motor_N, handle_N;
  MasterOutput respond(const MasterInput&) noexcept {
    MasterOutput output;
    output.motor_force_N = motor_N;
    output.handle_force_N = handle_N;
    return output;
  }
  void reset() noexcept {}
};

TEST(MasterSite, WithOneGateGivenTheHandleGetsTheSameLimits) {
  const auto gate = SafetyGate::make({.force_limit_N = 0.5, .rate_limit_N_per_s = 1000.0}, Seconds{tick_s}).value();
  MasterSite site(master_controller(Scripted{.motor_N = 0.1, .handle_N = -900.0}), gate);
  for (const double expected_N : {-0.2, -0.4, -0.5, -0.5}) {
    const auto out = site.step({});
    EXPECT_DOUBLE_EQ(out.motor_force_N, 0.1);
    EXPECT_DOUBLE_EQ(out.handle_force_N, expected_N);
  }
}

TEST(MasterSite, AFaultOfEitherActuatorReleasesBoth) {
  const auto gate = SafetyGate::make({}, Seconds{tick_s}).value();
  for (const double bad : {not_a_number, std::numeric_limits<double>::infinity()}) {
    for (const Scripted& script : {Scripted{.motor_N = 0.1, .handle_N = bad}, Scripted{bad, 0.1}}) {
      MasterSite site(master_controller(script), gate);
      const auto out = site.step({});
      EXPECT_EQ(out.motor_force_N, 0.0);
      EXPECT_EQ(out.handle_force_N, 0.0);
      EXPECT_EQ(site.fault(), GateFault::not_finite);
    }
  }
}

TEST(Rivals, WhatThisServoRateCannotCarryIsRefusedByName) {
  const auto refused = [](auto&& change) {
    ControlParams params;
    change(params);
    const auto sites = make_sites(params, Seconds{tick_s});
    return sites ? std::string("was made") : sites.error().parameter;
  };
  EXPECT_EQ(refused([](auto& p) { p.command_filter = {.kind = Shaping::low_pass, .frequency_Hz = 2500.0}; }),
            "command_filter.frequency_Hz");
  EXPECT_EQ(refused([](auto& p) { p.force_filter = {.kind = Shaping::notch, .notch_width_Hz = 2500.0}; }),
            "force_filter.notch_width_Hz");
  EXPECT_EQ(refused([](auto& p) { p.crossover.frequency_Hz = 2500.0; }), "crossover.frequency_Hz");
  EXPECT_EQ(refused([](auto& p) { p.damping = {.damping_N_s_per_m = 1.0, .velocity = {.cutoff_Hz = 2400.0}}; }),
            "damping.velocity.cutoff_Hz");
  EXPECT_EQ(refused([](auto& p) { p.handle_gate.force_limit_N = 1e3; }), "handle_gate.force_limit_N");
}

}  // namespace rivals_order_test
}  // namespace tactus::control
