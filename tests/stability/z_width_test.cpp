// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/state_space.hpp>
#include <tactus/analysis/stability/z_width.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::stability {
namespace {

/// Real part of the impedance of a device with damping b that renders a stiffness K, force held between samples, as the
/// worst hand sees it: Colgate and Brown's condition over frequency, b > T/2 · Re{(1 − e^{−jωT}) K} / (1 − cos ωT).
double worst_margin(double damping, double stiffness, double tick_s) {
  double worst = damping;
  for (int i = 1; i <= 200; ++i) {
    const double angle = std::numbers::pi * i / 200.0;
    worst = std::min(worst, damping - 0.5 * tick_s / (1.0 - std::cos(angle)) * stiffness * (1.0 - std::cos(angle)));
  }
  return worst;
}

/// Whether a mass with a damper is stable against a sampled spring that answers `delay_ticks` late.
bool stable(double mass, double damping, double stiffness, double tick_s, Eigen::Index delay_ticks) {
  StateSpace body{.a = Eigen::MatrixXd::Zero(2, 2),
                  .b = Eigen::MatrixXd::Zero(2, 1),
                  .c = Eigen::MatrixXd::Zero(1, 2),
                  .d = Eigen::MatrixXd::Zero(1, 1)};
  body.a(0, 1) = 1.0;
  body.a(1, 1) = -damping / mass;
  body.b(1, 0) = 1.0 / mass;
  body.c(0, 0) = 1.0;
  const StateSpace ticks = sampled(body, tick_s, 0.0);
  const Eigen::Index states = 2 + delay_ticks;
  const StateSpace loop = assemble(states, 0, 0, [&](const auto& state, const auto&, auto& next, auto&) {
    const double seen = delay_ticks > 0 ? state[states - 1] : state[0];
    next.head(2) = ticks.a * state.head(2) - ticks.b.col(0) * (stiffness * seen);
    for (Eigen::Index i = 2; i < states; ++i) next[i] = i == 2 ? state[0] : state[i - 1];
  });
  return poles(loop).cwiseAbs().maxCoeff() < 1.0;
}

TEST(ZWidth, PassiveStiffnessIsWhereColgateAndBrownsConditionEndsAtSomeFrequency) {
  const double limit = passive_stiffness_N_per_m(0.8, 0.0, 1e-3);
  EXPECT_DOUBLE_EQ(limit, 1600.0);
  EXPECT_GT(worst_margin(0.8, 0.999 * limit, 1e-3), 0.0);
  EXPECT_LT(worst_margin(0.8, 1.001 * limit, 1e-3), 0.0);
}

TEST(ZWidth, VirtualDampingOfEitherSignCostsPassiveStiffness) {
  EXPECT_DOUBLE_EQ(passive_stiffness_N_per_m(0.8, 0.3, 1e-3), 1000.0);
  EXPECT_DOUBLE_EQ(passive_stiffness_N_per_m(0.8, -0.3, 1e-3), 1000.0);
  EXPECT_DOUBLE_EQ(passive_stiffness_N_per_m(0.2, 0.3, 1e-3), 0.0);
}

TEST(ZWidth, FrictionMustHideAStepOfTheEncoder) {
  EXPECT_DOUBLE_EQ(quantised_stiffness_N_per_m(0.8, 1e-3, 0.02, 1e-4), 400.0);
  EXPECT_DOUBLE_EQ(quantised_stiffness_N_per_m(0.1, 1e-3, 0.02, 1e-4), 200.0);
  EXPECT_DOUBLE_EQ(quantised_stiffness_N_per_m(0.8, 1e-3, 0.02, 0.0), 1600.0);
  // A press through one step and back gains K Δ² / 2 at most, which friction takes on the way there and back.
  const double stiffness = quantised_stiffness_N_per_m(10.0, 1e-3, 0.02, 1e-4), step = 1e-4;
  EXPECT_NEAR(stiffness * step * step, 2.0 * 0.02 * step, 1e-12);
}

TEST(ZWidth, GilAndHulinsBoundIsWhereAHeavyBodyOnASampledSpringBecomesUnstable) {
  const double mass = 5.0, damping = 2.0, tick_s = 1e-3;
  for (const Eigen::Index delay : {0, 1, 3}) {
    const double bound = stable_stiffness_N_per_m(damping, 0.0, tick_s, tick_s * static_cast<double>(delay));
    EXPECT_TRUE(stable(mass, damping, 0.98 * bound, tick_s, delay)) << delay;
    EXPECT_FALSE(stable(mass, damping, 1.02 * bound, tick_s, delay)) << delay;
  }
}

/// Half of what is swept in the last tenth of a run by a body on a sampled, quantised spring with
/// Coulomb friction, over the deflection that it began with. The hand's constant push holds it about `rest_m`.
double left_over(const SampledWall& wall, double mass_kg, double rest_m, double start_m, double duration_s) {
  const int substeps = 50;
  const double h = wall.tick_s / substeps;
  const auto ticks = static_cast<long>(duration_s / wall.tick_s);
  const auto late = static_cast<long>(std::lround(wall.delay_s / wall.tick_s));
  const double push_N = wall.stiffness_N_per_m * rest_m;
  std::vector<double> spring_N(static_cast<std::size_t>(late) + 1, push_N);
  double x = rest_m + start_m, v = 0.0, highest = -1.0, lowest = 1.0;
  for (long tick = 0; tick < ticks; ++tick) {
    const double read_m = wall.resolution_m > 0.0 ? wall.resolution_m * std::round(x / wall.resolution_m) : x;
    std::rotate(spring_N.begin(), spring_N.begin() + 1, spring_N.end());
    spring_N.back() = wall.stiffness_N_per_m * read_m;
    for (int i = 0; i < substeps; ++i) {
      const double v_before = v;
      v += h / mass_kg * (push_N - spring_N.front() - wall.damping_N_s_per_m * v);
      const double stop = h / mass_kg * wall.friction_N;
      v = std::copysign(std::max(0.0, std::fabs(v) - stop), v);
      // With the new velocity alone the spring would act half a step early, which is 2 % of the lag at stake.
      x += 0.5 * h * (v_before + v);
    }
    if (10 * tick >= 9 * ticks) {
      highest = std::max(highest, x);
      lowest = std::min(lowest, x);
    }
    if (std::fabs(x - rest_m) > 100.0 * start_m) return std::fabs(x - rest_m) / start_m;
  }
  return 0.5 * (highest - lowest) / start_m;
}

TEST(ZWidth, MotionGrowsFromTheAmplitudeAtWhichFrictionNoLongerTakesWhatTheLateSpringPutsIn) {
  for (const double delay_s : {0.0, 1e-3}) {
    const double mass_kg = 0.2;
    const SampledWall wall{.stiffness_N_per_m = 1000.0,
                           .damping_N_s_per_m = 0.6 * 1000.0 * (0.5e-3 + delay_s),
                           .friction_N = 0.05,
                           .tick_s = 1e-3,
                           .delay_s = delay_s};
    ASSERT_EQ(wall.behaviour(), WallBehaviour::holds_small_motion);
    const double amplitude_m = wall.growing_from_m(mass_kg);
    EXPECT_LT(left_over(wall, mass_kg, 0.0, 0.95 * amplitude_m, 6.0), 0.9) << delay_s;
    EXPECT_GT(left_over(wall, mass_kg, 0.0, 1.05 * amplitude_m, 6.0), 1.2) << delay_s;
  }
}

TEST(ZWidth, OnTheEdgeOfAStepFrictionOfHalfItsForceMakesTheDifferenceBetweenRestAndBuzz) {
  const double step_m = 1e-4, mass_kg = 0.2;
  SampledWall wall{.stiffness_N_per_m = 1000.0, .damping_N_s_per_m = 0.8, .resolution_m = step_m};
  const double half_N = 0.5 * wall.stiffness_N_per_m * step_m;
  const double edge_m = 0.5 * step_m;
  wall.friction_N = 1.05 * half_N;
  ASSERT_EQ(wall.behaviour(), WallBehaviour::rests);
  EXPECT_EQ(left_over(wall, mass_kg, edge_m, 20.0 * step_m, 3.0), 0.0);
  wall.friction_N = 0.2 * half_N;
  ASSERT_EQ(wall.behaviour(), WallBehaviour::buzzes);
  const double buzz_steps = 20.0 * left_over(wall, mass_kg, edge_m, 20.0 * step_m, 6.0);
  EXPECT_GT(buzz_steps, 0.01);
  EXPECT_LT(buzz_steps, 2.0);
}

TEST(ZWidth, WithoutDampingOrFrictionThatWouldDoEvenSmallMotionGrows) {
  const SampledWall wall{
      .stiffness_N_per_m = 1000.0, .damping_N_s_per_m = 0.2, .friction_N = 0.005, .resolution_m = 1e-4};
  EXPECT_EQ(wall.behaviour(), WallBehaviour::grows);
  EXPECT_GT(left_over(wall, 0.2, 0.5e-4, 2e-3, 6.0), 10.0);
}

TEST(ZWidth, FourRegionsMeetWhereTheBoundsOfGilAndOfAbbottAndOkamuraDo) {
  const SampledWall wall{.damping_N_s_per_m = 0.8, .friction_N = 0.02, .resolution_m = 1e-4, .tick_s = 1e-3};
  EXPECT_DOUBLE_EQ(wall.stiffest_bounded_N_per_m(), stable_stiffness_N_per_m(0.8, 0.0, 1e-3, 0.0));
  EXPECT_DOUBLE_EQ(wall.stiffest_at_rest_N_per_m(), quantised_stiffness_N_per_m(0.8, 1e-3, 0.02, 1e-4));
}

}  // namespace
}  // namespace tactus::stability
