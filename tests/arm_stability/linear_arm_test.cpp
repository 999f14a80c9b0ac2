// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tests/arm_stability/glued_pair.hpp"
#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace tactus::arm_stability {
namespace {

/// What MuJoCo's arm and the linear one answer to a small torque of each motor after a while, held as a hand or a wall
/// would hold it. Positions of motors and links, then velocities, a column each.
struct Answers {
  Eigen::MatrixXd simulated, linear;
  [[nodiscard]] double off() const { return (simulated - linear).norm() / linear.norm(); }
};

Answers answers(const experiments::ArmPairSetup& setup, double hand_kg, double time_s) {
  const auto n = setup.leader.start.size();
  arm_plants::ArmPlant::Params params = setup.leader.arm;
  params.carried_kg = hand_kg;
  params.step_s = 1e-5;
  constexpr double stiffness = 400.0, damping = 30.0, lever2_m2 = 0.0025;
  Holding holding{.drive_stiffness = Eigen::VectorXd::Constant(n, 20.0),
                  .drive_damping = Eigen::VectorXd::Constant(n, 0.5),
                  .rubbing = Eigen::VectorXd(n)};
  holding.stiffness.diagonal() << stiffness * Eigen::Vector3d::Ones(), stiffness * lever2_m2 * Eigen::Vector3d::Ones();
  holding.damping.diagonal() << damping * Eigen::Vector3d::Ones(), damping * lever2_m2 * Eigen::Vector3d::Ones();
  for (Eigen::Index i = 0; i < n; ++i) {
    holding.rubbing[i] = setup.leader.arm.chain.joints[static_cast<std::size_t>(i)].friction.viscous_N_m_s_per_rad;
  }
  const auto still = arm_plants::ArmPlant::make(params, setup.leader.start).value();
  const arm_plants::ToolState began = still.tool();
  const auto reading = still.read();
  const auto run = [&](Eigen::Index joint, double torque_N_m) {
    auto plant = still;
    arm::ArmCommand command{.position = reading.position,
                            .velocity = arm::JointVector::Zero(n),
                            .stiffness = holding.drive_stiffness,
                            .damping = holding.drive_damping,
                            .torque = still.bearing_torque()};
    command.torque[joint] += torque_N_m;
    plant.write(command);
    for (int k = 0; k * params.step_s < time_s - 1e-9; ++k) {
      const auto tool = plant.tool();
      arm::Vector3 turned = arm::Vector3::Zero();
      for (int axis = 0; axis < 3; ++axis) {
        turned += 0.5 * Eigen::Vector3d(tool.rotation.col(axis)).cross(Eigen::Vector3d(began.rotation.col(axis)));
      }
      plant.step({.force_N = stiffness * (began.position_m - tool.position_m) - damping * tool.velocity_m_per_s,
                  .moment_N_m = lever2_m2 * (stiffness * turned - damping * tool.turning_rad_per_s)});
    }
    Eigen::VectorXd all(4 * n);
    const auto now = plant.read();
    all << now.position, now.velocity, plant.link_position(), plant.link_velocity();
    return all;
  };
  constexpr double torque_N_m = 1e-3;
  Answers found{.simulated = Eigen::MatrixXd(4 * n, n), .linear = {}};
  for (Eigen::Index i = 0; i < n; ++i) {
    found.simulated.col(i) = (run(i, torque_N_m) - run(i, -torque_N_m)) / (2.0 * torque_N_m);
  }
  const auto arm = linear_arm(params, setup.leader.start, holding).value();
  found.linear = arm.c * stability::sampled(arm, time_s, 0.0).b;
  return found;
}

TEST(LinearArm, AnswersAsMuJoCosArmDoesToSmallTorques) {
  for (const char* direction : {"task.pose=0", "task.pose=4"}) {
    const auto rigid = smooth(setup_of({direction}));
    EXPECT_LT(answers(rigid, 0.4, 0.005).off(), 2e-3) << direction;
    EXPECT_LT(answers(rigid, 0.0, 0.05).off(), 2e-3) << direction;
    const auto elastic =
        smooth(setup_of({direction, "arm.joint_stiffness_N_m_per_rad=3000", "arm.joint_damping_N_m_s_per_rad=0.5"}));
    EXPECT_LT(answers(elastic, 0.4, 0.005).off(), 2e-3) << direction;
    EXPECT_LT(answers(elastic, 0.4, 0.05).off(), 5e-3) << direction;
  }
}

TEST(LinearArm, TheSlopeOfItsWeightIsThatOfMuJoCosArm) {
  const auto setup = smooth(setup_of({}));
  const auto chain = arm::Chain::make(setup.leader.arm.chain).value();
  auto plant = arm_plants::ArmPlant::make(setup.leader.arm, setup.leader.start).value();
  arm::JointVector off = setup.leader.start;
  off[1] += 0.01;
  auto moved = arm_plants::ArmPlant::make(setup.leader.arm, off).value();
  const Eigen::VectorXd changes = moved.bearing_torque() - plant.bearing_torque();
  EXPECT_NEAR((changes - 0.01 * weight_slope(chain, setup.leader.start).col(1)).norm() / changes.norm(), 0.0, 0.02);
}

}  // namespace
}  // namespace tactus::arm_stability
