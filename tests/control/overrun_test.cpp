// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/force_sensor_check.hpp>
#include <tactus/kernel/control/message_follower.hpp>
#include <tactus/kernel/control/supervised_site.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>

/// What a loop that comes late each time, or often, may take away from the checks: nothing.
namespace tactus::control {
namespace overrun_test {

constexpr double tick_s = 200e-6;
constexpr Seconds tick{tick_s};

SafetyGate::Params tight() {
  SafetyGate::Params params{.velocity_limit_m_per_s = 2.0};
  params.encoder = {.fastest_m_per_s = 5.0, .frozen_force_N = 0.3, .frozen_after_s = 0.01};
  params.energy = {
      .damp_above_J = 0.02, .hold_above_J = 0.05, .credit_J = 0.02, .drain_W = 0.05, .damping_N_s_per_m = 3.0};
  return params;
}

SafetyGate gate(const SafetyGate::Params& params = tight()) { return SafetyGate::make(params, tick).value(); }

class EveryOverrun : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(ElapsedTicks, EveryOverrun, ::testing::Values(1, 2, 7, 90, 1000));

TEST_P(EveryOverrun, ASpeedAboveTheLimitIsLatchedAndOneBelowIsNot) {
  for (const double speed_m_per_s : {4.9, 1.9}) {
    SafetyGate element = gate();
    double position_m = 0.0;
    element.believe(position_m, GetParam());
    for (double time_s = 0.0; time_s < 0.01; time_s += tick_s * GetParam()) {
      element.believe(position_m += speed_m_per_s * tick_s * GetParam(), GetParam());
    }
    EXPECT_NEAR(element.velocity_m_per_s(), speed_m_per_s, 1e-3);
    EXPECT_EQ(element.fault(), speed_m_per_s > 2.5 ? GateFault::velocity : GateFault::none);
  }
}

TEST_P(EveryOverrun, AReadingFartherThanTheFastestMotionGoesInThatTimeIsAJump) {
  const double farthest_m = 5.0 * tick_s * GetParam();
  SafetyGate element = gate();
  element.believe(0.0);
  EXPECT_EQ(element.believe(0.99 * farthest_m, GetParam()), 0.99 * farthest_m);
  EXPECT_NE(element.fault(), GateFault::encoder_jump);
  element.reset();
  element.believe(0.0);
  EXPECT_EQ(element.believe(1.01 * farthest_m, GetParam()), 0.0);
  EXPECT_EQ(element.fault(), GateFault::encoder_jump);
}

TEST_P(EveryOverrun, AFrozenEncoderIsLatchedAsSoonAsByALoopInTimeButNeverOnOneReadingAlone) {
  SafetyGate element = gate();
  element.believe(0.01);
  element.pass(1.0);
  double passed_s = 0.0;
  int readings = 0;
  while (element.fault() == GateFault::none && readings < 10000) {
    element.believe(0.01, GetParam());
    element.pass(1.0);
    passed_s += tick_s * GetParam();
    ++readings;
  }
  EXPECT_EQ(element.fault(), GateFault::encoder_frozen);
  EXPECT_GE(readings, 2);
  EXPECT_LE(passed_s, std::max(0.01 + tick_s * GetParam(), 2.0 * tick_s * GetParam()) + 1e-9);
}

TEST(Overrun, OneMissInAHundredDoesNotHideAFrozenEncoder) {
  SafetyGate element = gate([] {
    auto params = tight();
    params.encoder.frozen_after_s = 0.05;
    return params;
  }());
  for (int i = 0; i < 1000; ++i) {
    element.believe(0.01, i % 100 == 99 ? 2 : 1);
    element.pass(i < 10 ? 0.0 : 1.0);
  }
  EXPECT_EQ(element.fault(), GateFault::encoder_frozen);
}

/// 2 N along 0.25 m/s are 0.5 W, of which 0.05 W may be given for ever.
TEST_P(EveryOverrun, TheEnergyThatIsGivenAcrossGapsIsEnteredAndLatches) {
  SafetyGate element = gate([] {
    auto params = tight();
    params.encoder.frozen_force_N = 20.0;
    return params;
  }());
  double given_J = 0.0, before_N = 0.0;
  for (int i = 0; i < 20000 / GetParam(); ++i) {
    element.believe(0.25 * tick_s * GetParam() * i, GetParam());
    if (i > 0) given_J += before_N * 0.25 * tick_s * GetParam();
    before_N = element.pass(2.0);
    if (element.fault() != GateFault::none) break;
  }
  EXPECT_EQ(element.fault(), GateFault::energy);
  EXPECT_LT(given_J, 0.06 + 2.0 * 0.25 * tick_s * GetParam());
}

TEST(Overrun, AfterAStallTheForceStillChangesByNoMoreThanOneTickMay) {
  SafetyGate element = SafetyGate::make({.rate_limit_N_per_s = 1000.0}, tick).value();
  element.step({.command_N = 0.0});
  element.believe(0.0, 500);
  EXPECT_NEAR(element.pass(5.0), 0.2, 1e-12);
}

TEST(Overrun, AForceSensorThatCannotBeRightShowsAsSoonAsToALoopInTimeButNeverOnOneReading) {
  ForceSensorCheck late = ForceSensorCheck::make({.residual_limit_N = 0.4, .cutoff_Hz = 8.0}, tick).value();
  ForceSensorCheck timely = late;
  int late_ticks = 0, ticks = 0;
  while (!late.step({.acted_N = 1.0, .elapsed_ticks = 4})) late_ticks += 4;
  while (!timely.step({.acted_N = 1.0})) ++ticks;
  EXPECT_NEAR(late_ticks, ticks, 4);
  late.reset();
  EXPECT_FALSE(late.step({.acted_N = 3.0, .elapsed_ticks = 1000}));
}

/// Told positions on a ramp, one of which comes after a stall: what is given goes on along the ramp.
TEST(Overrun, AfterAStallAToldPositionGoesOnWithoutAStepAndItsVelocityIsNotOverestimated) {
  MessageFollower follower = MessageFollower::make({}, tick).value();
  constexpr double speed_m_per_s = 0.1;
  double told_m = 0.0, before_m = 0.0;
  Arrival out;
  for (int i = 0; i < 2000; ++i) {
    const int elapsed = i % 500 == 499 ? 40 : 1;
    told_m += speed_m_per_s * tick_s * elapsed;
    out = follower.step(
        {.arrival = {.message = {.position_m = told_m}, .fresh = true}, .following = true, .elapsed_ticks = elapsed});
    ASSERT_LE(out.message.position_m - before_m, speed_m_per_s * tick_s * elapsed + 0.05 * tick_s + 1e-12);
    ASSERT_NEAR(out.message.position_m, told_m, 1e-5);
    before_m = out.message.position_m;
  }
  for (int i = 0; i < 2000; ++i) out = follower.step({.following = true});
  EXPECT_NEAR(out.message.position_m - told_m, speed_m_per_s * (0.01 + 0.02), 3e-5);
}

/// Two sites on a wire without delay. The slave's loop is stepped when the caller says so.
struct Pair {
  SupervisedMaster master = make_supervised_master({}, 11, tick).value();
  SupervisedSlave slave = make_supervised_slave({}, 21, tick).value();
  SlaveInput at_slave;
  SiteRequests buttons;
  SupervisedSlave::Output slave_out;

