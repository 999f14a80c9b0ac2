// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/random.hpp>

#include <cmath>
#include <numbers>

#include "tests/arm_plants/one_joint.hpp"
#include <Eigen/Dense>

namespace tactus::arm_plants {
namespace {

/// A joint that turns or slides, with its stops half a rad or metre to either side.
ArmPlant::Params stopped(arm::JointKind kind) {
  ArmPlant::Params params = turntable(0.01, {});
  params.chain.joints[0].kind = kind;
  params.chain.joints[0].limits = {.lower_rad = -0.5, .upper_rad = 0.5};
  return params;
}
double stop_stiffness(double inertia_kg_m2) { return inertia_kg_m2 * end_stop_rad_per_s * end_stop_rad_per_s; }

TEST(EndStop, AJointThatIsPushedComesToRestBeyondItsStopByTorqueOverStiffness) {
  for (const double elastic : {0.0, 300.0}) {
    for (const double play_rad : {0.0, 0.01}) {
      if (elastic == 0.0 && play_rad > 0.0) continue;
      for (const double torque_N_m : {-2.0, 2.0}) {
        for (const double step_s : {1e-4, 5e-4}) {
          ArmPlant::Params params = stopped(arm::JointKind::revolute);
          if (elastic > 0.0) set_elastic(params, elastic, 0.5);
          params.motors[0].play_rad = play_rad;
          params.step_s = step_s;
          ArmPlant arm = *ArmPlant::make(params, one(0.1));
          const double began_J = arm.energy_J();
          arm.write(ArmCommand::of_torque(one(torque_N_m)));
          for (double t = 0.0; t < 3.0; t += step_s) arm.step(nothing);
          // Of an elastic joint the link alone meets the stop, without the motor's 0.01 kg m^2.
          const double beyond_rad = torque_N_m / stop_stiffness(elastic > 0.0 ? 0.01 : 0.02);
          const double bend_rad =
              elastic > 0.0 ? torque_N_m / elastic + std::copysign(0.5 * play_rad, torque_N_m) : 0.0;
          EXPECT_LT(std::fabs(beyond_rad), 1.3e-3);
          EXPECT_NEAR(arm.link_position()[0], std::copysign(0.5, torque_N_m) + beyond_rad, 1e-7) << elastic;
          EXPECT_NEAR(arm.read().position[0], arm.link_position()[0] + bend_rad, 1e-7) << elastic;
          const double springs_J = 0.5 * torque_N_m * (beyond_rad + (elastic > 0.0 ? torque_N_m / elastic : 0.0));
          EXPECT_NEAR(arm.energy_J() - began_J, springs_J, 1e-6) << elastic;
          EXPECT_LT(std::fabs(arm.link_velocity()[0]), 1e-6) << elastic;
        }
      }
    }
  }
}

TEST(EndStop, AStopPushesAndNeverPulls) {
  ArmPlant arm = *ArmPlant::make(stopped(arm::JointKind::revolute), one(0.1));
  arm.write(ArmCommand::of_torque(one(2.0)));
  for (int i = 0; i < 20000; ++i) arm.step(nothing);
  arm.write(ArmCommand::of_torque(one(0.0)));
  double speed = arm.link_velocity()[0];
  for (int i = 0; i < 1000; ++i) {
    arm.step(nothing);
    ASSERT_LE(arm.link_velocity()[0], speed) << "slower on its way out";
    speed = arm.link_velocity()[0];
  }
  EXPECT_LT(arm.link_position()[0], 0.5);
}

TEST(EndStop, AStopHoldsStillWhereLessMovesWithTheJointThanWhereTheArmBegan) {
  // Bent, the first joint swings the last link about its long side; stretched, that link may stay behind.
  ArmPlant::Params params{.chain = {.joints = Joints<arm::JointParams>(3), .gravity = {}},
                          .motors = Joints<MotorParams>(3)};
  params.step_s = 5e-4;
  params.chain.joints[1].axis = {0.0, 1.0, 0.0};
  for (arm::JointParams& joint : params.chain.joints) {
    joint.body = {.mass_kg = 1.0, .xx_kg_m2 = 5e-4, .yy_kg_m2 = 5e-4, .zz_kg_m2 = 5e-4};
  }
  params.chain.joints[2].body.xx_kg_m2 = params.chain.joints[2].body.yy_kg_m2 = 0.05;
  params.chain.joints[0].limits.upper_rad = 0.5;
  JointVector start(3);
  start << 0.49, std::numbers::pi / 2, 0.0;
  ArmPlant arm = *ArmPlant::make(params, start);
  ArmCommand stretches = ArmCommand::of_torque(JointVector::Zero(3));
  stretches.stiffness[1] = 20.0;
  stretches.damping[1] = 2.0;
  arm.write(stretches);
  for (int i = 0; i < 4000; ++i) arm.step(nothing);
  ASSERT_LT(std::fabs(arm.link_position()[1]), 1e-3);
  stretches.torque[0] = 0.5;
  arm.write(stretches);
  for (int i = 0; i < 4000; ++i) arm.step(nothing);
  EXPECT_NEAR(arm.link_position()[0], 0.5 + 0.5 / stop_stiffness(0.051), 1e-6);
  EXPECT_LT(std::fabs(arm.link_velocity()[0]), 1e-3);
}

TEST(EndStop, WhatFallsOntoAStopBouncesLowerAndGainsNoEnergy) {
  constexpr double g_m_per_s2 = 9.81;
  for (const arm::JointKind kind : {arm::JointKind::revolute, arm::JointKind::prismatic}) {
    for (const double elastic : {0.0, 3000.0}) {
      ArmPlant::Params params = stopped(kind);
      params.chain.joints[0].drive = {};
      params.chain.joints[0].body.centre_x_m = 0.1;
      const bool slides = kind == arm::JointKind::prismatic;
      params.chain.gravity = {.y_m_per_s2 = slides ? 0.0 : -g_m_per_s2, .z_m_per_s2 = slides ? -g_m_per_s2 : 0.0};
      if (elastic > 0.0) {
        params.chain.joints[0].drive.armature_kg_m2 = 0.01;
        set_elastic(params, elastic, 1.0);
      }
      ArmPlant arm = *ArmPlant::make(params, one(0.3));
      const double began_J = arm.energy_J();
      double top = 0.3, deepest = 0.0, energy_J = began_J;
      bool bounced = false;
      for (int i = 0; i < 50000; ++i) {
        const double before = arm.link_velocity()[0];
        arm.step(nothing);
        const double at = arm.link_position()[0], speed = arm.link_velocity()[0];
        deepest = std::min(deepest, at);
        // At rest at the top of a bounce.
        if (before > 0.0 && speed <= 0.0 && at > -0.49) {
          EXPECT_LT(at, top - 1e-3);
          top = at;
          bounced = true;
        }
        energy_J = std::max(energy_J, arm.energy_J());
      }
      EXPECT_TRUE(bounced) << slides << elastic;
      // The step that meets the stop is in it before the stop pushes.
      const double fall_J = 0.8 * g_m_per_s2 * (slides ? 1.0 : 0.1);
      const double entry = end_stop_rad_per_s * params.step_s;
      EXPECT_LT(energy_J, began_J + entry * entry * fall_J) << slides << elastic;
      const double inertia_kg_m2 = slides ? 1.0 : 0.02;
      const double weight = slides ? g_m_per_s2 : g_m_per_s2 * 0.1 * std::cos(0.5);
      EXPECT_NEAR(arm.link_position()[0], -0.5 - weight / stop_stiffness(inertia_kg_m2), 1e-6) << slides << elastic;
      EXPECT_GT(deepest, -0.52) << slides << elastic;
    }
  }
}

/// Torques that change every 40 steps.
void throw_about(ArmPlant& arm, signal::Random& random, int steps) {
  JointVector torque = JointVector::Zero(7);
  for (int i = 0; i < steps; ++i) {
    if (i % 40 == 0) {
      for (int joint = 0; joint < 7; ++joint) torque[joint] = random.uniform(-1.0, 1.0) * (joint < 4 ? 9.0 : 1.0);
      arm.write(ArmCommand::of_torque(torque));
    }
    arm.step(nothing);
  }
}

TEST(EndStop, WithinItsLimitsAnArmMovesAsOneWithoutAny) {
  for (const double stiffness : {0.0, 3000.0}) {
    ArmPlant::Params params = openarm_class();
    params.step_s = 5e-4;
    set_elastic(params, stiffness);
    ArmPlant::Params free = params;
    for (std::size_t i = 0; i < 7; ++i) {
      params.chain.joints[i].limits = {.lower_rad = -20.0, .upper_rad = 20.0};
      free.chain.joints[i].limits = {};
    }
    ArmPlant arm = *ArmPlant::make(params, bent()), other = *ArmPlant::make(free, bent());
    signal::Random random(3), same(3);
    throw_about(arm, random, 2000);
    throw_about(other, same, 2000);
    ASSERT_LT(arm.link_position().cwiseAbs().maxCoeff(), 20.0);
    EXPECT_GT((arm.link_position() - bent()).norm(), 0.5);
    EXPECT_EQ(arm.link_position(), other.link_position());
    EXPECT_EQ(arm.link_velocity(), other.link_velocity());
    EXPECT_EQ(arm.energy_J(), other.energy_J());
  }
}

TEST(EndStop, AnArmThrownAgainstAllOfItsStopsStaysBetweenThemAndLosesItsEnergy) {
  for (const double stiffness : {0.0, 3000.0}) {
    for (const double step_s : {1e-4, 2.5e-4, 5e-4}) {
      ArmPlant::Params params = openarm_class();
      params.chain.gravity = {0.0, 0.0, 0.0};
      params.step_s = step_s;
      for (std::size_t i = 0; i < 7; ++i) {
        params.motors[i].joint_stiffness_N_m_per_rad = i < 4 ? stiffness : 0.2 * stiffness;
        params.motors[i].joint_damping_N_m_s_per_rad = i < 4 ? 1.0 : 0.2;
        const double at = bent()[static_cast<Eigen::Index>(i)];
        params.chain.joints[i].limits = {.lower_rad = at - 0.4, .upper_rad = at + 0.4};
      }
      ArmPlant arm = *ArmPlant::make(params, bent());
      signal::Random random(5);
      double furthest = 0.0;
      for (int k = 0; k < 100; ++k) {
        throw_about(arm, random, 40);
        furthest = std::max(furthest, (arm.link_position() - bent()).cwiseAbs().maxCoeff());
      }
      EXPECT_GT(furthest, 0.4);
      EXPECT_LT(furthest, 0.4 + 0.1) << stiffness << " " << step_s;
      arm.write(ArmCommand::of_torque(JointVector::Zero(7)));
      const double thrown_J = arm.energy_J();
      double most_J = 0.0;
      for (double t = 0.0; t < 2.0; t += step_s) {
        arm.step(nothing);
        most_J = std::max(most_J, arm.energy_J());
      }
      EXPECT_TRUE(arm.healthy());
      EXPECT_LT(most_J, 1.05 * thrown_J) << stiffness << " " << step_s;
      EXPECT_LT(arm.energy_J(), 0.2 * thrown_J) << stiffness << " " << step_s;
    }
  }
}

TEST(EndStop, AnArmThatBeginsBeyondALimitHasItsStopThere) {
  const ArmPlant::Params params = stopped(arm::JointKind::revolute);
  ArmPlant arm = *ArmPlant::make(params, one(0.8));
  for (int i = 0; i < 1000; ++i) arm.step(nothing);
  EXPECT_EQ(arm.link_position()[0], 0.8) << "nothing throws it back";
  arm.write(ArmCommand::of_torque(one(2.0)));
  for (int i = 0; i < 10000; ++i) arm.step(nothing);
  EXPECT_NEAR(arm.link_position()[0], 0.8 + 2.0 / stop_stiffness(0.02), 1e-7);
  arm.write(ArmCommand::of_torque(one(-2.0)));
  for (int i = 0; i < 20000; ++i) arm.step(nothing);
  EXPECT_NEAR(arm.link_position()[0], -0.5 - 2.0 / stop_stiffness(0.02), 1e-7);
}

}  // namespace
}  // namespace tactus::arm_plants
