// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <utility>

#include "tests/allocation_counter.hpp"
#include "tests/arm_control/arm_station_bench.hpp"
#include <gtest/gtest.h>

namespace tactus::arm_control::arm_station_test {
namespace {

using control::GateFault;
using control::SiteCause;
using station::DeviceHealth;

TEST(ArmsUnderSupervision, HaveNoPowerUntilSomebodyAlignsThemAndThenCarryThemselves) {
  Bench bench;
  bench.run(0.01, {});
  EXPECT_TRUE(bench.both(SiteState::configure));
  EXPECT_TRUE(Bench::has_let_go(bench.last.master));
  EXPECT_TRUE(Bench::has_let_go(bench.last.slave));
  bench.run(1.0, {.align = true});
  EXPECT_TRUE(bench.both(SiteState::align));
  const arm::Vector3 leader_m = bench.leader.plant().tool().position_m;
  const arm::Vector3 follower_m = bench.follower.plant().tool().position_m;
  bench.held = false;
  bench.run(2.0, {.align = true});
  EXPECT_LT(fell_mm(bench.leader, leader_m), 2.0) << "its weight is carried, and nothing else";
  EXPECT_LT(fell_mm(bench.follower, follower_m), 1.0) << "it stands by its own law";
}

TEST(ArmsUnderSupervision, CoupleFollowAndFeelContactWithinTheGates) {
  Bench bench;
  bench.couple();
  ASSERT_TRUE(bench.both(SiteState::active));
  bench.press_on_the_wall();
  EXPECT_GT(bench.contact_N, 0.5);
  EXPECT_LT(bench.contact_N, 20.0);
  const auto& felt = bench.last.master.output.site[0];
  const double told_N_m = bench.last.slave.output.site[0].message.force_N;
  EXPECT_LT(told_N_m, -0.5);
  EXPECT_NEAR(felt.motor_force_N - felt.support_N, -told_N_m, 0.1) << "the leader displays it, at a gain of 1";
  EXPECT_TRUE(bench.sites.healthy());
  EXPECT_LE(bench.most_step_N, 2000.0 * tick.value * (1.0 + 1e-9));
}

TEST(ArmsUnderSupervision, WithPassivePortsTheyFollowFeelContactAndCanBeArmedAnew) {
  for (const PassivePort port : {PassivePort::joints, PassivePort::tool}) {
    Bench bench({.port = port});
    bench.couple();
    ASSERT_TRUE(bench.both(SiteState::active)) << name_of(port);
    bench.press_on_the_wall();
    EXPECT_GT(bench.contact_N, 0.5) << name_of(port);
    EXPECT_LT(bench.contact_N, 20.0) << name_of(port);
    EXPECT_GT(bench.last.master.output.site[1].message.energy_J + bench.last.master.output.site[0].message.energy_J,
              1e-4)
        << name_of(port) << ": the hand put energy in";
    bench.follower.set_health(DeviceHealth::not_responding);
    bench.run(0.03, {.dead_man = true});
    EXPECT_EQ(bench.sites.slave().state(), SiteState::hold);
    bench.follower.set_health(DeviceHealth::good);
    bench.run(0.05, {.arm = true});
    bench.run(0.5, {.dead_man = true});
    ASSERT_TRUE(bench.both(SiteState::active)) << name_of(port);
    bench.aim_m = 0.01;
    bench.run(1.0, {.dead_man = true});
    const arm::Vector3 leader_m = bench.leader.plant().tool().position_m;
    EXPECT_GT((leader_m - bench.began_m).z(), 5e-3) << name_of(port);
    EXPECT_LT((leader_m - bench.follower.plant().tool().position_m).norm(), 5e-3) << name_of(port) << " follows again";
    EXPECT_TRUE(bench.sites.healthy());
  }
}

TEST(ArmsUnderSupervision, ATareMovesBothArmsAndAddsNothingWhereTheModelsAreRight) {
  Bench bench;
  bench.wall.point_m.z() -= 0.2;  // the tools move by centimetres
  bench.couple();
  bench.held = false;
  bench.run(0.5, {});
  const arm::Vector3 leader_m = bench.leader.plant().tool().position_m;
  const arm::Vector3 follower_m = bench.follower.plant().tool().position_m;
  const auto& master = bench.sites.master().site();
  const auto& slave = bench.sites.slave().site();
  bench.run(1.0, {.tare = true});
  ASSERT_TRUE(bench.both(SiteState::armed));
  EXPECT_EQ(master.tare().state, control::TareState::under_way);
  EXPECT_EQ(slave.tare().state, control::TareState::under_way);
  bench.most_step_N = 0.0;
  bench.run(3.5, {.tare = true});
  for (const auto& [report, found] :
       {std::pair(master.tare(), master.tared_N()), std::pair(slave.tare(), slave.tared_N())}) {
    EXPECT_EQ(report.state, control::TareState::done)
        << name_of(report.state) << " of joint " << report.joint << ": " << report.value;
    for (const double lacking_N_m : found) EXPECT_NEAR(lacking_N_m, 0.0, 0.05);
  }
  EXPECT_LT(bench.most_step_N, 0.5) << "no torque steps";
  EXPECT_LT(fell_mm(bench.leader, leader_m), 10.0);
  EXPECT_LT(fell_mm(bench.follower, follower_m), 5.0);
  bench.run(0.5, {.dead_man = true});
  EXPECT_TRUE(bench.both(SiteState::active));
}

TEST(ArmsUnderSupervision, TheDeadManSwitchUncouplesTheLeaderAndDropsNeitherArm) {
  Bench bench;
  bench.couple();
  const arm::Vector3 leader_m = bench.leader.plant().tool().position_m;
  const arm::Vector3 follower_m = bench.follower.plant().tool().position_m;
  bench.held = false;
  bench.run(1.0, {});
  EXPECT_TRUE(bench.both(SiteState::armed));
  EXPECT_LT(fell_mm(bench.leader, leader_m), 10.0);
  EXPECT_LT(fell_mm(bench.follower, follower_m), 5.0);
  for (const auto& joint : bench.last.master.output.site) {
    EXPECT_EQ(joint.motor_force_N, joint.support_N);
    EXPECT_FALSE(joint.law.acts());
  }
}

TEST(ArmsUnderSupervision, ASilentDeviceIsAHoldWithoutForceAndCanBeArmedAnew) {
  Bench bench;
  bench.couple();
  ASSERT_TRUE(bench.both(SiteState::active));
  bench.follower.set_health(DeviceHealth::not_responding);
  bench.run(0.03, {.dead_man = true});
  EXPECT_EQ(bench.sites.slave().state(), SiteState::hold);
  EXPECT_EQ(bench.sites.slave().cause(), SiteCause::device);
  EXPECT_TRUE(Bench::has_let_go(bench.last.slave));
  EXPECT_EQ(bench.sites.master().state(), SiteState::hold) << "it goes with the other";
  EXPECT_TRUE(bench.sites.healthy()) << "no fault";
  bench.follower.set_health(DeviceHealth::good);
  bench.run(0.05, {.arm = true});
  bench.run(0.5, {.dead_man = true});
  EXPECT_TRUE(bench.both(SiteState::active));
}

TEST(ArmsUnderSupervision, ADeviceThatIsLostIsAFaultOfOneAndAHoldOfTheOther) {
  Bench bench;
  bench.couple();
  bench.leader.set_health(DeviceHealth::lost);
  bench.run(0.2, {.dead_man = true});
  EXPECT_EQ(bench.sites.master().state(), SiteState::fault);
  EXPECT_EQ(bench.sites.master().site().fault(), GateFault::not_finite);
  EXPECT_TRUE(Bench::has_let_go(bench.last.master));
  EXPECT_EQ(bench.sites.slave().state(), SiteState::hold);
}

TEST(ArmsUnderSupervision, AHoldLetsTheCouplingFadeAndGoesOnCarryingTheArm) {
  Bench bench;
  bench.couple();
  // A stall beyond what a site may miss: both hold.
  bench.step({.dead_man = true}, 30);
  bench.run(0.01, {.dead_man = true});
  ASSERT_TRUE(bench.both(SiteState::hold));
  bench.run(1.2, {.dead_man = true});
  for (const auto& joint : bench.last.slave.output.site) {
    EXPECT_FALSE(joint.law.acts());
    EXPECT_EQ(joint.motor_force_N, joint.support_N);
  }
  EXPECT_TRUE(bench.last.slave.output.record.enabled);
}

TEST(ArmsUnderSupervision, ATickDoesNotAllocate) {
  Bench bench;
  bench.couple();
  const std::uint64_t before = laws::own_allocation_count();
  for (int i = 0; i < 20; ++i) bench.sites.step(bench.leader, bench.follower, {.number = bench.number++}, {});
  EXPECT_EQ(laws::own_allocation_count(), before);
}

/// One way of a link that somebody can cut, and the ends of two such ways.
struct Line {
  control::JointPacket packet{};
  bool fresh = false;
};
struct LineEnd {
  Line& in;
  Line& out;
  bool cut;
  template <class Take>
  void receive(const station::Tick&, Take&& take) noexcept {
    if (!cut && std::exchange(in.fresh, false)) take(in.packet);
  }
  void send(const control::JointPacket& packet, const station::Tick&) noexcept {
    out = {.packet = packet, .fresh = true};
  }
};

TEST(ArmsUnderSupervision, ALostLinkIsAHoldOfBothThatOnlyANewArmingLeaves) {
  Bench bench;
  auto master = bench.sites.master();
  auto slave = bench.sites.slave();
  Line to_slave, to_master;
  bool cut = false;
  const auto run = [&](double duration_s, const SiteRequests& pressed) {
    for (int i = 0; i < std::lround(duration_s / tick.value); ++i) {
      const station::Tick now{.number = bench.number++};
      LineEnd of_master{.in = to_master, .out = to_slave, .cut = cut};
      LineEnd of_slave{.in = to_slave, .out = to_master, .cut = cut};
      station::step(master, bench.leader, of_master, now, pressed);
      station::step(slave, bench.follower, of_slave, now, pressed);
      bench.move();
    }
  };
  const auto both = [&](SiteState state) { return master.state() == state && slave.state() == state; };
  const auto couple = [&] {
    run(0.05, {.arm = true});
    run(0.5, {.dead_man = true});
  };
  run(0.2, {});
  run(0.2, {.align = true});
  couple();
  ASSERT_TRUE(both(SiteState::active));
  cut = true;
  run(0.2, {.dead_man = true});
  EXPECT_TRUE(both(SiteState::hold));
  EXPECT_EQ(master.cause(), SiteCause::timed_out);
  EXPECT_EQ(slave.cause(), SiteCause::timed_out);
  cut = false;
  run(0.5, {.dead_man = true});
  EXPECT_TRUE(both(SiteState::hold)) << "nothing comes back by itself";
  couple();
  EXPECT_TRUE(both(SiteState::active));
}

/// A device that spoils one number of one joint.
struct Spoilt {
  ArmDevice* arm;
  double station::DeviceReading::*member = nullptr;
  double control::DriveReport::*tells = nullptr;
  double told = std::numeric_limits<double>::infinity();
  Joints<station::DeviceReading> read(const station::Tick& now) noexcept {
    auto reading = arm->read(now);
    if (member != nullptr) reading[3].*member = std::numeric_limits<double>::quiet_NaN();
    if (tells != nullptr) reading[3].motor_report.*tells = told;
    return reading;
  }
  void write(const Joints<station::DeviceCommand>& command) noexcept { arm->write(command); }
};

TEST(ArmsUnderSupervision, ANumberOfOneJointThatIsNoneLetsTheWholeArmGo) {
  for (int which = 0; which < 3; ++which) {
    Bench bench;
    bench.couple();
    Spoilt spoilt{.arm = &bench.follower};
    if (which == 0) spoilt.member = &station::DeviceReading::position_m;
    if (which == 1) spoilt.tells = &control::DriveReport::velocity_m_per_s;
    if (which == 2) spoilt.tells = &control::DriveReport::force_N;
    station::JointSupervisedPair::Output done;
    for (int i = 0; i < 100; ++i) {
      done = bench.sites.step(bench.leader, spoilt, {.number = bench.number++}, {.dead_man = true});
    }
    EXPECT_EQ(bench.sites.slave().state(), SiteState::fault) << which;
    EXPECT_EQ(bench.sites.slave().site().fault(), GateFault::not_finite) << which;
    EXPECT_TRUE(Bench::has_let_go(done.slave)) << which;
    for (const auto& joint : done.master.output.site) EXPECT_TRUE(std::isfinite(joint.motor_force_N));
  }
}

TEST(ArmsUnderSupervision, WhatNoMotorDoesIsNotBelievedAndTheArmFollowsAgainAfterwards) {
  Bench bench;
  bench.couple();
  Spoilt spoilt{.arm = &bench.follower, .tells = &control::DriveReport::velocity_m_per_s, .told = 1e300};
  bench.sites.step(bench.leader, spoilt, {.number = bench.number++}, {.dead_man = true});
  EXPECT_EQ(bench.sites.slave().site().fault(), GateFault::not_finite);
  bench.run(0.1, {});
  bench.run(0.2, {.clear = true});
  bench.run(0.05, {.arm = true});
  bench.run(0.5, {.dead_man = true});
  EXPECT_TRUE(bench.both(SiteState::active));
}

/// What passes is what the drive gives where it is, law and all.
TEST(ArmsUnderSupervision, TheGateBoundsTheLawWithTheForce) {
  Joints<control::SafetyGate::Params> tight = gates();
  for (control::SafetyGate::Params& gate : tight) gate.force_limit_N = 2.0;
  auto site = *follower_site(follower_params(), follower_arm(), tight, tick);
  const arm::JointVector away = arm_plants::bent() + arm::JointVector::Constant(7, 0.2);
  Joints<control::SlaveInput> input(joints);
  for (std::size_t i = 0; i < joints; ++i) {
    input[i].motor_position_m = arm_plants::bent()[static_cast<Eigen::Index>(i)];
    input[i].arrival.message.position_m = away[static_cast<Eigen::Index>(i)];
  }
  const auto output = site.step(input);
  for (std::size_t i = 0; i < joints; ++i) {
    const double given_N = output[i].motor_force_N + output[i].law.force_N(input[i].motor_position_m, 0.0);
    EXPECT_LE(std::fabs(given_N), 2.0 * (1.0 + 1e-9)) << i;
    EXPECT_LT(output[i].law.stiffness_N_per_m, 0.2 * 140.0 + 15.0) << "and the drive is soft by as much";
  }
}

}  // namespace
}  // namespace tactus::arm_control::arm_station_test
