// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include "tests/allocation_counter.hpp"
#include "tests/arm_plants/one_joint.hpp"
#include <Eigen/Dense>

namespace tactus::arm_plants {
namespace {

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
