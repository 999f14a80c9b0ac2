// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/mechanics/friction.hpp>

#include <cmath>
#include <random>
#include <vector>

#include "tests/oracle_table.hpp"
#include <gtest/gtest.h>

namespace tactus::mechanics {
namespace friction_test {

static_assert(Element<CoulombFriction>);

CoulombFriction friction(double force_N, double dt_s) {
  return CoulombFriction::make({.force_N = force_N}, Seconds{dt_s}).value();
}

TEST(SoftThreshold, TakesTheLimitOffTheMagnitudeAndStopsAtZero) {
  EXPECT_EQ(soft_threshold(5.0, 2.0), 3.0);
  EXPECT_EQ(soft_threshold(-5.0, 2.0), -3.0);
  EXPECT_EQ(soft_threshold(1.5, 2.0), 0.0);
  EXPECT_EQ(soft_threshold(-2.0, 2.0), 0.0);
  EXPECT_EQ(soft_threshold(0.25F, 0.0F), 0.25F);
}

TEST(CoulombFriction, AForceBelowTheLimitHoldsARestingMassAtExactlyZero) {
  constexpr double dt_s = 40e-6;
  constexpr double mass_kg = 0.0075;
  auto element = friction(0.01, dt_s);
  EXPECT_EQ(element.step({.free_velocity_m_per_s = dt_s * 0.0099 / mass_kg, .mass_kg = mass_kg}), 0.0);
  EXPECT_GT(element.step({.free_velocity_m_per_s = dt_s * 0.0101 / mass_kg, .mass_kg = mass_kg}), 0.0);
}

TEST(CoulombFriction, NeverReversesOrSpeedsUpAMassAndNeverGivesMoreThanItsForce) {
  constexpr double dt_s = 200e-6;
  constexpr double force_N = 0.0144;
  auto element = friction(force_N, dt_s);
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> exponent(-6.0, 2.0);
  for (int i = 0; i < 20000; ++i) {
    const double free_m_per_s = std::pow(10.0, exponent(engine)) * (i % 2 == 0 ? 1.0 : -1.0);
    const double mass_kg = std::pow(10.0, exponent(engine) - 1.0);
    const double after_m_per_s = element.step({.free_velocity_m_per_s = free_m_per_s, .mass_kg = mass_kg});
    ASSERT_GE(after_m_per_s * free_m_per_s, 0.0);
    ASSERT_LE(std::fabs(after_m_per_s), std::fabs(free_m_per_s));
    const double friction_N = mass_kg * std::fabs(after_m_per_s - free_m_per_s) / dt_s;
    ASSERT_LE(friction_N, force_N + 1e-12 * mass_kg * std::fabs(free_m_per_s) / dt_s);
  }
}

TEST(CoulombFriction, ASlidingMassStopsAfterTheClosedFormTimeAndDistanceAndThenRests) {
  constexpr double dt_s = 1e-5;
  constexpr double mass_kg = 0.01075;
  constexpr double force_N = 0.0144;
  constexpr double start_m_per_s = 0.1;
  auto element = friction(force_N, dt_s);
  double velocity_m_per_s = start_m_per_s;
  double position_m = 0.0;
  int ticks = 0;
  for (; velocity_m_per_s != 0.0 && ticks < 100000; ++ticks) {
    velocity_m_per_s = element.step({.free_velocity_m_per_s = velocity_m_per_s, .mass_kg = mass_kg});
    position_m += dt_s * velocity_m_per_s;
  }
  EXPECT_NEAR(ticks * dt_s, mass_kg * start_m_per_s / force_N, dt_s);
  EXPECT_NEAR(position_m, mass_kg * start_m_per_s * start_m_per_s / (2.0 * force_N), start_m_per_s * dt_s);
  EXPECT_EQ(element.step({.free_velocity_m_per_s = velocity_m_per_s, .mass_kg = mass_kg}), 0.0);
}

TEST(CoulombFriction, AnOscillationLosesTwiceTheFrictionOverTheStiffnessEveryHalfCycleAndThenSticks) {
  constexpr double dt_s = 2e-6;
  constexpr double mass_kg = 0.018;
  constexpr double stiffness_N_per_m = 40.0;
  auto element = friction(0.05, dt_s);
  double position_m = 6e-3;
  double velocity_m_per_s = 0.0;
  std::vector<double> turns_m;
  for (int tick = 0; tick < 1000000; ++tick) {
    const double before_m_per_s = velocity_m_per_s;
    velocity_m_per_s =
        element.step({.free_velocity_m_per_s = velocity_m_per_s - dt_s * stiffness_N_per_m * position_m / mass_kg,
                      .mass_kg = mass_kg});
    if (before_m_per_s != 0.0 && before_m_per_s * velocity_m_per_s <= 0.0) turns_m.push_back(position_m);
    position_m += dt_s * velocity_m_per_s;
  }
  ASSERT_EQ(turns_m.size(), 2U);
  EXPECT_NEAR(turns_m[0], -3.5e-3, 1e-7);
  EXPECT_NEAR(turns_m[1], 1e-3, 1e-7);
  EXPECT_EQ(position_m, turns_m[1]);
}

/// Largest error against the piecewise solution when the mass is stepped semi-implicitly with this step.
double stick_slip_error_m(const OracleTable& table, double dt_s) {
  const auto times_s = table.column("time_s");
  const auto positions_m = table.column("position_m");
  constexpr double mass_kg = 0.018;
  auto element = friction(0.05, dt_s);
  double position_m = 0.0;
  double velocity_m_per_s = 0.0;
  double largest_m = 0.0;
  long tick = 0;
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    for (; static_cast<double>(tick) * dt_s < times_s[i] - 0.5 * dt_s; ++tick) {
      const double drive_m = 2.5e-3 * std::sin(6.0 * std::numbers::pi * dt_s * static_cast<double>(tick));
      const double pull_N = 40.0 * (drive_m - position_m) - 0.02 * velocity_m_per_s;
      velocity_m_per_s =
          element.step({.free_velocity_m_per_s = velocity_m_per_s + dt_s * pull_N / mass_kg, .mass_kg = mass_kg});
      position_m += dt_s * velocity_m_per_s;
    }
    largest_m = std::max(largest_m, std::fabs(position_m - positions_m[i]));
  }
  return largest_m;
}

TEST(CoulombFriction, StickSlipMotionConvergesToThePiecewiseSolutionOfScipy) {
  const OracleTable table("mechanics_stick_slip");
  const double coarse_m = stick_slip_error_m(table, 2e-5);
  const double fine_m = stick_slip_error_m(table, 5e-6);
  EXPECT_LT(coarse_m, 4e-6);
  EXPECT_LT(fine_m, 0.3 * coarse_m);
}

}  // namespace friction_test
}  // namespace tactus::mechanics
