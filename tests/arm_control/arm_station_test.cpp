#include <tactus/arm_control/arm_sites.hpp>
#include <tactus/arm_plants/arm_device.hpp>
#include <tactus/arm_plants/person.hpp>
#include <tactus/control/supervised_site.hpp>
#include <tactus/station/site_pair.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "tests/allocation_counter.hpp"
#include "tests/arm_plants/openarm.hpp"

/// Two arms of MuJoCo, supervised, by `station::step`, as a person on a machine has them.
namespace tactus::arm_control::arm_station_test {
namespace {

using arm_plants::ArmDevice;
using arm_plants::ArmPlant;
using control::GateFault;
using control::SiteCause;
using control::SiteRequests;
using control::SiteState;
using station::DeviceHealth;

constexpr Seconds tick{1e-3};
constexpr int steps_in_a_tick = 10;
constexpr std::size_t joints = 7;
constexpr arm::HandImpedance firm{
    .mass_kg = 0.4, .stiffness_N_per_m = 400.0, .damping_N_s_per_m = 30.0, .lever_m = 0.05};

/// Friction as the arm's data sheet has it: it keeps an arm that nobody carries from falling freely.
ArmPlant::Params arm_params() {
  ArmPlant::Params params = arm_plants::openarm_class();
  for (std::size_t i = 0; i < joints; ++i) {
    params.chain.joints[i].friction.coulomb_N_m = i < 4 ? 0.3 : 0.08;
    params.chain.joints[i].friction.viscous_N_m_s_per_rad = 0.06;
    params.motors[i].torque_limit_N_m = params.chain.joints[i].limits.effort_N_m;
  }
  return params;
}

Joints<control::SafetyGate::Params> gates() {
  Joints<control::SafetyGate::Params> gates(joints, widest_gate());
  for (std::size_t i = 0; i < joints; ++i) {
    gates[i].force_limit_N = arm_params().chain.joints[i].limits.effort_N_m;
    gates[i].rate_limit_N_per_s = 2000.0;
    gates[i].velocity_limit_m_per_s = 8.0;
    gates[i].position_limit_m = 3.1;
  }
  return gates;
}

/// Drives that tell no torque from outside: nothing for a check of it to compare with.
Joints<control::SupervisionParams> supervision() {
  control::SupervisionParams params;
  params.force_sensor.residual_limit_N = 200.0;
  return Joints<control::SupervisionParams>(joints, params);
}

ArmLeader::Params leader_params() {
  ArmLeader::Params params{.method = ArmMethod::cancellation, .force_gain = 1.0, .damping_N_s_per_m = 25.0};
  params.feed_forward.friction_share = 0.3;
  params.drive_damping_limit_N_s_per_m = 20.0;
  for_each_field<EachJoint<DriveDamping>>(
      [&](const auto& each) { (params.drive_damping.*each.member).damping_N_m_s_per_rad = 1.0; });
  params.drive_damping.joint_2.damping_N_m_s_per_rad = 3.0;
  params.model.hand = firm;
  return params;
}

ArmFollower::Params follower_params() {
  ArmFollower::Params params{.tool_stiffness_limit_N_per_m = 400.0, .tool_damping_limit_N_s_per_m = 8.0};
  for_each_field<EachJoint<DriveGains>>([&](const auto& each) {
    params.gains.*each.member = {.stiffness_N_m_per_rad = 140.0, .damping_N_m_s_per_rad = 3.0};
  });
  params.gains.joint_5 = params.gains.joint_6 =
      params.gains.joint_7 = {.stiffness_N_m_per_rad = 18.0, .damping_N_m_s_per_rad = 0.2};
  params.feed_forward.friction_share = 0.0;
  params.observer.dead_band_share = 1.0;
  return params;
}

ArmLeader::Arm leader_arm() {
  return {.carried = arm_params().chain,
          .induced = {.chain = arm_params().chain, .tool_m = arm_params().tool_m},
          .gains = follower_params().gains.of(joints)};
}
ArmFollower::Arm follower_arm() { return {.chain = arm_params().chain, .tool_m = arm_params().tool_m}; }

Joints<double> start() {
  Joints<double> at(joints);
  for (std::size_t i = 0; i < joints; ++i) at[i] = arm_plants::bent()[static_cast<Eigen::Index>(i)];
  return at;
}

ArmDevice device(double carried_kg) {
  ArmPlant::Params params = arm_params();
  params.carried_kg = carried_kg;
  return {*ArmPlant::make(params, arm_plants::bent()), Joints<station::DeviceLimits>(joints)};
}

station::JointSupervisedPair supervised_pair() {
  auto master =
      control::supervise_master(*leader_site(leader_params(), leader_arm(), gates(), tick), supervision(), 1, tick);
  auto slave = control::supervise_slave(*follower_site(follower_params(), follower_arm(), gates(), tick), supervision(),
                                        2, tick);
  return *station::JointSupervisedPair::around(*std::move(master), *std::move(slave), {}, tick, start());
}

/// A firm hand at the leader's tool and a stiff surface below the follower's, 10 mm away. Nobody presses anything yet.
struct Bench {
  ArmDevice leader = device(0.4), follower = device(0.0);
  arm_plants::Person person;
  station::JointSupervisedPair sites = supervised_pair();
  station::JointSupervisedPair::Output last;
  arm::Vector3 began_m = follower.plant().tool().position_m;
  arm_plants::Wall wall{
      .point_m = began_m - 0.01 * arm::Vector3::UnitZ(),
      .normal = arm::Vector3::UnitZ(),
      .contact = *mechanics::Environment::make({.stiffness_N_per_m = 20000.0, .damping_N_s_per_m = 20.0}, tick)};
  double aim_m = 0.0;        ///< of the hand, along the wall's normal
  double contact_N = 0.0;    ///< now
  double most_step_N = 0.0;  ///< between two ticks, of any motor, as the gate counts it
  std::int64_t number = 0;
  bool held = true;

