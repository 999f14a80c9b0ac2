// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/mechanics/electric_slave.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/mechanics/reference_chain.hpp"
#include <gtest/gtest.h>

namespace tactus::mechanics {
namespace electric_slave_test {

static_assert(Element<ElectricSlave>);

constexpr Environment::Params wall{.position_m = 0.1, .stiffness_N_per_m = 40000.0, .damping_N_s_per_m = 5.0};

/// A slave without friction and hysteresis whose amplifier answers at once.
ElectricSlave slave(const ReferenceChain& reference, double dt_s, const Environment::Params& environment = wall) {
  ElectricSlave::Params params;
  params.mechanism = reference.params();
  params.amplifier.bandwidth_Hz = 1e12;
  return ElectricSlave::make(params, environment, Seconds{dt_s}).value();
}

/// A linkage that swings out soon, so that the chain coasts as one.
ReferenceChain well_damped() {
  ReferenceChain reference;
  reference.linkage_N_s_per_m = 3.0;
  return reference;
}

double momentum(const ElectricSlave& device, const ReferenceChain& reference) {
  const auto& v = device.mechanism().state().velocity_m_per_s;
  return reference.motor_kg * v[0] + reference.drum_kg * v[1] + reference.tip_kg * v[2];
}

constexpr double push_N = 0.01;
constexpr double push_s = 0.5;

/// Pushes the slave up to a uniform speed of about 0.155 m/s, well before the wall.
void push(ElectricSlave& device, double dt_s) {
  const long steps = std::lround(push_s / dt_s);
  for (long i = 0; i < steps; ++i) device.step(push_N);
}

/// Steps until the tip touches; returns the time of the touch from the first of these steps, or a negative number.
double coast_to_touch(ElectricSlave& device, double dt_s, ElectricSlave::Output& last) {
  for (int i = 0; i < 1000000; ++i) {
    last = device.step(0.0);
    if (last.touched) return i * dt_s + last.touched_after_s;
  }
  return -1.0;
}

TEST(ElectricSlave, AUniformApproachTouchesWhenTheClosedFormSaysWhateverTheSubstep) {
  const ReferenceChain reference = well_damped();
  const double speed_m_per_s = push_N * push_s / reference.total_kg();
  const double pushed_m = 0.5 * speed_m_per_s * push_s;
  for (const double dt_s : {100e-6, 62.5e-6, 40e-6, 10e-6}) {
    for (const double start_m : {0.0, 3.1e-6, 7.7e-6}) {
      ElectricSlave device = slave(reference, dt_s);
      device.reset(start_m);
      push(device, dt_s);
      ElectricSlave::Output last;
      EXPECT_NEAR(coast_to_touch(device, dt_s, last), (wall.position_m - start_m - pushed_m) / speed_m_per_s, 1e-7)
          << "substeps of " << dt_s << " s";
    }
  }
}

TEST(ElectricSlave, AnAcceleratedApproachTouchesWhenTheClosedFormSaysWhateverTheSubstep) {
  const ReferenceChain reference = well_damped();
  constexpr double force_N = 0.5;
  // The chain is stretched by what it has to pull along, so the tip is behind the centre of mass.
  const double acceleration = force_N / reference.total_kg();
  const double linkage_m = reference.tip_kg * acceleration / reference.linkage_N_per_m;
  const double cable_m = (reference.drum_kg + reference.tip_kg) * acceleration / reference.cable_N_per_m;
  const double behind_m =
      (reference.motor_kg * (cable_m + linkage_m) + reference.drum_kg * linkage_m) / reference.total_kg();
  const double expected_s = std::sqrt(2.0 * (wall.position_m + behind_m) / acceleration);
  for (const double dt_s : {100e-6, 62.5e-6, 40e-6, 10e-6}) {
    ElectricSlave device = slave(reference, dt_s);
    double touched_s = 0.0;
    for (int i = 0; i < 20000 && touched_s == 0.0; ++i) {
      const ElectricSlave::Output out = device.step(force_N);
      if (out.touched) touched_s = i * dt_s + out.touched_after_s;
    }
    EXPECT_NEAR(touched_s, expected_s, 1e-7) << "substeps of " << dt_s << " s";
  }
}

TEST(ElectricSlave, ATipThatTheChainHardlyHoldsBouncesLikeASingleMass) {
  // What drags the tip along pulls with less than 0.1 % of the impact.
  ReferenceChain reference;
  reference.linkage_N_per_m = 0.01;
  reference.linkage_N_s_per_m = 0.01;
  constexpr double dt_s = 10e-6;
  ElectricSlave device = slave(reference, dt_s);
  push(device, dt_s);
  double speed_m_per_s = 0.0, peak_N = 0.0, contact_s = 0.0;
  ElectricSlave::Output last;
  for (int i = 0; i < 1000000 && !last.touched; ++i) {
    speed_m_per_s = device.mechanism().tip_velocity_m_per_s();
    last = device.step(0.0);
  }
  ASSERT_TRUE(last.touched);
  for (; last.contact_force_N > 0.0 && contact_s < 0.01; contact_s += dt_s) {
    peak_N = std::max(peak_N, last.contact_force_N);
    last = device.step(0.0);
  }
  ASSERT_GT(speed_m_per_s, 0.05);

  // m ẍ + b ẋ + k x = 0 from x = 0 until the force b ẋ + k x = −m ẍ has gone.
  const double decay = 0.5 * wall.damping_N_s_per_m / reference.tip_kg;
  const double square = wall.stiffness_N_per_m / reference.tip_kg;
  const double turn = std::sqrt(square - decay * decay);
  const double parts_after_s = (std::numbers::pi - std::atan2(2.0 * decay * turn, turn * turn - decay * decay)) / turn;
  const auto velocity = [&](double t) {
    return speed_m_per_s * std::exp(-decay * t) * (std::cos(turn * t) - decay / turn * std::sin(turn * t));
  };
  const auto force_N = [&](double t) {
    const double x = speed_m_per_s / turn * std::exp(-decay * t) * std::sin(turn * t);
    return wall.stiffness_N_per_m * x + wall.damping_N_s_per_m * velocity(t);
  };
  ASSERT_NEAR(force_N(parts_after_s), 0.0, 1e-9);
  double closed_form_peak_N = 0.0;
  for (double t = 0.0; t < parts_after_s; t += 1e-7) closed_form_peak_N = std::max(closed_form_peak_N, force_N(t));

  EXPECT_NEAR(peak_N, closed_form_peak_N, 3e-3 * closed_form_peak_N);
  EXPECT_NEAR(contact_s, parts_after_s, 2.0 * dt_s);
  EXPECT_NEAR(device.mechanism().tip_velocity_m_per_s(), velocity(parts_after_s), 3e-3 * speed_m_per_s);
}

/// An impact of the whole chain: its largest force, how long the tip was pushed, and how it ended.
struct Impact {
  double touched_s = 0.0, peak_N = 0.0, pushed_s = 0.0;
  double impulse_N_s = 0.0, momentum_change_N_s = 0.0;
};

Impact impact(const ReferenceChain& reference, double dt_s, double start_m = 0.0) {
  ElectricSlave device = slave(reference, dt_s);
  device.reset(start_m);
  push(device, dt_s);
  const double before = momentum(device, reference);
  ElectricSlave::Output last;
  Impact result;
  result.touched_s = coast_to_touch(device, dt_s, last);
  for (int i = 0; i < std::lround(0.02 / dt_s); ++i) {
    result.impulse_N_s += last.contact_force_N * dt_s;
    result.peak_N = std::max(result.peak_N, last.contact_force_N);
    if (last.contact_force_N > 0.0) result.pushed_s += dt_s;
    last = device.step(0.0);
  }
  result.impulse_N_s += last.contact_force_N * dt_s;
  result.momentum_change_N_s = momentum(device, reference) - before;
  return result;
}

TEST(ElectricSlave, AnImpactOfTheWholeChainMeetsAFineIntegrationOfTheSameEquations) {
  const ReferenceChain reference = well_damped();
  ElectricSlave device = slave(reference, 10e-6);
  push(device, 10e-6);
  for (int i = 0; i < 100000 && device.mechanism().tip_position_m() < wall.position_m - 1e-4; ++i) device.step(0.0);

  const CableChain::State& before = device.mechanism().state();
  ReferenceChain::State exact;
  std::copy_n(before.position_m.begin(), 3, exact.begin());
  std::copy_n(before.velocity_m_per_s.begin(), 3, exact.begin() + 3);
  const auto wall_N = [&](const ReferenceChain::State& x) {
    const double depth_m = x[2] - wall.position_m;
    return depth_m > 0.0 ? std::max(0.0, wall.stiffness_N_per_m * depth_m + wall.damping_N_s_per_m * x[5]) : 0.0;
  };
  const auto system = [&](const ReferenceChain::State& x, ReferenceChain::State& change, double) {
    reference.derivative(x, change, {.tip_N = -wall_N(x)});
  };
  boost::numeric::odeint::runge_kutta4<ReferenceChain::State> fine;

  double peak_N = 0.0, exact_peak_N = 0.0, worst_m = 0.0;
  for (int i = 0; i < 3000; ++i) {
    peak_N = std::max(peak_N, device.step(0.0).contact_force_N);
    for (int part = 0; part < 20; ++part) {
      fine.do_step(system, exact, 0.0, 0.5e-6);
      exact_peak_N = std::max(exact_peak_N, wall_N(exact));
    }
    for (std::size_t body = 0; body < 3; ++body) {
      worst_m = std::max(worst_m, std::fabs(device.mechanism().state().position_m[body] - exact[body]));
    }
  }
  ASSERT_GT(exact_peak_N, 1.0);
  EXPECT_NEAR(peak_N, exact_peak_N, 5e-3 * exact_peak_N);
  // Of 5 mm that it travels meanwhile: the wall's damping is held over a substep and so of first order.
  EXPECT_LT(worst_m, 2e-6);
}

TEST(ElectricSlave, HalvingTheSubstepChangesPeakForceAndContactTimeByLessThanOnePercent) {
  const ReferenceChain reference;
  const Impact coarse = impact(reference, 40e-6);
  const Impact fine = impact(reference, 20e-6);
  EXPECT_NEAR(coarse.peak_N, fine.peak_N, 0.01 * fine.peak_N);
  EXPECT_NEAR(coarse.touched_s, fine.touched_s, 1e-6);
  EXPECT_NEAR(coarse.pushed_s, fine.pushed_s, 0.01 * fine.pushed_s + 40e-6);
}

TEST(ElectricSlave, AnImpactDoesNotDependOnWhereTheSubstepsFell) {
  const ReferenceChain reference = well_damped();
  constexpr double dt_s = 40e-6;
  const double speed_m_per_s = push_N * push_s / reference.total_kg();
  const double whole = impact(reference, dt_s).momentum_change_N_s;
  for (int part = 1; part < 8; ++part) {
    const Impact shifted = impact(reference, dt_s, speed_m_per_s * dt_s * part / 8.0);
    EXPECT_NEAR(shifted.momentum_change_N_s, whole, 2e-3 * std::fabs(whole)) << part;
  }
}

TEST(ElectricSlave, TheReportedForceIntegratesToTheChangeOfMomentum) {
  const Impact hit = impact(well_damped(), 40e-6);
  ASSERT_GT(hit.impulse_N_s, 1e-3);
  EXPECT_NEAR(hit.momentum_change_N_s, -hit.impulse_N_s, 1e-12);
}

TEST(ElectricSlave, TheWallNeverPullsAndATouchComesOutOfAGap) {
  ElectricSlave device = ElectricSlave::make({}, {.position_m = 1e-3}, Seconds{40e-6}).value();
  int touches = 0;
  for (int i = 0; i < 200000; ++i) {
    const double tip_before_m = device.mechanism().tip_position_m();
    const ElectricSlave::Output out = device.step(0.3 + std::sin(0.004 * i) + 0.5 * std::sin(0.11 * i));
    ASSERT_GE(out.contact_force_N, 0.0);
    ASSERT_GE(out.touched_after_s, 0.0);
    ASSERT_LE(out.touched_after_s, 40e-6);
    if (out.touched) {
      ASSERT_LT(tip_before_m, 1e-3);
      ++touches;
    }
  }
  EXPECT_GT(touches, 20);
}

TEST(ElectricSlave, ASteadyPushIsBalancedByTheWallThroughEverySpring) {
  const ReferenceChain reference = well_damped();
  ElectricSlave device = slave(reference, 40e-6, {.position_m = 0.0});
  constexpr double force_N = 0.5;
  ElectricSlave::Output last;
  for (int i = 0; i < 50000; ++i) last = device.step(force_N);
  EXPECT_NEAR(last.contact_force_N, force_N, 1e-9);
  EXPECT_NEAR(device.measure().tip_force_N, force_N, 1e-9);
  EXPECT_NEAR(device.mechanism().tip_position_m(), force_N / 40000.0, 1e-12);
  EXPECT_NEAR(device.mechanism().motor_position_m(),
              force_N * (1.0 / 40000.0 + 1.0 / reference.linkage_N_per_m + 1.0 / reference.cable_N_per_m), 1e-12);
}

TEST(ElectricSlave, AfterAResetItRestsWhereItWasPut) {
  ElectricSlave device = ElectricSlave::make({}, wall, Seconds{40e-6}).value();
  for (int i = 0; i < 1000; ++i) device.step(3.0);
  device.reset(0.05);
  EXPECT_EQ(device.measure().motor_position_m, 0.05);
  EXPECT_EQ(device.step(0.0).contact_force_N, 0.0);
  EXPECT_EQ(device.mechanism().tip_position_m(), 0.05);
}

TEST(ElectricSlave, AWallTooStiffOrTooViscousForTheSubstepIsRefusedByName) {
  const auto stiff = ElectricSlave::make({}, {.stiffness_N_per_m = 1e7}, Seconds{100e-6});
  ASSERT_FALSE(stiff);
  EXPECT_EQ(stiff.error().parameter, "environment.stiffness_N_per_m");
  const auto viscous = ElectricSlave::make({}, {.damping_N_s_per_m = 1e4}, Seconds{40e-6});
  ASSERT_FALSE(viscous);
  EXPECT_EQ(viscous.error().parameter, "environment.damping_N_s_per_m");
  ElectricSlave::Params params;
  params.mechanism.cable.stiffness_N_per_m = 1e9;
  EXPECT_EQ(ElectricSlave::make(params, Seconds{40e-6}).error().parameter, "mechanism.cable.stiffness_N_per_m");
}

}  // namespace electric_slave_test
}  // namespace tactus::mechanics
