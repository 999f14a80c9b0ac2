#include <tactus/mechanics/contact.hpp>
#include <tactus/mechanics/elasto_slip.hpp>
#include <tactus/mechanics/springs.hpp>

#include <gtest/gtest.h>

namespace tactus::mechanics {
namespace {

static_assert(Element<LinearSpring>);
static_assert(Element<QuinticSpring>);
static_assert(Element<ElastoSlipSpring>);
static_assert(Element<KelvinVoigtContact>);
static_assert(Element<HuntCrossleyContact>);

TEST(QuinticSpring, TheQuinticPartOfTwoMillimetresIsOneNewton) {
  auto spring = QuinticSpring::make({.stiffness_N_per_m = 0.0}, Seconds{40e-6});
  ASSERT_TRUE(spring);
  EXPECT_NEAR(spring->step({.deflection_m = 2e-3, .rate_m_per_s = 0.0}), 1.0, 1e-12);
}

}  // namespace
}  // namespace tactus::mechanics
