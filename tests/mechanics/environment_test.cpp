// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/mechanics/environment.hpp>

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace tactus::mechanics {
namespace environment_test {

static_assert(Element<Environment>);

Environment wall(const Environment::Params& params) { return Environment::make(params, Seconds{40e-6}).value(); }

constexpr Environment::Params kelvin_voigt{
    .law = ContactLaw::kelvin_voigt, .position_m = 0.02, .stiffness_N_per_m = 30000.0, .damping_N_s_per_m = 5.0};
constexpr Environment::Params hunt_crossley{.law = ContactLaw::hunt_crossley,
                                            .position_m = 0.02,
                                            .stiffness_N_per_m = 30000.0,
                                            .exponent = 1.5,
                                            .dissipation_s_per_m = 0.5};

TEST(Environment, DoesNothingBeforeItsSurfaceAndOnIt) {
  for (const auto& params : {kelvin_voigt, hunt_crossley}) {
    Environment element = wall(params);
    for (const double velocity : {-1.0, 0.0, 1.0}) {
      EXPECT_EQ(element.step({.position_m = 0.0199999, .velocity_m_per_s = velocity}), 0.0);
      EXPECT_EQ(element.step({.position_m = 0.02, .velocity_m_per_s = velocity}), 0.0);
    }
  }
}

TEST(Environment, AKelvinVoigtWallIsSpringAndDamperBeyondItsSurface) {
  Environment element = wall(kelvin_voigt);
  EXPECT_NEAR(element.step({.position_m = 0.0201, .velocity_m_per_s = 0.0}), 3.0, 1e-9);
  EXPECT_NEAR(element.step({.position_m = 0.0201, .velocity_m_per_s = 0.2}), 4.0, 1e-9);
  EXPECT_NEAR(element.step({.position_m = 0.0201, .velocity_m_per_s = -0.2}), 2.0, 1e-9);
}

TEST(Environment, AHuntCrossleyWallHasItsStiffnessAtATenthOfAMillimetreAndGrowsWithItsExponent) {
  Environment element = wall(hunt_crossley);
  EXPECT_NEAR(element.step({.position_m = 0.0201}), 3.0, 1e-9);
  EXPECT_NEAR(element.step({.position_m = 0.0204}), 24.0, 1e-8);
  EXPECT_NEAR(element.step({.position_m = 0.0204, .velocity_m_per_s = 0.2}), 24.0 * 1.1, 1e-8);
}

TEST(Environment, NeverPullsAndTakesNoLessEnergyThanItGivesBack) {
  std::mt19937_64 engine(3);
  std::uniform_real_distribution<double> fraction(0.0, 1.0);
  for (Environment::Params params : {kelvin_voigt, hunt_crossley}) {
    for (int run = 0; run < 50; ++run) {
      params.damping_N_s_per_m = 100.0 * fraction(engine);
      params.dissipation_s_per_m = 10.0 * fraction(engine);
      params.exponent = 1.0 + 1.5 * fraction(engine);
      Environment element = wall(params);
      const double depth_m = 1e-3 * fraction(engine);
      const double turn_per_s = 1000.0 * fraction(engine);
      constexpr int steps = 4000;
      double taken_J = 0.0;
      for (int i = 0; i < steps; ++i) {
        const double phase = 2.0 * std::numbers::pi * (i + 0.5) / steps;
        const double velocity = depth_m * turn_per_s * std::sin(phase);
        const double force =
            element.step({.position_m = 0.02 + depth_m * (0.5 - std::cos(phase)), .velocity_m_per_s = velocity});
        ASSERT_GE(force, 0.0);
        taken_J += force * velocity * 2.0 * std::numbers::pi / (turn_per_s * steps);
      }
      EXPECT_GE(taken_J, -1e-9 * params.stiffness_N_per_m * depth_m * depth_m);
    }
  }
}

TEST(Environment, BondedWallPullsAsItPushes) {
  Environment wall = *Environment::make(
      {.law = ContactLaw::bonded, .position_m = 0.01, .stiffness_N_per_m = 2000.0, .damping_N_s_per_m = 3.0},
      Seconds{1e-5});
  EXPECT_DOUBLE_EQ(wall.step({.position_m = 0.012, .velocity_m_per_s = 0.1}), 2000.0 * 0.002 + 0.3);
  EXPECT_DOUBLE_EQ(wall.step({.position_m = 0.008, .velocity_m_per_s = -0.1}), -(2000.0 * 0.002 + 0.3));
}

}  // namespace environment_test
}  // namespace tactus::mechanics
