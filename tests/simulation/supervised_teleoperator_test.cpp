// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/tapping/tapping.hpp>
#include <tactus/simulation/teleoperator/teleoperator.hpp>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/default_experiment.hpp"
#include <gtest/gtest.h>

namespace tactus::simulation {
namespace {

using control::SiteCause;
using control::SiteRole;

TeleoperatorParams tapping() { return experiment_file<experiments::TappingParams>("tapping"); }

const mechanics::MinimumJerk reach{.start_m = -0.008, .end_m = 0.007, .start_time_s = 0.02, .duration_s = 0.25};

struct Touch {
  double peak_N = 0.0;
  double displayed_N = 0.0;
};

/// One tap, until it ends or supervision stops it.
template <class T>
Touch tap(T& teleoperator, double duration_s = 0.6) {
  Touch touch;
  for (double time_s = 0.0; time_s < duration_s && !teleoperator.stopped(); time_s += teleoperator.tick_s()) {
    const auto record = teleoperator.step(reach.position_m(time_s), reach.position_m(time_s + teleoperator.tick_s()));
    EXPECT_NEAR(record.time_s, time_s, 1e-9);
    touch.peak_N = std::max(touch.peak_N, record.peak_contact_force_N);
    touch.displayed_N = std::max(touch.displayed_N, record.displayed_force_N);
  }
  return touch;
}

TEST(SupervisedTeleoperator, ArmedBeforeTimeNullItTouchesAsTheBareOneDoes) {
  auto supervised = SupervisedTeleoperator::make(tapping(), reach.start_m).value();
  auto bare = Teleoperator::make(tapping(), reach.start_m).value();
  const Touch watched = tap(supervised), plain = tap(bare);
  EXPECT_FALSE(supervised.stopped());
  EXPECT_FALSE(bare.stopped());
  EXPECT_GT(plain.peak_N, 0.5);
  EXPECT_NEAR(watched.peak_N, plain.peak_N, 0.1 * plain.peak_N);
  EXPECT_NEAR(watched.displayed_N, plain.displayed_N, 0.1 * plain.displayed_N);
}

TEST(SupervisedTeleoperator, WithTheSwitchLetGoTheMasterStopsAndNoForceIsLeft) {
  auto teleoperator = SupervisedTeleoperator::make(tapping(), reach.start_m).value();
  tap(teleoperator);
  double displayed_N = 0.0;
  for (int tick = 0; tick < 2500; ++tick) {
    displayed_N = teleoperator.step(reach.end_m, reach.end_m, 0.0).displayed_force_N;
  }
  EXPECT_EQ(teleoperator.stopped(), (StoppedSite{SiteRole::master, SiteCause::dead_man}));
  EXPECT_EQ(displayed_N, 0.0);
  EXPECT_TRUE(teleoperator.healthy());
}

TEST(SupervisedTeleoperator, AWayThatIsTooLongIsRefusedWithSiteAndCause) {
  TeleoperatorParams params = tapping();
  params.channel.to_slave.delay_s = 0.4;
  const auto made = SupervisedTeleoperator::make(params, reach.start_m);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().parameter, "control.supervision");
  EXPECT_NE(made.error().message.find("master"), std::string::npos) << made.error().message;
  EXPECT_NE(made.error().message.find("unanswered"), std::string::npos) << made.error().message;
  params.control.supervision.packets.longest_age_s = 1.0;
  params.control.supervision.watchdog.timeout_s = 1.0;
  params.control.supervision.answer_within_s = 3.0;
  EXPECT_TRUE(SupervisedTeleoperator::make(params, reach.start_m));
}

TEST(SupervisedTeleoperator, AMotorThatGivesMoreEnergyThanItMayIsStopped) {
  TeleoperatorParams params = tapping();
  params.control.cancellation = control::CancellationMode::off;
  params.control.force_limit_N = 10.0;
  params.control.gate.energy.damp_above_J = 1e-4;
  params.control.gate.energy.hold_above_J = 1e-3;
  params.control.gate.energy.credit_J = 1e-4;
  auto teleoperator = SupervisedTeleoperator::make(params, reach.start_m).value();
  tap(teleoperator, 2.0);
  EXPECT_EQ(teleoperator.stopped(), (StoppedSite{SiteRole::master, SiteCause::energy}));
}

TEST(SupervisedTeleoperator, ACopyIsAForkOfTheRun) {
  auto one = SupervisedTeleoperator::make(tapping(), reach.start_m).value();
  auto other = one;
  EXPECT_EQ(tap(one).peak_N, tap(other).peak_N);
}

}  // namespace
}  // namespace tactus::simulation
