// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/mechanics/springs.hpp>

#include <cmath>

#include <gtest/gtest.h>

namespace tactus::mechanics {
namespace springs_test {

static_assert(Element<LinearSpring>);
static_assert(Element<QuinticSpring>);

constexpr Seconds substep{40e-6};

TEST(LinearSpring, PullsItsEndsTogetherWhenStretchedAndWhenBeingStretched) {
  auto spring = LinearSpring::make({.stiffness_N_per_m = 39500.0, .damping_N_s_per_m = 3.6}, substep).value();
  EXPECT_DOUBLE_EQ(spring.step({.deflection_m = 1e-4, .rate_m_per_s = 0.0}), 3.95);
  EXPECT_DOUBLE_EQ(spring.step({.deflection_m = 0.0, .rate_m_per_s = 0.5}), 1.8);
  EXPECT_DOUBLE_EQ(spring.step({.deflection_m = -1e-4, .rate_m_per_s = 0.5}), -2.15);
}

TEST(QuinticSpring, OneNewtonHoldsTheQuinticPartAtTwoMillimetresEitherWay) {
  auto spring = QuinticSpring::make({.stiffness_N_per_m = 0.0}, substep).value();
  EXPECT_NEAR(spring.step({.deflection_m = 2e-3, .rate_m_per_s = 0.0}), 1.0, 1e-12);
  EXPECT_NEAR(spring.step({.deflection_m = -2e-3, .rate_m_per_s = 0.0}), -1.0, 1e-12);
}

TEST(QuinticSpring, IsTheSumOfItsThreePartsUpToTheGuard) {
  auto spring = QuinticSpring::make({}, substep).value();
  for (double deflection_m = -5e-3; deflection_m <= 5e-3; deflection_m += 1e-4) {
    EXPECT_NEAR(spring.step({.deflection_m = deflection_m, .rate_m_per_s = 0.1}),
                40.0 * deflection_m + 3.125e13 * std::pow(deflection_m, 5) + 2.3, 1e-11);
  }
}

TEST(QuinticSpring, BeyondTheGuardOnlyTheLinearPartGrows) {
  auto spring = QuinticSpring::make({}, substep).value();
  const double at_guard_N = spring.step({.deflection_m = 5e-3, .rate_m_per_s = 0.0});
  EXPECT_NEAR(spring.step({.deflection_m = 8e-3, .rate_m_per_s = 0.0}), at_guard_N + 40.0 * 3e-3, 1e-10);
  EXPECT_NEAR(spring.step({.deflection_m = -8e-3, .rate_m_per_s = 0.0}), -at_guard_N - 40.0 * 3e-3, 1e-10);
}

}  // namespace springs_test
}  // namespace tactus::mechanics