  void step(int slave_ticks = 1) {
    Packet told;
    for (int i = 0; i < slave_ticks; ++i) {
      told = master.step({.sensors = {}, .requests = buttons}).packet;
      slave.take(told);
    }
    slave_out = slave.step({.sensors = at_slave, .requests = buttons, .elapsed_ticks = slave_ticks});
    master.take(slave_out.packet);
  }
  void start() {
    for (int i = 0; i < 10; ++i) step();
    for (bool SiteRequests::*button : {&SiteRequests::align, &SiteRequests::arm}) {
      buttons.*button = true;
      step();
      step();
      buttons.*button = false;
      step();
    }
    buttons.dead_man = true;
    for (int i = 0; i < 3; ++i) step();
  }
  [[nodiscard]] std::string cause() const { return name_of(static_cast<SiteCause>(slave_out.record.cause)); }
};

TEST(Overload, ASlaveThatMissesMostOrEverySecondOfItsTicksHoldsWithinASecondAndWillNotBeArmed) {
  for (const int every : {90, 2}) {
    Pair pair;
    pair.start();
    ASSERT_EQ(pair.slave.state(), SiteState::active);
    int ticks = 0;
    for (; pair.slave.state() == SiteState::active && ticks < 5000; ticks += every) pair.step(every);
    EXPECT_EQ(pair.slave.state(), SiteState::hold) << "stepped every " << every;
    EXPECT_EQ(pair.cause(), "overloaded");
    EXPECT_LT(ticks * tick_s, 0.3);
    // Its servo would still push, at a rate at which it was never stable: the site lets go instead.
    pair.at_slave.motor_position_m -= 0.001;
    for (int i = 0; i < 50; ++i) pair.step(every);
    EXPECT_EQ(pair.slave_out.site.motor_force_N, 0.0);
    EXPECT_FALSE(pair.slave_out.record.enabled);
    pair.buttons.dead_man = false;
    pair.buttons.arm = true;
    for (int i = 0; i < 100; ++i) pair.step(every);
    EXPECT_EQ(pair.slave.state(), SiteState::hold);
  }
}

TEST(Overload, ALoopThatMissesOneTickInAThousandOrStallsOnceForAsLongAsItMayIsNotOverloaded) {
  Pair pair;
  pair.start();
  for (int i = 0; i < 20000; ++i) {
    pair.step(i % 1000 == 999 ? 2 : 1);
    ASSERT_EQ(pair.slave.state(), SiteState::active) << i;
  }
  for (int stall = 0; stall < 3; ++stall) {
    pair.step(99);
    for (int i = 0; i < 1500; ++i) pair.step();
    ASSERT_EQ(pair.slave.state(), SiteState::active) << pair.cause();
  }
}

}  // namespace overrun_test
}  // namespace tactus::control
