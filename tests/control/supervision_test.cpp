// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/supervised_site.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

namespace tactus::control {
namespace supervision_test {

constexpr double tick_s = 200e-6;
constexpr Seconds tick{tick_s};

TEST(MessageFollower, WhatIsFreshEveryTickPassesBitForBit) {
  MessageFollower follower = MessageFollower::make({}, tick).value();
  for (int i = 0; i < 1000; ++i) {
    const Message told{.position_m = i == 0 ? 0.0 : std::sin(0.1 * i),
                       .velocity_m_per_s = i == 0 ? 0.0 : 0.3 * i,
                       .force_N = i == 0 ? 0.0 : std::cos(0.1 * i),
                       .wave = i == 0 ? 0.0 : 0.1};
    const Arrival out = follower.step({.arrival = {.message = told, .fresh = true}, .following = true});
    ASSERT_EQ(out.message.position_m, told.position_m);
    ASSERT_EQ(out.message.velocity_m_per_s, told.velocity_m_per_s);
    ASSERT_EQ(out.message.force_N, told.force_N);
    ASSERT_EQ(out.message.wave, told.wave);
  }
}

TEST(MessageFollower, InSilenceAPositionGoesNoFartherThanItsVelocityTimesExtrapolationAndDecayAndAForceDecays) {
  const MessageFollower::Params params{.extrapolation_s = 0.01, .decay_s = 0.02};
  MessageFollower follower = MessageFollower::make(params, tick).value();
  Message told;
  for (int i = 0; i <= 1000; ++i) {
    told = {.position_m = 0.1 * tick_s * i, .force_N = i == 0 ? 0.0 : 2.0};
    follower.step({.arrival = {.message = told, .fresh = true}, .following = true});
  }
  Arrival out;
  for (int i = 1; i <= 2000; ++i) {
    out = follower.step({.arrival = {.message = told}, .following = true});
    const double silence_s = i * tick_s;
    const double share = silence_s <= 0.01 ? 1.0 : std::exp(-(silence_s - 0.01) / 0.02);
    ASSERT_NEAR(out.message.force_N, 2.0 * share, 0.03);
    if (silence_s <= 0.01) {
      ASSERT_NEAR(out.message.position_m, told.position_m + 0.1 * silence_s, 1e-6);
    }
  }
  EXPECT_NEAR(out.message.position_m - told.position_m, 0.1 * (0.01 + 0.02), 2e-5);
  EXPECT_FALSE(out.fresh);
}

TEST(MessageFollower, WhereItBeginsToFollowAndWhenASilenceEndsThereIsNoStepAndTheGapClosesAtItsRate) {
  const MessageFollower::Params params{.catch_up_m_per_s = 0.05, .catch_up_N_per_s = 20.0};
  MessageFollower follower = MessageFollower::make(params, tick).value();
  follower.settle(0.02);
  const Arrival told{.message = {.position_m = 0.0, .force_N = 1.0}, .fresh = true};
  EXPECT_EQ(follower.step({.arrival = told}).message.position_m, 0.02) << "stands while it does not follow";
  double before_m = 0.02, before_N = 0.0;
  for (int i = 1; i <= 2500; ++i) {
    const Message out = follower.step({.arrival = told, .following = true}).message;
    ASSERT_NEAR(out.position_m, std::max(0.0, 0.02 - 0.05 * tick_s * i), 1e-12);
    ASSERT_NEAR(out.force_N, std::min(1.0, 20.0 * tick_s * i), 1e-12);
    ASSERT_LE(std::fabs(out.position_m - before_m), 0.05 * tick_s + 1e-15);
    ASSERT_LE(std::fabs(out.force_N - before_N), 20.0 * tick_s + 1e-12);
    before_m = out.position_m;
    before_N = out.force_N;
  }
}

TEST(MessageFollower, TheRunningTotalOfEnergyCountsOnlyWhatWasSentWhileFollowing) {
  MessageFollower follower = MessageFollower::make({}, tick).value();
  const auto told = [&](double energy_J, bool following) {
    return follower.step({.arrival = {.message = {.energy_J = energy_J}, .fresh = true}, .following = following})
        .message.energy_J;
  };
  EXPECT_EQ(told(5.0, true), 0.0);
  EXPECT_EQ(told(6.0, true), 1.0);
  EXPECT_EQ(told(0.5, false), 1.0) << "a restarted site counts from zero and takes none away";
  EXPECT_EQ(told(0.75, true), 1.0);
  EXPECT_EQ(told(1.0, true), 1.25);
}

/// Two sites on a wire without delay, and the buttons.
struct Pair {
  SupervisedMaster master;
  SupervisedSlave slave;
  MasterInput at_master;
  SlaveInput at_slave;
  SiteRequests buttons;
  bool cut = false;
  SupervisedMaster::Output master_out;
  SupervisedSlave::Output slave_out;

