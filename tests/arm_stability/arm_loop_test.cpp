// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <complex>
#include <numbers>

#include "tests/arm_stability/glued_pair.hpp"
#include <gtest/gtest.h>

namespace tactus::arm_stability {
namespace {

using Words = std::vector<std::string>;

ArmLoop loop_of(const experiments::ArmPairSetup& setup) { return ArmLoop::make(setup, setup.exact).value(); }

double limit_of(const ArmLoop& loop) { return gain_limit({&loop, 1}).gain; }

double growth_per_s(const ArmLoop& loop, double gain) {
  return std::log(std::abs(slowest_mode(loop, gain).pole)) / loop.tick_s();
}

/// A single joint of inertia J that turns a tool at radius r about a vertical axis.
experiments::ArmPairSetup one_joint() {
  auto setup = setup_of({"bare.toml", "control.follower.torque=sensor", "task.direction=along-y", "servo.rate_Hz=10000",
                         "operator.hand.mass_kg=0", "operator.hand.lever_m=0", "control.feed_forward.friction_share=0",
                         "control.follower.gains.joint_1.stiffness_N_m_per_rad=50"});
  arm::JointParams joint;
  joint.body = {.mass_kg = 1.0, .xx_kg_m2 = 0.05, .yy_kg_m2 = 0.05, .zz_kg_m2 = 0.05};
  joint.drive.armature_kg_m2 = 0.01;
  joint.friction.viscous_N_m_s_per_rad = 0.3;
  for (experiments::DescribedArm* one : {&setup.leader, &setup.follower}) {
    one->joints = {"joint_1"};
    one->arm.chain.joints = Joints<arm::JointParams>(1, joint);
    one->arm.motors = Joints<arm_plants::MotorParams>(1);
    one->arm.tool_m = arm::Vector3(0.5, 0.0, 0.0);
    one->start = arm::JointVector::Zero(1);
  }
  setup.exact.induced = {.chain = setup.leader.arm.chain, .tool_m = setup.leader.arm.tool_m};
  return setup;
}

TEST(ArmLoop, OfOneJointIsItsClosedForm) {
  const auto setup = one_joint();
  const auto& hand = setup.params.person.hand;
  const auto& wall = setup.params.wall;
  const ArmLoop loop = loop_of(setup);
  constexpr double J = 0.06, r2 = 0.25, b = 0.3, kp = 50.0, kd = 3.0;
  const double tick_s = loop.tick_s();
  for (const double frequency_Hz : {0.5, 3.0, 8.0, 20.0}) {
    const std::complex<double> s(0.0, 2.0 * std::numbers::pi * frequency_Hz);
    const auto held = J * s * s + (b + hand.damping_N_s_per_m * r2) * s + hand.stiffness_N_per_m * r2;
    const auto wall_torque = (wall.stiffness_N_per_m + wall.damping_N_s_per_m * s) * r2;
    const auto touching = J * s * s + (b + kd) * s + kp + wall_torque;
    // Each bus takes a tick and holds for one, half of it on average; the message takes another.
    const auto late = std::exp(-s * tick_s * (1.5 + 1.5 + 1.0));
    const std::complex<double> expected = -late / held * (kp + kd * s) / touching * wall_torque;
    const std::complex<double> found = stability::response(loop.open(), std::exp(s * tick_s))(0, 0);
    EXPECT_LT(std::abs(found - expected) / std::abs(expected), 2e-3) << frequency_Hz << " Hz";
  }
}

TEST(ArmLoop, AKickGrowsOnTheSimulatedPairAsFastAsTheSlowestModeSays) {
  // MuJoCo's arms and the sites themselves, the tool glued to the wall, without friction and steps.
  const Words plain{"bare.toml", "task.pose=2", "task.direction=along-x"};
  const std::vector<Words> cases{
      {"control.method=position-force"},
      {},
      plain,
      {"bare.toml", "task.pose=2", "task.direction=along-x", "control.method=cancellation"},
      {"bare.toml", "control.follower.torque=sensor"},
      {"bare.toml", "arm.joint_stiffness_N_m_per_rad=3000", "control.follower.torque=sensor"},
      {"bare.toml", "arm.joint_stiffness_N_m_per_rad=10000"},
      {"elastic-joints.toml", "control.method=cancellation"},
      {"bare.toml", "task.pose=2", "task.direction=along-x",
       "control.follower.observer.cutoff_each.joint_1.cutoff_Hz=12"},
      {"bare.toml", "task.pose=2", "task.direction=along-x", "control.command_low_pass_each.joint_1.cutoff_Hz=20"},
      {"bare.toml", "task.pose=2", "task.direction=along-x", "control.force_low_pass_each.joint_1.cutoff_Hz=15"},
      {"elastic-joints.toml", "control.method=position-force",
       "control.follower.observer.cutoff_each.joint_2.cutoff_Hz=12",
       "control.follower.observer.cutoff_each.joint_4.cutoff_Hz=12"},
      {"yam-pair.toml", "light-grip.toml"},
      {"bare.toml", "light-grip.toml", "control.command_low_pass_Hz=8", "control.force_low_pass_Hz=20",
       "task.direction=along-y", "task.pose=3"}};
  for (const Words& words : cases) {
    std::string named;
    for (const std::string& word : words) named += word + " ";
    const auto setup = smooth(setup_of(words));
    const ArmLoop loop = loop_of(setup);
    const double limit = limit_of(loop);
    ASSERT_GT(limit, 0.0) << named;
    for (const double share : {0.95, 1.05}) {
      const double linear = growth_per_s(loop, share * limit);
      EXPECT_EQ(linear > 0.0, share > 1.0) << named;
      EXPECT_NEAR(simulated_growth_per_s(setup, share * limit), linear, 0.5) << named << share;
    }
  }
}

TEST(ArmLoop, WhatHasNotBeenMadeLinearIsRefusedByName) {
  for (const char* method : {"position-position", "factr", "feedback-avoidance", "four-channel"}) {
    const auto setup = setup_of({std::string("control.method=") + method});
    const auto loop = ArmLoop::make(setup, setup.exact);
    ASSERT_FALSE(loop) << method;
    EXPECT_EQ(loop.error().parameter, "control.method");
    EXPECT_NE(loop.error().message.find(method), std::string::npos) << loop.error().message;
  }
  const auto passive = setup_of({"control.passivity.port=joints"});
  EXPECT_EQ(ArmLoop::make(passive, passive.exact).error().parameter, "control.passivity.port");
  const auto handle = setup_of({"inverse3-arm.toml"});
  EXPECT_EQ(ArmLoop::make(handle, handle.exact).error().parameter, "control.follower.coupling");
}

TEST(ArmLoop, ASurfaceOfACurvedLawIsThatOfItsSlopeAtTheForceThatIsNamed) {
  auto setup = one_joint();
  auto& wall = setup.params.wall;
  constexpr double preload_N = 4.0, exponent = 1.5, dissipation = 0.8, reference_m = 1e-4;
  const double stiffness = wall.stiffness_N_per_m;
  wall = {.law = experiments::SurfaceLaw::hunt_crossley,
          .stiffness_N_per_m = stiffness,
          .exponent = exponent,
          .dissipation_s_per_m = dissipation};
  const ArmLoop curved = ArmLoop::make(setup, setup.exact, {.preload_N = preload_N}).value();
  // F = k δ (δ/δ₀)ⁿ⁻¹ (1 + c δ̇): its slopes are n F/δ and c F.
  const double depth_m = std::pow(preload_N * std::pow(reference_m, exponent - 1.0) / stiffness, 1.0 / exponent);
  EXPECT_NEAR(curved.wall_stiffness_N_per_m(), exponent * preload_N / depth_m, 1e-5 * curved.wall_stiffness_N_per_m());
  wall = {.stiffness_N_per_m = exponent * preload_N / depth_m, .damping_N_s_per_m = dissipation * preload_N};
  EXPECT_NEAR(limit_of(curved), limit_of(loop_of(setup)), 1e-4 * limit_of(curved));

  wall.law = experiments::SurfaceLaw::hunt_crossley;
  const auto refused = ArmLoop::make(setup, setup.exact);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().parameter, "wall.law");
  EXPECT_NE(refused.error().message.find("--preload"), std::string::npos) << refused.error().message;
}

TEST(ArmMargins, TheLimitHasAPoleOnTheUnitCircleAndTheDiskMarginLiesWithin) {
  for (const Words& words : {Words{"control.method=position-force"}, Words{"bare.toml", "task.direction=along-x"},
                             Words{"bare.toml", "light-grip.toml"}}) {
    const ArmLoop loop = loop_of(setup_of(words));
    const double limit = limit_of(loop);
    EXPECT_NEAR(std::abs(slowest_mode(loop, limit).pole), 1.0, 1e-4);
    for (const double gain : {0.2 * limit, 0.6 * limit}) {
      const stability::DiskMargin disk = disk_margin(loop, gain);
      EXPECT_GT(disk.alpha, 0.0);
      EXPECT_LE(disk.gain_factor() * gain, 1.01 * limit) << "what it promises must hold";
    }
    EXPECT_EQ(disk_margin(loop, 1.1 * limit).alpha, 0.0);
  }
}

TEST(ArmMargins, OfOneJointTheDiskMarginIsThatOfItsCurve) {
  const ArmLoop loop = loop_of(one_joint());
  const double gain = 0.5 * limit_of(loop);
  const auto curve = stability::trace(
      [&](double w) { return -gain * stability::response(loop.open(), std::polar(1.0, w * loop.tick_s()))(0, 0); },
      loop.tick_s());
  EXPECT_NEAR(disk_margin(loop, gain).alpha, stability::disk_margin(curve).alpha, 1e-3);
}

TEST(ArmMargins, FrictionIsADamperInArmsAndModelAlike) {
  const auto setup = setup_of({"bare.toml"});
  const ArmLoop rubbing = ArmLoop::make(setup, setup.exact, {.friction_speed_rad_per_s = 0.1}).value();
  EXPECT_GT(limit_of(rubbing), 1.5 * limit_of(loop_of(setup))) << "friction is damping that the loop has";
  // At large amplitudes Coulomb friction comes to nothing.
  const ArmLoop wide = ArmLoop::make(setup, setup.exact, {.friction_speed_rad_per_s = 1e6}).value();
  EXPECT_NEAR(limit_of(wide), limit_of(loop_of(setup)), 1e-2 * limit_of(wide));
}

}  // namespace
}  // namespace tactus::arm_stability