  Bench() : person(*arm_plants::Person::make({.hand = firm}, tick, leader.plant().tool())) {}

  void step(const SiteRequests& pressed, std::int64_t missed = 0) {
    number += missed;
    const auto passed = [this](std::size_t i) {
      return std::pair(sites.master().site().gates()[i].motor().passed_N(),
                       sites.slave().site().gates()[i].motor().passed_N());
    };
    std::array<std::pair<double, double>, joints> before;
    for (std::size_t i = 0; i < joints; ++i) before[i] = passed(i);
    last = sites.step(leader, follower, {.number = number++, .missed = missed}, pressed);
    for (std::size_t i = 0; i < joints; ++i) {
      most_step_N = std::fmax(most_step_N, std::fabs(passed(i).first - before[i].first));
      most_step_N = std::fmax(most_step_N, std::fabs(passed(i).second - before[i].second));
    }
    move();
  }
  void move() {
    const arm::Vector3 path = began_m + aim_m * arm::Vector3::UnitZ();
    person.begin_tick(path, path, leader.plant().tool());
    for (int i = 0; i < steps_in_a_tick; ++i) {
      leader.step(held ? person.force(leader.plant().tool(), i * 1e-4) : arm_plants::ToolForce{});
      const arm_plants::ToolForce contact{.force_N = wall.force_N(follower.plant().tool())};
      contact_N = std::fabs(contact.force_N.z());
      follower.step(contact);
    }
  }
  void run(double duration_s, const SiteRequests& pressed) {
    for (int i = 0; i < std::lround(duration_s / tick.value); ++i) step(pressed);
  }
  void couple() {
    run(0.05, {});
    run(0.2, {.align = true});
    run(0.05, {.arm = true});
    run(0.5, {.dead_man = true});
  }
  /// The hand goes 12 mm beyond the surface, in a second, and stays.
  void press_on_the_wall() {
    for (int i = 0; i < 1000; ++i) {
      aim_m = -0.022e-3 * i;
      step({.dead_man = true});
    }
    run(0.5, {.dead_man = true});
  }
  [[nodiscard]] bool both(SiteState state) const {
    return sites.master().state() == state && sites.slave().state() == state;
  }
  /// No torque of any motor, no law and no power.
  [[nodiscard]] static bool has_let_go(const auto& done) {
    for (const auto& joint : done.output.site) {
      if (joint.motor_force_N != 0.0 || joint.law.acts()) return false;
    }
    return !done.output.record.enabled;
  }
};

double fell_mm(const ArmDevice& arm, const arm::Vector3& from_m) {
  return 1e3 * (arm.plant().tool().position_m - from_m).norm();
}

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
  bench.follower.set_health(DeviceHealth::silent);
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
  EXPECT_EQ(master.cause(), SiteCause::silent);
  EXPECT_EQ(slave.cause(), SiteCause::silent);
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
  double control::DriveTells::*tells = nullptr;
  double told = std::numeric_limits<double>::infinity();
  Joints<station::DeviceReading> read(const station::Tick& now) noexcept {
    auto reading = arm->read(now);
    if (member != nullptr) reading[3].*member = std::numeric_limits<double>::quiet_NaN();
    if (tells != nullptr) reading[3].motor_tells.*tells = told;
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
    if (which == 1) spoilt.tells = &control::DriveTells::velocity_m_per_s;
    if (which == 2) spoilt.tells = &control::DriveTells::force_N;
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
  Spoilt spoilt{.arm = &bench.follower, .tells = &control::DriveTells::velocity_m_per_s, .told = 1e300};
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
