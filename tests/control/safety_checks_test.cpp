// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/encoder_check.hpp>
#include <tactus/kernel/control/force_sensor_check.hpp>
#include <tactus/kernel/control/packet.hpp>
#include <tactus/kernel/control/passivity_monitor.hpp>
#include <tactus/kernel/control/watchdog.hpp>

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <gtest/gtest.h>

namespace tactus::control {
namespace safety_checks_test {

constexpr double tick_s = 200e-6;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr Seconds tick{tick_s};

TEST(EncoderCheck, ASpikeAndAWrapShowAtOnceAndMotionUpToTheFastestNever) {
  EncoderCheck check = EncoderCheck::make({.fastest_m_per_s = 2.0}, tick).value();
  double position_m = 0.3;
  for (int i = 0; i < 1000; ++i) {
    position_m += (i / 100 % 2 == 0 ? 1.0 : -1.0) * 1.999 * tick_s;
    ASSERT_EQ(check.step({.position_m = position_m}), EncoderFault::none);
  }
  EXPECT_EQ(check.step({.position_m = position_m + 0.001}), EncoderFault::jump) << "a spike";
  EXPECT_EQ(check.step({.position_m = position_m}), EncoderFault::none) << "the reading before stays the measure";
  EXPECT_EQ(check.step({.position_m = position_m - 0.65536}), EncoderFault::jump) << "a wrap";
  EXPECT_EQ(check.step({.position_m = position_m - 0.65536}), EncoderFault::jump) << "and it stays one";
}

/// A hand that turns around while the slave chatters on the wall: the encoder rests, and the force comes in pulses.
TEST(EncoderCheck, ShortPulsesOfForceOnADeviceAtRestAreNoFreezeAndALastingForceIs) {
  const EncoderCheck::Params params{.frozen_force_N = 0.5, .frozen_after_s = 0.01};
  EncoderCheck check = EncoderCheck::make(params, tick).value();
  for (int i = 0; i < 2000; ++i) {
    const double pulse_N = i % 40 >= 10 && i % 40 < 20 ? 1.0 : 0.0;
    ASSERT_EQ(check.step({.position_m = 0.01, .acted_N = pulse_N}), EncoderFault::none) << "tick " << i;
  }
  int lasting = 0;
  while (check.step({.position_m = 0.01, .acted_N = -0.6}) == EncoderFault::none && lasting < 1000) ++lasting;
  EXPECT_NEAR(lasting * tick.value, params.frozen_after_s, 2.0 * tick.value);
}

TEST(EncoderCheck, AFreezeShowsOnceTheForceWorksAndAtRestOrUnderASteadyForceNever) {
  const EncoderCheck::Params params{.frozen_force_N = 0.5, .frozen_after_s = 0.01};
  EncoderCheck resting = EncoderCheck::make(params, tick).value(), frozen = resting, moving = resting;
  int shown = -1;
  for (int i = 0; i < 5000; ++i) {
    ASSERT_EQ(resting.step({.position_m = 0.01, .acted_N = 3.0}), EncoderFault::none);
    const double working_N = 0.6 * std::sin(0.01 * i);
    ASSERT_EQ(moving.step({.position_m = 1e-5 * (i / 20 % 2), .acted_N = working_N}), EncoderFault::none);
    if (frozen.step({.position_m = 0.01, .acted_N = working_N}) == EncoderFault::frozen && shown < 0) shown = i;
  }
  // The sine has gone through 0.5 N at arcsin(5/6) / 0.01 ticks; 50 ticks later it shows.
  EXPECT_NEAR(shown, std::asin(0.5 / 0.6) / 0.01 + 50.0, 2.0);
}

TEST(EncoderCheck, ADeviceThatIsPushedMoreThanFrictionHoldsMustMoveHoweverSteadilyItIsPushed) {
  const EncoderCheck::Params params{.unbalanced_force_N = 0.1, .frozen_after_s = 0.01};
  EncoderCheck held = EncoderCheck::make(params, tick).value(), moving = held, frozen = held;
  int shown = -1;
  for (int i = 0; i < 5000; ++i) {
    ASSERT_EQ(held.step({.position_m = 0.01, .acted_N = 3.0, .unbalanced_N = 0.09}), EncoderFault::none);
    const double counted_m = 1e-5 * (i / 40);
    ASSERT_EQ(moving.step({.position_m = counted_m, .acted_N = 3.0, .unbalanced_N = -0.11}), EncoderFault::none);
    const bool seen = frozen.step({.position_m = 0.01, .acted_N = 3.0, .unbalanced_N = -0.11}) == EncoderFault::frozen;
    if (seen && shown < 0) shown = i;
  }
  EXPECT_NEAR(shown * tick_s, params.frozen_after_s, 2.0 * tick_s);
}

TEST(ForceSensorCheck, ADropOutInContactAndABiasShowWhenTheLowPassHasGoneThroughTheLimit) {
  ForceSensorCheck check = ForceSensorCheck::make({.residual_limit_N = 0.4, .cutoff_Hz = 8.0}, tick).value();
  for (int i = 0; i < 5000; ++i) ASSERT_FALSE(check.step({.acted_N = 1.0, .tip_force_N = 1.0 - 0.03}));
  int after = 0;
  while (!check.step({.acted_N = 1.0, .tip_force_N = 0.0})) ++after;
  // 1 − exp(−t/τ) of the step from 0.03 to 1 N.
  const double expected_s = -std::log((1.0 - 0.4) / (1.0 - 0.03)) / (2.0 * std::numbers::pi * 8.0);
  EXPECT_NEAR(after * tick_s, expected_s, 2.0 * tick_s);
  check.reset();
  for (int i = 0; i < 5000; ++i) ASSERT_FALSE(check.step({.acted_N = 0.0, .tip_force_N = 0.39}));
}

TEST(PassivityMonitor, CountsTheWorkOfAHeldForceAndDrainsWhatMayBeGivenForEver) {
  PassivityMonitor monitor =
      PassivityMonitor::make({.damp_above_J = 1.0, .hold_above_J = 2.0, .credit_J = 0.5, .drain_W = 0.3}, tick).value();
  // 2 N along 0.25 m/s give 0.5 W, of which 0.3 W may be given for ever.
  for (int i = 0; i <= 5000; ++i) monitor.step({.acted_N = 2.0, .position_m = 0.25 * tick_s * i});
  EXPECT_NEAR(monitor.given_J(), 0.2, 1e-3);
  // The device gives back more than it got, and the credit is bounded.
  for (int i = 0; i <= 50000; ++i) monitor.step({.acted_N = 2.0, .position_m = 0.25 - 0.25 * tick_s * i});
  EXPECT_NEAR(monitor.given_J(), -0.5, 1e-12);
}

TEST(PassivityMonitor, DampsInProportionThenLatches) {
  PassivityMonitor monitor =
      PassivityMonitor::make(
          {.damp_above_J = 1.0, .hold_above_J = 2.0, .credit_J = 0.0, .drain_W = 0.0, .damping_N_s_per_m = 8.0}, tick)
          .value();
  double position_m = 0.0;
  monitor.step({.acted_N = 0.0, .position_m = position_m});
  for (const auto& [work_J, damping] :
       {std::pair{1.0, 0.0}, std::pair{0.25, 2.0}, std::pair{0.5, 6.0}, std::pair{0.5, 8.0}, std::pair{-2.0, 8.0}}) {
    position_m += work_J;
    EXPECT_NEAR(monitor.step({.acted_N = 1.0, .position_m = position_m}), damping, 1e-12);
  }
  EXPECT_TRUE(monitor.held()) << "what comes back does not unlatch it";
  monitor.reset();
  EXPECT_FALSE(monitor.held());
  const auto refused = PassivityMonitor::make({.damp_above_J = 2.0, .hold_above_J = 2.0}, tick);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().parameter, "hold_above_J");
}

TEST(Watchdog, BarksAfterTheTimeOutCountsAStallInFullAndStaysLatched) {
  Watchdog watchdog = Watchdog::make({.timeout_s = 0.1}, tick).value();
  for (int i = 0; i < 1000; ++i) ASSERT_FALSE(watchdog.step({.heard = i % 499 == 0}));
  watchdog.reset();
  for (int i = 1; i < 500; ++i) ASSERT_FALSE(watchdog.step({}));
  EXPECT_TRUE(watchdog.step({}));
  EXPECT_TRUE(watchdog.step({.heard = true})) << "latched";
  watchdog.reset();
  EXPECT_FALSE(watchdog.step({.heard = true}));
  EXPECT_TRUE(watchdog.step({.elapsed_ticks = 500}));
}

TEST(Watchdog, ATimeOutThatWouldSwitchItOffIsRefused) {
  for (const double timeout_s : {0.0, -1.0, infinity, not_a_number, 11.0}) {
    const auto made = Watchdog::make({.timeout_s = timeout_s}, tick);
    ASSERT_FALSE(made) << timeout_s;
    EXPECT_EQ(made.error().parameter, "timeout_s");
  }
}

Packet packet(std::int64_t session, std::int64_t sequence, double position_m = 0.0) {
  return {.session = session, .sequence = sequence, .message = {.position_m = position_m}};
}

TEST(PacketJudge, TheNewestOfASessionWinsAndNothingOldIsEverApplied) {
  PacketJudge judge = PacketJudge::make({.longest_age_s = 0.2}, tick).value();
  EXPECT_EQ(judge.step(packet(7, 5)), PacketVerdict::applied);
  EXPECT_EQ(judge.step(packet(7, 5)), PacketVerdict::late) << "repeated";
  EXPECT_EQ(judge.step(packet(7, 4)), PacketVerdict::late);
  Packet old = packet(7, 6);
  old.age_s = 0.21;
  EXPECT_EQ(judge.step(old), PacketVerdict::stale);
  old.age_s = not_a_number;
  EXPECT_EQ(judge.step(old), PacketVerdict::stale);
  EXPECT_EQ(judge.step(packet(7, 6)), PacketVerdict::applied) << "one that was refused does not count as newest";
  EXPECT_EQ(judge.step(packet(8, 1)), PacketVerdict::applied) << "the other site was restarted";
  EXPECT_EQ(judge.step(packet(7, 100)), PacketVerdict::left_session);
  EXPECT_EQ(judge.step(packet(0, 100)), PacketVerdict::left_session) << "0 is no session";
}

TEST(PacketJudge, ANumberThatIsNoneOrThatNoSiteCouldMeanIsRefusedWhereverItStands) {
  PacketJudge judge = PacketJudge::make({}, tick).value();
  std::int64_t sequence = 1;
  for (double Message::*member :
       {&Message::position_m, &Message::velocity_m_per_s, &Message::force_N, &Message::wave, &Message::energy_J}) {
    for (const double bad : {not_a_number, infinity, -infinity, 1e300, -1e12}) {
      Packet one = packet(3, ++sequence);
      one.message.*member = bad;
      EXPECT_EQ(judge.step(one), std::isfinite(bad) ? PacketVerdict::implausible : PacketVerdict::not_finite);
    }
    EXPECT_EQ(judge.step(packet(3, ++sequence)), PacketVerdict::applied);
  }
}

TEST(PacketJudge, ARunningTotalOfEnergyMayGrowForDaysButNotJump) {
  PacketJudge judge = PacketJudge::make({}, tick).value();
  const auto told = [&judge](std::int64_t session, std::int64_t sequence, double energy_J) {
    return judge.step({.session = session, .sequence = sequence, .message = {.energy_J = energy_J}});
  };
  // 10 W for 100 hours at the tick of 0.2 ms, looked at once a minute.
  constexpr double power_W = 10.0;
  std::int64_t sequence = 0;
  for (int minute = 0; minute < 6000; ++minute) {
    sequence += 300'000;
    ASSERT_EQ(told(5, sequence, power_W * tick.value * static_cast<double>(sequence)), PacketVerdict::applied)
        << minute;
  }
  const double total_J = power_W * tick.value * static_cast<double>(sequence);
  ASSERT_GT(total_J, 2e6);
  EXPECT_EQ(told(5, sequence + 1, total_J + 1e3), PacketVerdict::implausible);
  EXPECT_EQ(told(5, sequence + 1, 0.0), PacketVerdict::implausible);
  EXPECT_EQ(told(5, sequence + 1, total_J), PacketVerdict::applied);
  EXPECT_EQ(told(6, 1, 0.0), PacketVerdict::applied) << "a site that was started anew counts anew";
  EXPECT_EQ(told(7, 1, 1e3), PacketVerdict::implausible) << "nor does a session begin with a jump";
  EXPECT_EQ(told(7, sequence, total_J), PacketVerdict::applied) << "it is taken up at any time";
}

}  // namespace safety_checks_test
}  // namespace tactus::control
