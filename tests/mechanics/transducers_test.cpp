#include <tactus/mechanics/amplifier.hpp>
#include <tactus/mechanics/encoder.hpp>
#include <tactus/mechanics/force_sensor.hpp>

#include <gtest/gtest.h>

namespace tactus::mechanics {
namespace {

static_assert(Element<Encoder>);
static_assert(Element<CurrentAmplifier>);
static_assert(Element<ForceSensor>);

TEST(Encoder, ReportsTheNearestCount) {
  auto encoder = Encoder::make({.resolution_m = 1e-5}, Seconds{200e-6});
  ASSERT_TRUE(encoder);
  EXPECT_DOUBLE_EQ(encoder->step(1.4e-5), 1e-5);
  EXPECT_DOUBLE_EQ(encoder->step(1.6e-5), 2e-5);
}

}  // namespace
}  // namespace tactus::mechanics
