// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/drive_law.hpp>
#include <tactus/kernel/signal/random.hpp>
#include <tactus/kernel/station/device_guard.hpp>

#include <cmath>
#include <limits>

#include "carriage.hpp"
#include <gtest/gtest.h>

/// The law of a drive at the second wall.
namespace tactus::station {
namespace drive_law_test {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr DeviceLimits with_law{.force_N = 4.0,
                                .rate_N_per_s = 1000.0,
                                .velocity_m_per_s = 100.0,
                                .position_m = 10.0,
                                .stiffness_N_per_m = 200.0,
                                .damping_N_s_per_m = 5.0};
constexpr Seconds timeout{0.02};

double given_N(const DeviceCommand& command, double at_m, double at_m_per_s) {
  return command.force_N + command.law.force_N(at_m, at_m_per_s);
}

TEST(DriveLaw, APartOfACommandIsTheSameLawWeakerAndGivesWhatPassed) {
  double force_N = 3.0;
  control::DriveLaw law{
      .position_m = 0.02, .velocity_m_per_s = 0.1, .stiffness_N_per_m = 100.0, .damping_N_s_per_m = 2.0};
  const double wanted_N = force_N + law.force_N(0.01, 0.0);
  control::keep_part(force_N, law, wanted_N, 0.25 * wanted_N);
  EXPECT_DOUBLE_EQ(force_N, 0.75);
  EXPECT_DOUBLE_EQ(law.stiffness_N_per_m, 25.0);
  EXPECT_DOUBLE_EQ(law.damping_N_s_per_m, 0.5);
  EXPECT_EQ(law.position_m, 0.02);
  control::keep_part(force_N, law, 0.0, 1.5);
  EXPECT_EQ(force_N, 1.5);
  EXPECT_FALSE(law.acts()) << "no part of nothing";
}

TEST(DeviceGuardOfADriveWithALaw, BoundsWhatTheLawGivesWhereTheDeviceIs) {
  DeviceGuard guard(with_law, Seconds{10.0});
  auto random = signal::Random(7);
  double before_N = 0.0;
  for (std::int64_t number = 0; number < 20'000; ++number) {
    const double at_m = random.uniform(-0.05, 0.05), at_m_per_s = random.uniform(-0.5, 0.5);
    guard.observe(at_m, tick(number), 0.0, at_m_per_s);
    const DeviceCommand wanted{.force_N = random.uniform(-3.0, 3.0),
                               .law = {.position_m = random.uniform(-0.1, 0.1),
                                       .velocity_m_per_s = random.uniform(-1.0, 1.0),
                                       .stiffness_N_per_m = random.uniform(0.0, 400.0),
                                       .damping_N_s_per_m = random.uniform(0.0, 10.0)}};
    const DeviceCommand passed = guard.pass(wanted, tick(number));
    const double now_N = given_N(passed, at_m, at_m_per_s);
    if (guard.cause() != ReleaseCause::none) break;
    ASSERT_LE(std::fabs(now_N), 4.0 * (1.0 + 1e-6)) << number;
    if (number > 0) {
      ASSERT_LE(std::fabs(now_N - before_N), 0.2 * (1.0 + 1e-6)) << number;
    }
    ASSERT_LE(passed.law.stiffness_N_per_m, 200.0);
    ASSERT_LE(passed.law.damping_N_s_per_m, 5.0);
    before_N = now_N;
  }
  EXPECT_GT(guard.held_back(), 1000);
}

TEST(DeviceGuardOfADriveWithALaw, PassesWhatIsWithinItsLimitsToTheBit) {
  DeviceGuard guard(with_law, timeout);
  guard.observe(0.01, tick(0), 0.0, 0.2);
  const DeviceCommand wanted{
      .force_N = 1.0,
      .law = {.position_m = 0.012, .velocity_m_per_s = 0.1, .stiffness_N_per_m = 200.0, .damping_N_s_per_m = 5.0}};
  for (std::int64_t number = 0; number < 1000; ++number) {
    guard.observe(0.01, tick(number), 0.0, 0.2);
    const DeviceCommand passed = guard.pass(wanted, tick(number));
    if (number < 10) continue;  // it comes in at the rate limit
    ASSERT_EQ(passed.force_N, wanted.force_N);
    ASSERT_EQ(passed.law.stiffness_N_per_m, 200.0);
    ASSERT_EQ(passed.law.damping_N_s_per_m, 5.0);
  }
  EXPECT_EQ(guard.cause(), ReleaseCause::none);
}

TEST(DeviceGuardOfADriveWithALaw, LetsGoOfTheLawWithTheForce) {
  for (const DeviceCommand& wrong :
       {DeviceCommand{.law = {.position_m = nan, .stiffness_N_per_m = 1.0}},
        DeviceCommand{.law = {.stiffness_N_per_m = nan}}, DeviceCommand{.law = {.damping_N_s_per_m = nan}}}) {
    DeviceGuard guard(with_law, timeout);
    guard.observe(0.0, tick(0));
    guard.pass({.law = {.position_m = 0.01, .stiffness_N_per_m = 100.0}}, tick(0));
    DeviceCommand passed = guard.pass(wrong, tick(1));
    EXPECT_EQ(guard.cause(), ReleaseCause::not_finite);
    for (std::int64_t number = 2; number < 50; ++number) {
      EXPECT_FALSE(passed.law.acts());
      EXPECT_TRUE(std::isfinite(passed.force_N));
      passed = guard.pass({.law = {.position_m = 0.01, .stiffness_N_per_m = 100.0}}, tick(number));
    }
    EXPECT_EQ(passed.force_N, 0.0);
    EXPECT_FALSE(passed.enabled);
  }
}

TEST(DeviceGuardOfADriveWithoutALaw, LetsGoOfAControllerThatInsistsOnOne) {
  DeviceGuard guard(limits, timeout);
  for (std::int64_t number = 0; number < 300; ++number) {
    guard.observe(0.0, tick(number));
    EXPECT_FALSE(guard.pass({.law = {.position_m = 0.01, .stiffness_N_per_m = 100.0}}, tick(number)).law.acts());
  }
  EXPECT_EQ(guard.cause(), ReleaseCause::force);
}

}  // namespace drive_law_test
}  // namespace tactus::station
