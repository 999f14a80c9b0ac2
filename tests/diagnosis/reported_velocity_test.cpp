// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/diagnosis/reported_velocity.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::diagnosis {
namespace reported_velocity_test {

struct Motion {
  std::vector<double> position, velocity;
};

/// Four seconds at 1 kHz of two swings, in steps as Damiao's drives tell them.
Motion motion(double scale, double step_rad_per_s = 0.022) {
  Motion found;
  for (int k = 0; k < 4000; ++k) {
    const double t = 1e-3 * k;
    found.position.push_back(0.000381 * std::round((0.2 * std::sin(3.0 * t) + 0.01 * std::sin(60.0 * t)) / 0.000381));
    const double velocity = 0.6 * std::cos(3.0 * t) + 0.6 * std::cos(60.0 * t);
    found.velocity.push_back(scale * step_rad_per_s * std::round(velocity / step_rad_per_s));
  }
  return found;
}

TEST(ReportedVelocity, ItsScaleIsFoundThroughTheStepsOfDrives) {
  for (const double scale : {0.22, 1.0, 2.0, 4.5, -1.0}) {
    const Motion told = motion(scale);
    const auto found = reported_scale(told.position, told.velocity, Seconds{1e-3});
    ASSERT_TRUE(found) << scale;
    EXPECT_NEAR(*found, std::fabs(scale), 0.02 * std::fabs(scale));
    EXPECT_EQ((ReportedVelocity{.scale = *found}.wrong()), std::fabs(scale) != 1.0);
  }
}

TEST(ReportedVelocity, NothingIsToldOfAnArmThatRestsOrOfWhatDoesNotGoTogether) {
  const std::vector<double> rest(4000, 0.3), none(4000, 0.0);
  EXPECT_FALSE(reported_scale(rest, none, Seconds{1e-3}));
  EXPECT_FALSE(reported_scale(motion(1.0).position, none, Seconds{1e-3}));
  signal::Random random(1);
  std::vector<double> noise;
  for (int k = 0; k < 4000; ++k) noise.push_back(random.normal());
  EXPECT_FALSE(reported_scale(motion(1.0).position, noise, Seconds{1e-3}));
}

}  // namespace reported_velocity_test
}  // namespace tactus::diagnosis