  explicit Pair(const ControlParams& control = params())
      : master(make_supervised_master(control, 11, tick).value()),
        slave(make_supervised_slave(control, 21, tick).value()) {}
  static ControlParams params() {
    ControlParams control;
    control.force_gain = 1.0;
    control.cancellation = CancellationMode::off;
    control.gate.rate_limit_N_per_s = control.slave_gate.rate_limit_N_per_s = 1000.0;
    return control;
  }
  void step(int ticks = 1) {
    for (int i = 0; i < ticks; ++i) {
      const double master_N = master_out.site.motor_force_N, slave_N = slave_out.site.motor_force_N;
      master_out = master.step({.sensors = at_master, .requests = buttons});
      if (!cut) slave.take(master_out.packet);
      slave_out = slave.step({.sensors = at_slave, .requests = buttons});
      if (!cut) master.take(slave_out.packet);
      ASSERT_LE(std::fabs(master_out.site.motor_force_N - master_N), 1000.0 * tick_s + 1e-12);
      ASSERT_LE(std::fabs(slave_out.site.motor_force_N - slave_N), 1000.0 * tick_s + 1e-12);
    }
  }
  void push(bool SiteRequests::*button) {
    buttons.*button = true;
    step(5);
    buttons.*button = false;
    step(5);
  }
  void start() {
    step(10);
    push(&SiteRequests::align);
    push(&SiteRequests::arm);
    buttons.dead_man = true;
    step(5);
  }
  [[nodiscard]] bool active() const {
    return master.state() == SiteState::active && slave.state() == SiteState::active;
  }
};

TEST(Supervision, TheWayToActiveIsAlignArmAndADeadManSwitchPressedAfterArming) {
  Pair pair;
  pair.buttons.dead_man = true;
  pair.step(10);
  EXPECT_EQ(pair.master.state(), SiteState::configure);
  pair.push(&SiteRequests::arm);
  EXPECT_EQ(pair.master.state(), SiteState::configure) << "nothing is armed before it is aligned";
  pair.push(&SiteRequests::align);
  EXPECT_EQ(pair.master.state(), SiteState::align);
  EXPECT_EQ(pair.slave.state(), SiteState::align);
  pair.push(&SiteRequests::arm);
  EXPECT_EQ(pair.master.state(), SiteState::armed);
  EXPECT_EQ(pair.slave.state(), SiteState::armed);
  pair.step(100);
  EXPECT_FALSE(pair.active()) << "a switch that was pressed before is taped down";
  pair.buttons.dead_man = false;
  pair.step();
  pair.buttons.dead_man = true;
  pair.step(3);
  EXPECT_TRUE(pair.active());
  pair.buttons.dead_man = false;
  pair.step(3);
  EXPECT_EQ(pair.master.state(), SiteState::armed);
  EXPECT_EQ(pair.slave.state(), SiteState::armed);
  EXPECT_EQ(static_cast<SiteCause>(pair.master_out.record.cause), SiteCause::dead_man);
}

TEST(Supervision, AMasterThatArmsAwayFromZeroIsNotPulledTowardIt) {
  ControlParams control = Pair::params();
  control.architecture = "position-position";
  Pair pair(control);
  pair.at_master.motor_position_m = pair.at_slave.motor_position_m = 0.3;
  pair.start();
  ASSERT_TRUE(pair.active());
  for (int i = 0; i < 5000; ++i) {
    pair.step();
    ASSERT_NEAR(pair.master_out.site.motor_force_N, 0.0, 1e-6) << i;
  }
}

TEST(Supervision, ACutEndsInHoldWithinTheTimeOutAndOnlyANewArmingLeadsOut) {
  Pair pair;
  pair.start();
  ASSERT_TRUE(pair.active());
  pair.cut = true;
  pair.step(498);
  EXPECT_TRUE(pair.active());
  pair.step(4);
  EXPECT_EQ(pair.master.state(), SiteState::hold);
  EXPECT_EQ(pair.slave.state(), SiteState::hold);
  EXPECT_EQ(static_cast<SiteCause>(pair.slave_out.record.cause), SiteCause::timed_out);
  pair.cut = false;
  pair.step(5);
  pair.buttons.arm = true;
  pair.buttons.dead_man = false;
  pair.step(10);
  pair.buttons.dead_man = true;
  pair.step(10);
  EXPECT_TRUE(pair.active()) << "armed anew";
  pair.cut = true;
  pair.step(600);
  pair.cut = false;
  pair.step(2000);
  EXPECT_EQ(pair.master.state(), SiteState::hold) << "a button that is stuck arms nothing";
  EXPECT_EQ(pair.slave.state(), SiteState::hold);
}

TEST(Supervision, AForceComesInOverTheBlendAndLeavesOverItAtTheMaster) {
  Pair pair;
  pair.at_slave.tip_force_N = 1.0;
  pair.start();
  ASSERT_TRUE(pair.active());
  double before_N = 0.0;
  for (int i = 0; i < 700; ++i) {
    pair.step();
    const double force_N = -pair.master_out.site.motor_force_N;
    ASSERT_LE(std::fabs(force_N - before_N), 2.5 * tick_s / 0.1) << "blend times a told force that itself ramps";
    before_N = force_N;
  }
  EXPECT_NEAR(before_N, 1.0, 1e-9);
  pair.buttons.dead_man = false;
  pair.step(502);
  EXPECT_EQ(pair.master_out.site.motor_force_N, 0.0);
}

TEST(Supervision, WhileTheClutchIsPressedTheToldPositionStandsAndWhatTheHandMovedBecomesTheOffset) {
  Pair pair;
  pair.start();
  const double told_m = pair.master_out.packet.message.position_m;
  pair.buttons.clutch = true;
  for (int i = 0; i < 200; ++i) {
    pair.at_master.motor_position_m += 1e-4;
    pair.step();
    ASSERT_EQ(pair.master_out.packet.message.position_m, told_m);
  }
  pair.buttons.clutch = false;
  pair.step();
  EXPECT_NEAR(pair.master_out.packet.message.position_m, told_m, 1e-15);
  EXPECT_NEAR(pair.master_out.record.offset_m, -0.02, 1e-12);
  pair.at_master.motor_position_m += 1e-4;
  pair.step();
  EXPECT_NEAR(pair.master_out.packet.message.position_m, told_m + 1e-4, 1e-15) << "and moves on from there";
}

TEST(Supervision, AFaultOfTheGateIsLeftByClearingOnlyAndArmingFollows) {
  Pair pair;
  pair.start();
  pair.at_slave.motor_position_m = std::nan("");
  pair.step(3);
  EXPECT_EQ(pair.slave.state(), SiteState::fault);
  EXPECT_EQ(pair.master.state(), SiteState::hold);
  EXPECT_EQ(static_cast<GateFault>(pair.slave_out.record.fault), GateFault::not_finite);
  EXPECT_EQ(static_cast<SiteCause>(pair.slave_out.record.cause), SiteCause::gate);
  pair.at_slave.motor_position_m = 0.0;
  pair.buttons.dead_man = false;
  pair.push(&SiteRequests::arm);
  EXPECT_EQ(pair.slave.state(), SiteState::fault);
  pair.push(&SiteRequests::clear);
  EXPECT_EQ(pair.slave.state(), SiteState::align) << "an arming from before the clearing does not count";
  pair.push(&SiteRequests::arm);
  EXPECT_EQ(pair.slave.state(), SiteState::armed);
  pair.buttons.dead_man = true;
  pair.step(5);
  EXPECT_TRUE(pair.active());
}

TEST(Supervision, AForceSensorThatCannotBeRightAndAStallEndInHold) {
  Pair pair;
  pair.start();
  pair.at_slave.tip_force_N = 60.0;
  for (int i = 0; i < 200 && pair.slave.state() != SiteState::hold; ++i) {
    pair.at_slave.motor_position_m += 0.2 * tick_s;
    pair.step();
  }
  EXPECT_EQ(pair.slave.state(), SiteState::hold);
  EXPECT_EQ(static_cast<SiteCause>(pair.slave_out.record.cause), SiteCause::force_sensor);
  // Nobody holds the tool: it is braked, and the drive keeps its power until it stands.
  for (int i = 0; i < 20; ++i) {
    pair.at_slave.motor_position_m += 0.2 * tick_s;
    pair.step();
  }
  EXPECT_LT(pair.slave_out.site.motor_force_N, -0.1);
  EXPECT_TRUE(pair.slave_out.record.enabled);
  pair.step(100);
  EXPECT_EQ(pair.slave_out.site.motor_force_N, 0.0);
  EXPECT_FALSE(pair.slave_out.record.enabled);
  Pair other;
  other.start();
  other.slave.step({.sensors = other.at_slave, .requests = other.buttons, .elapsed_ticks = 200});
  EXPECT_EQ(other.slave.state(), SiteState::hold);
}

TEST(Supervision, ARestartedSiteIsSeenAtOnceAndNotFollowedByAnArmingThatIsOver) {
  Pair pair;
  pair.start();
  pair.slave = make_supervised_slave(Pair::params(), 22, tick).value();
  pair.step(3);
  EXPECT_EQ(pair.master.state(), SiteState::hold);
  EXPECT_EQ(pair.slave.state(), SiteState::configure);
  pair.push(&SiteRequests::align);
  pair.step(100);
  EXPECT_EQ(pair.slave.state(), SiteState::align);
  pair.buttons.dead_man = false;
  pair.push(&SiteRequests::arm);
  pair.buttons.dead_man = true;
  pair.step(5);
  EXPECT_TRUE(pair.active());
}

TEST(Supervision, ATimeOutThatWouldNeverComeIsRefusedWithItsKey) {
  ControlParams params;
  params.supervision.watchdog.timeout_s = 0.0;
  const auto made = make_supervised_master(params, 1, tick);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().parameter, "supervision.watchdog.timeout_s");
  EXPECT_EQ(make_supervised_slave({}, 0, tick).error().parameter, "supervision.session");
}

}  // namespace supervision_test
}  // namespace tactus::control
