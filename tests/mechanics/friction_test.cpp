#include <tactus/mechanics/friction.hpp>

#include <gtest/gtest.h>

namespace tactus::mechanics {
namespace {

static_assert(Element<CoulombFriction>);

TEST(CoulombFriction, AForceBelowTheLimitHoldsARestingMassAtExactlyZero) {
  constexpr double dt_s = 40e-6;
  auto friction = CoulombFriction::make({.force_N = 0.01}, Seconds{dt_s});
  ASSERT_TRUE(friction);
  const double mass_kg = 0.0075;
  EXPECT_EQ(friction->step({.free_velocity_m_per_s = dt_s * 0.0099 / mass_kg, .mass_kg = mass_kg}), 0.0);
  EXPECT_GT(friction->step({.free_velocity_m_per_s = dt_s * 0.0101 / mass_kg, .mass_kg = mass_kg}), 0.0);
}

}  // namespace
}  // namespace tactus::mechanics
