#include <tactus/signal/random.hpp>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/allocation_counter.hpp"
#include "tests/arm_plants/openarm.hpp"
#include <Eigen/Dense>

namespace tactus::arm_plants {
namespace {

const ToolForce nothing{};

void set_elastic(ArmPlant::Params& params, double stiffness_N_m_per_rad, double damping_N_m_s_per_rad = 0.0) {
  for (MotorParams& motor : params.motors) {
    motor.joint_stiffness_N_m_per_rad = stiffness_N_m_per_rad;
    motor.joint_damping_N_m_s_per_rad = damping_N_m_s_per_rad;
  }
}

/// By how much the energy of the arm changes while it falls freely for 0.3 s.
double drift_of_falling(ArmPlant::Params params, double step_s) {
  params.step_s = step_s;
  ArmPlant arm = *ArmPlant::make(params, bent());
  const double before = arm.energy_J();
  EXPECT_GT(std::fabs(before), 1.0);
  double most = 0.0;
  for (double t = 0.0; t < 0.3 - 0.5 * step_s; t += step_s) {
    arm.step(nothing);
    most = std::max(most, std::fabs(arm.energy_J() - before));
  }
  EXPECT_GT(arm.link_velocity().norm(), 1.0);
  return most;
}

TEST(ArmPlant, AFallingArmKeepsItsEnergyToTheOrderOfTheIntegrator) {
  for (const double stiffness : {0.0, 3000.0}) {
    ArmPlant::Params params = openarm_class();
    params.carried_kg = 0.4;
    if (stiffness > 0.0) set_elastic(params, stiffness);
    const double coarse = drift_of_falling(params, 2e-4);
    const double fine = drift_of_falling(params, 1e-4);
    EXPECT_LT(fine, 5e-3) << stiffness;
    EXPECT_NEAR(coarse / fine, 2.0, 0.2) << stiffness << ": first order";
  }
}

TEST(ArmPlant, TorqueOfTheChainsGravityHoldsItStill) {
  ArmPlant::Params params = openarm_class();
  params.carried_kg = 0.4;  // holds itself up
  ArmPlant arm = *ArmPlant::make(params, bent());
  const arm::Chain chain = *arm::Chain::make(params.chain);
  arm.write(ArmCommand::of_torque(chain.gravity_torque(bent())));
  for (int i = 0; i < 1000; ++i) arm.step(nothing);
  EXPECT_LT(arm.link_velocity().norm(), 1e-9);
  EXPECT_LT((arm.link_position() - bent()).norm(), 1e-9);
}

TEST(ArmPlant, WhatBearsItIsWhatTheChainSays) {
  for (const double stiffness : {0.0, 3000.0}) {
    ArmPlant::Params params = openarm_class();
    params.carried_kg = 0.4;
    if (stiffness > 0.0) set_elastic(params, stiffness);
    const ArmPlant arm = *ArmPlant::make(params, bent());
    const JointVector weight = arm::Chain::make(params.chain)->gravity_torque(bent());
    EXPECT_GT(weight.norm(), 1.0);
    EXPECT_LT((arm.bearing_torque() - weight).norm(), 1e-9 * weight.norm()) << stiffness;
  }
}

TEST(ArmPlant, ElasticJointsStartBentByWhatTheLinksWeigh) {
  ArmPlant::Params params = openarm_class();
  set_elastic(params, 3000.0);
  ArmPlant arm = *ArmPlant::make(params, bent());
  const JointVector weight = arm::Chain::make(params.chain)->gravity_torque(bent());
  EXPECT_LT((arm.read().position - bent() - weight / 3000.0).norm(), 1e-12);
  arm.write(ArmCommand::of_torque(weight));
  for (int i = 0; i < 1000; ++i) arm.step(nothing);
  EXPECT_LT((arm.link_position() - bent()).norm(), 1e-9);
}

TEST(ArmPlant, AStiffDriveStandsWhereWeightAndAForceOnTheToolPushIt) {
  ArmPlant::Params params = openarm_class();
  for (arm::JointParams& joint : params.chain.joints) joint.friction.viscous_N_m_s_per_rad = 1.0;
  ArmPlant arm = *ArmPlant::make(params, bent());
  const arm::Chain chain = *arm::Chain::make(params.chain);
  const ToolForce load{.force_N = Vector3(3.0, -2.0, 10.0), .moment_N_m = Vector3(0.2, 0.1, -0.3)};
  ArmCommand command = ArmCommand::of_torque(JointVector::Zero(7));
  command.position = bent();
  command.stiffness = JointVector::Constant(7, 100.0);
  command.damping = JointVector::Constant(7, 3.0);
  arm.write(command);
  for (int i = 0; i < 60000; ++i) arm.step(load);
  ASSERT_LT(arm.link_velocity().norm(), 1e-6);
  const JointVector q = arm.link_position();
  Eigen::Matrix<double, 6, 1> wrench;
  wrench << load.force_N, load.moment_N_m;
  const JointVector motors = 100.0 * (bent() - q);
  const JointVector asked = chain.gravity_torque(q) - chain.jacobian(q, 6, params.tool_m).transpose() * wrench;
  EXPECT_LT((motors - asked).norm(), 1e-4) << "of " << asked.norm() << " N m";
}

TEST(ArmPlant, TheToolIsAndMovesWhereTheChainSays) {
  const ArmPlant::Params params = openarm_class();
  ArmPlant arm = *ArmPlant::make(params, bent());
  for (int i = 0; i < 2000; ++i) arm.step({.force_N = Vector3(1.0, 2.0, 3.0)});
  const arm::Chain chain = *arm::Chain::make(params.chain);
  const JointVector q = arm.link_position();
  const arm::LinkPose last = chain.poses(q)[6];
  const ToolState tool = arm.tool();
  EXPECT_LT((tool.position_m - last.position_m - last.rotation * params.tool_m).norm(), 1e-12);
  const arm::JointVector v = arm.link_velocity();
  const Eigen::Matrix<double, 6, 1> twist = chain.jacobian(q, 6, params.tool_m) * v;
  ASSERT_GT(twist.norm(), 0.1);
  EXPECT_LT((tool.velocity_m_per_s - twist.head<3>()).norm() + (tool.turning_rad_per_s - twist.tail<3>()).norm(),
            1e-12);
  const ToolForce push{.force_N = Vector3(1.0, -2.0, 3.0), .moment_N_m = Vector3(0.1, 0.2, 0.3)};
  Eigen::Matrix<double, 6, 1> wrench;
  wrench << push.force_N, push.moment_N_m;
  EXPECT_LT((arm.torque_of(push) - chain.jacobian(q, 6, params.tool_m).transpose() * wrench).norm(), 1e-12);
}

/// One joint about the upright, which no weight loads.
ArmPlant::Params turntable(double armature_kg_m2, const arm::JointFriction& friction) {
  ArmPlant::Params params{.chain = {.joints = Joints<arm::JointParams>(1), .gravity = {}},
                          .motors = Joints<MotorParams>(1)};
  params.chain.joints[0].body = {.mass_kg = 1.0, .xx_kg_m2 = 0.01, .yy_kg_m2 = 0.01, .zz_kg_m2 = 0.01};
  params.chain.joints[0].drive.armature_kg_m2 = armature_kg_m2;
  params.chain.joints[0].friction = friction;
  return params;
}
JointVector one(double value) { return JointVector::Constant(1, value); }

TEST(ArmPlant, FrictionHoldsAJointBelowCoulombsTorqueAndSlowsItAbove) {
  const ArmPlant::Params params = turntable(0.01, {.coulomb_N_m = 0.3, .viscous_N_m_s_per_rad = 0.05});
  ArmPlant held = *ArmPlant::make(params, one(0.0));
  held.write(ArmCommand::of_torque(one(0.28)));
  for (int i = 0; i < 10000; ++i) held.step(nothing);
  EXPECT_LT(std::fabs(held.link_position()[0]), 1e-3) << "creeps in a second";
  ArmPlant sliding = *ArmPlant::make(params, one(0.0));
  sliding.write(ArmCommand::of_torque(one(0.5)));
  for (int i = 0; i < 10000; ++i) sliding.step(nothing);
  const double expected = 0.2 / 0.05 * (1.0 - std::exp(-0.05 / 0.02 * 1.0));
  EXPECT_NEAR(sliding.link_velocity()[0], expected, 0.01 * expected);
}

TEST(ArmPlant, FrictionHoldsEachOfAsManyJointsAsAnArmMayHave) {
  ArmPlant::Params params = openarm_class();
  const std::size_t last = params.chain.joints.size() - 1;
  params.chain.gravity = {0.0, 0.0, 0.0};
  params.chain.joints = Joints<arm::JointParams>(most_joints, params.chain.joints[last]);
  for (arm::JointParams& joint : params.chain.joints) joint.friction.coulomb_N_m = 0.3;
  params.motors = Joints<MotorParams>(most_joints, params.motors[last]);
  set_elastic(params, 3000.0, 1.0);
  params.carried_kg = 0.4;
  ArmPlant arm = *ArmPlant::make(params, JointVector::Zero(most_joints));
  arm.write(ArmCommand::of_torque(JointVector::Constant(most_joints, 0.25)));
  for (int i = 0; i < 2000; ++i) arm.step(nothing);
  EXPECT_TRUE(arm.healthy());
  EXPECT_LT(arm.link_position().cwiseAbs().maxCoeff(), 1e-3);
}

/// A link of 0.01 kg m² on a motor so heavy that it stands, with play in between.
ArmPlant::Params rattle(double play_rad, double stiffness_N_m_per_rad) {
  ArmPlant::Params params = turntable(1e6, {});
  set_elastic(params, stiffness_N_m_per_rad);
  params.motors[0].play_rad = play_rad;
  params.step_s = 1e-5;
  return params;
}

TEST(ArmPlant, ALinkFliesThroughItsPlayAndBouncesBetweenTheFlanks) {
  const double play_rad = 0.02, stiffness = 500.0, inertia_kg_m2 = 0.01;
  ArmPlant::Params params = rattle(play_rad, stiffness);
  params.tool_m = Vector3(0.1, 0.0, 0.0);
  ArmPlant arm = *ArmPlant::make(params, one(0.0));
  // A force on the tool, 0.1 m out, gives it speed within a millisecond.
  for (int i = 0; i < 100; ++i) arm.step({.force_N = Vector3(0.0, 50.0, 0.0)});
  const double speed = arm.link_velocity()[0];
  ASSERT_NEAR(speed, 0.1 * 50.0 * 1e-3 / inertia_kg_m2, 1e-3);
  // Two flights and two half swings on a spring a period; it returns to where it is now with the same speed.
  const double period_s = 2.0 * play_rad / speed + 2.0 * std::numbers::pi * std::sqrt(inertia_kg_m2 / stiffness);
  const double start = arm.link_position()[0], energy = arm.energy_J();
  const int periods = 5;
  const auto steps = static_cast<int>(std::lround(periods * period_s / params.step_s));
  double furthest = 0.0, drift_J = 0.0;
  for (int i = 0; i < steps; ++i) {
    arm.step(nothing);
    furthest = std::max(furthest, std::fabs(arm.link_position()[0]));
    drift_J = std::max(drift_J, std::fabs(arm.energy_J() - energy));
  }
  EXPECT_NEAR(arm.link_position()[0], start, 0.02 * play_rad);
  EXPECT_NEAR(arm.link_velocity()[0], speed, 1e-3);
  EXPECT_NEAR(furthest, 0.5 * play_rad + speed * std::sqrt(inertia_kg_m2 / stiffness), 1e-4);
  EXPECT_LT(drift_J, 0.01 * 0.5 * inertia_kg_m2 * speed * speed) << "flanks keep energy";
}

TEST(ArmPlant, PlayLiesOnTheFlankThatBearsTheWeightAndIsRefusedWithoutStiffness) {
  ArmPlant::Params params = openarm_class();
  set_elastic(params, 3000.0, 1.0);
  for (MotorParams& motor : params.motors) motor.play_rad = 0.004;
  ArmPlant arm = *ArmPlant::make(params, bent());
  const JointVector weight = arm::Chain::make(params.chain)->gravity_torque(bent());
  const JointVector expected = bent() + weight / 3000.0 + 0.002 * weight.cwiseSign();
  EXPECT_LT((arm.read().position - expected).norm(), 1e-12);
  arm.write(ArmCommand::of_torque(weight));
  for (int i = 0; i < 1000; ++i) arm.step(nothing);
  EXPECT_LT((arm.link_position() - bent()).norm(), 1e-6);

  params.motors[2].joint_stiffness_N_m_per_rad = 0.0;
  const auto refused = ArmPlant::make(params, bent());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().parameter, "joint_3.play_rad");
}

/// A joint that turns or slides, with its stops half a rad or metre to either side.
ArmPlant::Params stopped(arm::JointKind kind) {
  ArmPlant::Params params = turntable(0.01, {});
  params.chain.joints[0].kind = kind;
  params.chain.joints[0].limits = {.lower_rad = -0.5, .upper_rad = 0.5};
  return params;
}
double stop_stiffness(double inertia_kg_m2) { return inertia_kg_m2 * end_stop_rad_per_s * end_stop_rad_per_s; }

TEST(ArmPlant, AJointThatIsPushedComesToRestBeyondItsStopByTorqueOverStiffness) {
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

TEST(ArmPlant, AStopPushesAndNeverPulls) {
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

TEST(ArmPlant, AStopHoldsStillWhereLessMovesWithTheJointThanWhereTheArmBegan) {
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

TEST(ArmPlant, WhatFallsOntoAStopBouncesLowerAndGainsNoEnergy) {
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

TEST(ArmPlant, WithinItsLimitsAnArmMovesAsOneWithoutAny) {
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

TEST(ArmPlant, AnArmThrownAgainstAllOfItsStopsStaysBetweenThemAndLosesItsEnergy) {
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

TEST(ArmPlant, AnArmThatBeginsBeyondALimitHasItsStopThere) {
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

TEST(ArmPlant, AHostWithAWrongTableReadsAScaledVelocityAndCommandsTheOthersUnscaled) {
  ArmPlant::Params params = turntable(0.01, {});
  params.motors[0].velocity_scale = 2.5;
  ArmPlant arm = *ArmPlant::make(params, one(0.0));
  ArmCommand command = ArmCommand::of_torque(one(0.0));
  command.damping = one(5.0);
  command.velocity = one(1.0);
  arm.write(command);
  for (int i = 0; i < 10000; ++i) arm.step(nothing);
  EXPECT_NEAR(arm.link_velocity()[0], 0.4, 1e-6) << "the drive hears 1/2.5";
  EXPECT_NEAR(arm.read().velocity[0], 1.0, 1e-6) << "and the host reads what it asked for";
  params.motors[0].velocity_scale = 0.0;
  EXPECT_EQ(ArmPlant::make(params, one(0.0)).error().parameter, "joint_1.velocity_scale");
}

TEST(ArmPlant, AnElasticJointSwingsAsMotorAndLinkOnASpringDo) {
  ArmPlant::Params params = turntable(0.02, {});
  set_elastic(params, 300.0);
  ArmPlant arm = *ArmPlant::make(params, one(0.0));
  arm.write(ArmCommand::of_torque(one(1.0)));
  const double reduced_kg_m2 = 0.02 * 0.01 / 0.03;
  const double frequency_rad_per_s = std::sqrt(300.0 / reduced_kg_m2);
  double most = 0.0;
  for (int i = 1; i <= 2000; ++i) {
    arm.step(nothing);
    const double t = i * params.step_s;
    // Motor against link: half of the torque's share in the spring, swinging about it.
    const double bend = -1.0 * (0.01 / 0.03) / 300.0 * (1.0 - std::cos(frequency_rad_per_s * t));
    most = std::max(most, std::fabs(arm.link_position()[0] - arm.read().position[0] - bend));
  }
  EXPECT_LT(most, 0.05 * (0.01 / 0.03) / 300.0);
}

TEST(ArmPlant, DrivesTellInTheirStepsAndGiveNoMoreThanTheyCan) {
  ArmPlant::Params params = turntable(0.01, {});
  params.motors[0] = {
      .torque_limit_N_m = 2.0, .position_step_rad = 4e-4, .velocity_step_rad_per_s = 0.02, .torque_step_N_m = 0.03};
  ArmPlant arm = *ArmPlant::make(params, one(0.0));
  arm.write(ArmCommand::of_torque(one(5.0)));
  for (int i = 0; i < 337; ++i) arm.step(nothing);
  EXPECT_NEAR(arm.link_velocity()[0], 2.0 / 0.02 * 0.0337, 1e-9);
  const ArmReading read = arm.read();
  EXPECT_NEAR(read.torque[0], 2.01, 1e-12);  // 67 steps
  for (const auto& [value, step] : {std::pair(read.position[0], 4e-4), std::pair(read.velocity[0], 0.02)}) {
    EXPECT_NEAR(value / step, std::round(value / step), 1e-9);
  }
  EXPECT_LE(std::fabs(read.position[0] - arm.link_position()[0]), 2e-4);
}

TEST(ArmPlant, ACopyGoesOnByItselfWithEqualBits) {
  ArmPlant::Params params = openarm_class();
  for (arm::JointParams& joint : params.chain.joints) {
    joint.friction.coulomb_N_m = 0.2;
    joint.limits = {.lower_rad = 0.0, .upper_rad = 0.0};  // it begins at its stops
  }
  ArmPlant arm = *ArmPlant::make(params, bent());
  for (int i = 0; i < 500; ++i) arm.step(nothing);
  ArmPlant copy = arm;
  const JointVector then = copy.link_position();
  for (int i = 0; i < 500; ++i) arm.step({.force_N = Vector3(0.0, 0.0, 5.0)});
  EXPECT_EQ(copy.link_position(), then);
  for (int i = 0; i < 500; ++i) copy.step({.force_N = Vector3(0.0, 0.0, 5.0)});
  EXPECT_EQ(copy.link_position(), arm.link_position());
  EXPECT_EQ(copy.link_velocity(), arm.link_velocity());
}

TEST(ArmPlant, AStepDoesNotAllocate) {
  ArmPlant::Params params = openarm_class();
  params.carried_kg = 0.1;
  for (arm::JointParams& joint : params.chain.joints) {
    joint.friction.coulomb_N_m = 0.2;
    joint.limits = {.lower_rad = 0.0, .upper_rad = 0.0};  // it begins at its stops
  }
  set_elastic(params, 3000.0);
  ArmPlant arm = *ArmPlant::make(params, bent());
  const std::uint64_t before = laws::own_allocation_count();
  for (int i = 0; i < 100; ++i) {
    const ToolState tool = arm.tool();
    arm.write(ArmCommand::of_torque(-arm.read().velocity));
    arm.step({.force_N = -10.0 * tool.velocity_m_per_s});
  }
  EXPECT_EQ(laws::own_allocation_count(), before);
  EXPECT_TRUE(arm.healthy());
}

TEST(ArmPlant, WhatCannotBeSimulatedIsRefusedOrSaid) {
  ArmPlant::Params params = openarm_class();
  EXPECT_EQ(ArmPlant::make(params, one(0.0)).error().code, ErrorCode::inconsistent);
  params.chain.joints[2].friction.load = 0.1;
  EXPECT_EQ(ArmPlant::make(params, bent()).error().parameter, "joint_3.friction");
  params = openarm_class();
  ArmPlant arm = *ArmPlant::make(params, bent());
  arm.step({.force_N = Vector3::Constant(1e15)});
  arm.step(nothing);
  EXPECT_FALSE(arm.healthy());
}

}  // namespace
}  // namespace tactus::arm_plants
