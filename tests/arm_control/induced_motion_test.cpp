// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/induced_motion.hpp>
#include <tactus/simulation/arm_plants/tool_operator.hpp>

#include <cmath>
#include <complex>

#include "tests/arm_plants/openarm.hpp"

namespace tactus::arm_control::induced_motion_test {
namespace {

constexpr double tick_s = 1e-3;
constexpr arm::HandImpedance firm{
    .mass_kg = 0.4, .stiffness_N_per_m = 400.0, .damping_N_s_per_m = 30.0, .lever_m = 0.1};

struct Moved {
  JointVector plant, model;
};

/// What a burst of torque does to the simulated arm in a hand that wants it to stay, and what the model says, at each
/// tick. `believed` is a factor on all that the model believes of inertia.
std::vector<Moved> burst(const arm::JointFriction& friction, const InducedMotion::Params& params, double torque_N_m,
                         double believed = 1.0, double joint_stiffness_N_m_per_rad = 0.0) {
  arm_plants::ArmPlant::Params plant = arm_plants::openarm_class();
  plant.carried_kg = firm.mass_kg;
  plant.chain.gravity = {0.0, 0.0, 0.0};  // else an elastic arm sags from the place that is measured
  for (arm::JointParams& joint : plant.chain.joints) joint.friction = friction;
  for (arm_plants::MotorParams& motor : plant.motors) {
    motor.joint_stiffness_N_m_per_rad = joint_stiffness_N_m_per_rad;
  }
  arm_plants::ArmPlant arm = *arm_plants::ArmPlant::make(plant, arm_plants::bent());
  arm_plants::ToolOperator person =
      *arm_plants::ToolOperator::make({.hand = firm, .correction_gain_per_s = 0.0}, Seconds{tick_s}, arm.tool());
  arm::Chain::Params model_arm = plant.chain;
  for (arm::JointParams& joint : model_arm.joints) {
    for_each_field<arm::Body>([&](const auto& f) {
      if (std::string_view(f.name).starts_with("centre")) return;
      joint.body.*f.member *= believed;
    });
    joint.drive.armature_kg_m2 *= believed;
  }
  auto model =
      *InducedMotion::make(params, {},
                           {.chain = model_arm,
                            .tool_m = plant.tool_m,
                            .joint_stiffness_N_m_per_rad = JointVector::Constant(7, joint_stiffness_N_m_per_rad),
                            .joint_damping_N_m_s_per_rad = JointVector::Zero(7)},
                           Seconds{tick_s});
  const arm::Chain chain = *arm::Chain::make(plant.chain);
  const arm::Vector3 start_m = arm.tool().position_m;
  const JointVector start = arm.read().position;
  std::vector<Moved> found;
  for (int k = 0; k < 300; ++k) {
    const JointVector displayed = JointVector::Constant(7, k < 60 ? torque_N_m : 0.0)
                                      .cwiseProduct((JointVector(7) << 1.0, 1.0, 0.6, 0.6, 0.2, 0.2, 0.2).finished());
    const arm::ArmReading reading = arm.read();
    found.push_back({reading.position - start, model.position()});
    arm.write(arm::ArmCommand::of_torque(chain.gravity_torque(reading.position) + displayed));
    model.step(displayed, reading.position, reading.velocity);
    person.begin_tick(start_m, start_m, arm.tool());
    for (int i = 0; i < 10; ++i) arm.step(person.force(arm.tool(), i * 1e-4));
  }
  return found;
}

/// Largest difference over the largest motion.
double apart(const std::vector<Moved>& moved) {
  double most = 0.0, off = 0.0;
  for (const Moved& m : moved) {
    most = std::max(most, m.plant.norm());
    off = std::max(off, (m.plant - m.model).norm());
  }
  EXPECT_GT(most, 0.01);
  return off / most;
}

TEST(InducedMotion, IsWhatASimulatedArmInAHandDoesUnderTorque) {
  const InducedMotion::Params params{.hand = firm, .washout_Hz = 0.0};
  EXPECT_LT(apart(burst({.viscous_N_m_s_per_rad = 0.3}, params, 1.0)), 0.05);
  EXPECT_LT(apart(burst({.coulomb_N_m = 0.1, .viscous_N_m_s_per_rad = 0.1}, params, 1.5)), 0.15);
}

TEST(InducedMotion, OfAHandleThatSlidesIsWhatAMassOnASpringDoes) {
  arm::Chain::Params handle{.joints = Joints<arm::JointParams>(3)};
  for (std::size_t i = 0; i < 3; ++i) {
    handle.joints[i].kind = arm::JointKind::prismatic;
    handle.joints[i].axis = {.x = i == 0 ? 1.0 : 0.0, .y = i == 1 ? 1.0 : 0.0, .z = i == 2 ? 1.0 : 0.0};
    handle.joints[i].body = {.mass_kg = i == 2 ? 0.2 : 0.001, .xx_kg_m2 = 1e-6, .yy_kg_m2 = 1e-6, .zz_kg_m2 = 1e-6};
  }
  auto model = *InducedMotion::make({.hand = firm, .washout_Hz = 0.0}, {}, {.chain = handle}, Seconds{tick_s});
  // m·w'' + B·w' + K·w = f from rest, underdamped or not, by its two poles.
  const double f = 2.0;
  const JointVector rest = JointVector::Zero(3);
  const JointVector force = (JointVector(3) << 0.0, f, 0.0).finished();
  const double mass = 0.201 + firm.mass_kg, damping = firm.damping_N_s_per_m, stiffness = firm.stiffness_N_per_m;
  const std::complex<double> root = std::sqrt(std::complex<double>(damping * damping - 4.0 * mass * stiffness, 0.0));
  const std::complex<double> fast = (-damping - root) / (2.0 * mass), slow = (-damping + root) / (2.0 * mass);
  for (int k = 0; k < 200; ++k) {
    const double t = k * tick_s;
    const double told =
        f / stiffness * (1.0 + (fast * std::exp(slow * t) - slow * std::exp(fast * t)) / (slow - fast)).real();
    EXPECT_NEAR(model.position()[1], told, 2e-3 * f / stiffness) << k;
    EXPECT_NEAR(model.position()[0], 0.0, 1e-12);
    EXPECT_NEAR(model.position()[2], 0.0, 1e-12);
    model.step(force, rest, rest);
  }
}

TEST(InducedMotion, OfElasticJointsIsWhatTheMotorsDo) {
  const arm::JointFriction friction{.viscous_N_m_s_per_rad = 0.1};
  const InducedMotion::Params elastic{.hand = firm, .washout_Hz = 0.0, .joints = JointModel::elastic};
  const InducedMotion::Params rigid{.hand = firm, .washout_Hz = 0.0};
  EXPECT_LT(apart(burst(friction, elastic, 1.0, 1.0, 200.0)), 0.05);
  EXPECT_GT(apart(burst(friction, rigid, 1.0, 1.0, 200.0)), 0.1);
}

TEST(InducedMotion, OfElasticJointsNeedsTheirStiffness) {
  const arm::Chain::Params chain = arm_plants::openarm_class().chain;
  const auto made =
      InducedMotion::make({.hand = firm, .joints = JointModel::elastic}, {}, {.chain = chain}, Seconds{tick_s});
  EXPECT_EQ(made.error().parameter, "joints");
}

TEST(InducedMotion, WhatItBelievesOfInertiaMatters) {
  const arm::JointFriction friction{.viscous_N_m_s_per_rad = 0.3};
  EXPECT_GT(apart(burst(friction, {.hand = firm, .washout_Hz = 0.0}, 1.0, 1.5)), 0.1);
  EXPECT_GT(apart(burst(friction, {.hand = firm, .washout_Hz = 0.0, .inertia = InertiaModel::diagonal}, 1.0)), 0.2);
}

TEST(InducedMotion, ComesToRestWhereTheHandsStiffnessHoldsTheTorque) {
  arm::Chain::Params params = arm_plants::openarm_class().chain;
  for (arm::JointParams& joint : params.joints) joint.friction.viscous_N_m_s_per_rad = 0.3;
  const arm::Vector3 tool_m(0.0, 0.0, 0.15);
  const arm::Chain chain = *arm::Chain::make(params);
  auto model =
      *InducedMotion::make({.hand = firm, .washout_Hz = 0.0}, {}, {.chain = params, .tool_m = tool_m}, Seconds{tick_s});
  const arm::Jacobian jacobian = chain.jacobian(arm_plants::bent(), 6, tool_m);
  const arm::Vector3 force_N(1.0, -2.0, 3.0);
  const JointVector torque = jacobian.topRows<3>().transpose() * force_N;
  for (int k = 0; k < 20000; ++k) model.step(torque, arm_plants::bent(), model.velocity());
  EXPECT_LT((jacobian.topRows<3>() * model.position() - force_N / firm.stiffness_N_per_m).norm(), 1e-6);
}

TEST(InducedMotion, SlowMotionIsWashedOut) {
  arm::Chain::Params params = arm_plants::openarm_class().chain;
  for (arm::JointParams& joint : params.joints) joint.friction.viscous_N_m_s_per_rad = 0.3;
  auto model = *InducedMotion::make({.hand = firm, .washout_Hz = 1.0}, {},
                                    {.chain = params, .tool_m = {0.0, 0.0, 0.15}}, Seconds{tick_s});
  const arm::Jacobian jacobian = arm::Chain::make(params)->jacobian(arm_plants::bent(), 6, {0.0, 0.0, 0.15});
  const JointVector torque = jacobian.topRows<3>().transpose() * arm::Vector3(0.0, 0.0, 5.0);
  double most = 0.0;
  for (int k = 0; k < 3000; ++k) {
    model.step(torque, arm_plants::bent(), model.velocity());
    most = std::max(most, model.position().norm());
  }
  EXPECT_GT(most, 0.01);
  EXPECT_LT(model.position().norm(), 0.01 * most);
}

}  // namespace
}  // namespace tactus::arm_control::induced_motion_test
