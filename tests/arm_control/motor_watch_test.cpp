// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/motor_watch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>

#include "tests/allocation_counter.hpp"
#include "tests/arm_plants/openarm.hpp"

/// The arm that is watched is MuJoCo's, with friction and the steps in which its drives report.
namespace tactus::arm_control::motor_watch_test {
namespace {

using arm::ArmCommand;

constexpr double tick_s = 1e-3;
constexpr Eigen::Index joints = 7;
/// As experiments/arms/limits.toml has it.
const MotorWatch::Params usual{.deviations = 3.0};

arm_plants::ArmPlant::Params true_arm() {
  arm_plants::ArmPlant::Params arm = arm_plants::openarm_class();
  arm.chain = urdf::read(std::string(TACTUS_EXPERIMENT_FOLDER) + "/arms/openarm-class.urdf").value().params;
  constexpr double armature_kg_m2[] = {0.0167, 0.0167, 0.029, 0.029, 0.0018, 0.0018, 0.0018};
  for (std::size_t i = 0; i < joints; ++i) {
    arm.chain.joints[i].drive.armature_kg_m2 = armature_kg_m2[i];
    arm.motors[i] = {.position_step_rad = 0.0003815,
                     .velocity_step_rad_per_s = i < 2   ? 0.022
                                                : i < 4 ? 0.0049
                                                        : 0.0147};
  }
  return arm;
}
arm::Chain::Params nearly_right(std::mt19937& engine) {
  std::uniform_real_distribution<double> share(0.8, 1.2);
  arm::Chain::Params model = true_arm().chain;
  for (auto& joint : model.joints) {
    for (double* of : {&joint.body.mass_kg, &joint.body.centre_x_m, &joint.body.centre_y_m, &joint.body.centre_z_m}) {
      *of *= share(engine);
    }
  }
  return model;
}
JointVector vector_of(const std::array<double, joints>& each) {
  return Eigen::Map<const Eigen::VectorXd>(each.data(), joints);
}

/// A follower: its drives hold it on a path by their own law, and its model carries it. One motor may be wrong.
struct Rig {
  arm_plants::ArmPlant arm;
  arm::Chain model;
  MotorWatch watch;
  JointVector stiffness = vector_of({144, 144, 144, 144, 14.4, 18.6, 15}),
              damping = vector_of({3, 3, 3, 3, 0.2, 0.2, 0.2});
  double reach_rad = 0.1;
  Eigen::Index wrong = 0;
  double given_share = 1.0;    ///< of what that motor's drive believes
  bool reports_truth = false;  ///< it reports what it gives
  bool powered = true;
  JointVector commanded = JointVector::Zero(joints);
  ArmCommand told = ArmCommand::of_torque(JointVector::Zero(joints));
  int ticks = 0;

  explicit Rig(const arm::Chain::Params& believed, const MotorWatch::Params& params = usual)
      : arm(*arm_plants::ArmPlant::make(true_arm(), arm_plants::bent())),
        model(*arm::Chain::make(believed)),
        watch(*MotorWatch::make(params, believed, true_arm().tool_m, Seconds{tick_s})) {}

  [[nodiscard]] double now_s() const { return tick_s * ticks; }
  const MotorWatch::Found& tick(const arm_plants::ToolForce& force = {}) {
    ArmReading reading = arm.read();
    if (!reports_truth && given_share != 0.0) reading.torque[wrong] /= given_share;
    commanded = told.torque + told.stiffness.cwiseProduct(told.position - reading.position) +
                told.damping.cwiseProduct(told.velocity - reading.velocity);
    if (!reports_truth && given_share == 0.0) reading.torque[wrong] = commanded[wrong];
    const auto& found = watch.step({.reading = reading, .commanded = commanded, .powered = powered});
    const double swing = 2.0 * std::numbers::pi * 0.7;
    told = {
        .position = arm_plants::bent() + JointVector::Constant(joints, reach_rad * (1.0 - std::cos(swing * now_s()))),
        .velocity = JointVector::Constant(joints, reach_rad * swing * std::sin(swing * now_s())),
        .stiffness = stiffness,
        .damping = damping,
        .torque = model.gravity_torque(reading.position)};
    ArmCommand given = told;
    for (JointVector* of : {&given.stiffness, &given.damping, &given.torque}) (*of)[wrong] *= given_share;
    arm.write(given);
    for (int i = 0; i < 5; ++i) arm.step(force);
    ++ticks;
    return found;
  }
};

TEST(MotorWatch, FindsAMotorThatGivesAnotherTorqueThanItsDriveReportsBeforeItsJointIsFast) {
  for (Eigen::Index joint = 0; joint < joints; ++joint) {
    for (const double share : {-1.0, 0.0, 0.3, 2.5}) {
      Rig rig(true_arm().chain);
      while (rig.now_s() < 1.0) ASSERT_EQ(rig.tick().what, MotorFinding::none) << rig.now_s();
      ASSERT_TRUE(rig.watch.settled());
      rig.wrong = joint;
      rig.given_share = share;
      double fastest = 0.0;
      while (rig.now_s() < 2.5 && rig.watch.found().what == MotorFinding::none) {
        rig.tick();
        fastest = std::max(fastest, rig.arm.link_velocity().cwiseAbs().maxCoeff());
      }
      const std::string what = std::to_string(joint + 1) + " x " + std::to_string(share);
      // The path itself takes 1 rad/s. A wrist of 0.003 kg m² doubles its speed in 8 ms.
      EXPECT_LT(fastest, joint < 4 ? 2.5 : 7.0) << what;
      if (share < 0.0) {
        EXPECT_EQ(rig.watch.found().what, MotorFinding::acts_otherwise) << what;
        EXPECT_EQ(rig.watch.found().joint, static_cast<std::size_t>(joint)) << what;
      }
      printf("joint %s: %s at joint %zu after %.3f s, %.2f N m, %.1f deviations, fastest %.2f rad/s\n", what.c_str(),
             name_of(rig.watch.found().what), rig.watch.found().joint + 1, rig.now_s() - 1.0,
             rig.watch.found().wrong_N_m, rig.watch.found().deviations, fastest);
    }
  }
}

TEST(MotorWatch, FindsADriveThatReportsAnotherTorqueThanItWasCommanded) {
  Rig rig(true_arm().chain);
  while (rig.now_s() < 1.0) rig.tick();
  rig.wrong = 3;
  rig.given_share = 0.0;
  rig.reports_truth = true;
  while (rig.now_s() < 1.5 && rig.watch.found().what == MotorFinding::none) rig.tick();
  EXPECT_EQ(rig.watch.found().what, MotorFinding::reports_otherwise);
  EXPECT_EQ(rig.watch.found().joint, 3U);
  EXPECT_LT(std::fabs(rig.watch.found().wrong_N_m + rig.commanded[3]), 0.2);
}

/// Contacts of up to 30 N and 2 N m at the tool, models whose masses and centres are each up to a fifth wrong.
TEST(MotorWatch, FindsNothingWhereMotorsAreRightTheModelIsNearlySoAndTheToolIsPushed) {
  std::mt19937 engine(7);
  std::normal_distribution<double> normal;
  double most = 0.0;
  for (int number = 0; number < 12; ++number) {
    Rig rig(nearly_right(engine));
    const auto direction = [&] { return arm::Vector3(normal(engine), normal(engine), normal(engine)).normalized(); };
    const arm::Vector3 force = 30.0 * direction(), moment = 2.0 * direction();
    const double pushes_per_s = 0.5 + 0.3 * number;
    while (rig.now_s() < 4.0) {
      const double push = std::max(0.0, std::sin(2.0 * std::numbers::pi * pushes_per_s * rig.now_s()));
      ASSERT_EQ(rig.tick({.force_N = push * force, .moment_N_m = push * moment}).what, MotorFinding::none)
          << number << ", joint " << rig.watch.found().joint + 1 << ", " << rig.watch.found().wrong_N_m << " N m after "
          << rig.now_s() << " s";
      most = std::max(most, rig.watch.settled() ? rig.watch.largest_deviations() : 0.0);
    }
    EXPECT_TRUE(rig.watch.settled()) << number;
  }
  printf("at most %.2f deviations\n", most);
}

TEST(MotorWatch, JudgesNothingBeforeTheArmIsCarriedOrWithoutPower) {
  Rig rig(true_arm().chain);
  rig.wrong = 1;
  rig.given_share = -1.0;
  rig.powered = false;
  for (int i = 0; i < 300; ++i) EXPECT_EQ(rig.tick().what, MotorFinding::none);
  EXPECT_FALSE(rig.watch.settled());
}

TEST(MotorWatch, WhatWasFoundStaysUntilTheArmHasNoPower) {
  Rig rig(true_arm().chain);
  while (rig.now_s() < 1.0) rig.tick();
  rig.wrong = 1;
  rig.given_share = -1.0;
  while (rig.now_s() < 1.5) rig.tick();
  ASSERT_EQ(rig.watch.found().what, MotorFinding::acts_otherwise);
  rig.given_share = 1.0;
  rig.tick();
  EXPECT_EQ(rig.watch.found().what, MotorFinding::acts_otherwise);
  rig.powered = false;
  EXPECT_EQ(rig.tick().what, MotorFinding::none);
}

TEST(MotorWatch, OfNoDeviationsItIsOffAndATickAllocatesNothing) {
  Rig off(true_arm().chain, {});
  off.wrong = 1;
  for (int i = 0; i < 500; ++i) {
    if (i == 200) off.given_share = -1.0;
    EXPECT_EQ(off.tick().what, MotorFinding::none);
  }
  Rig rig(true_arm().chain);
  const ArmReading reading = rig.arm.read();
  const std::uint64_t before = laws::own_allocation_count();
  for (int i = 0; i < 200; ++i) rig.watch.step({.reading = reading, .commanded = reading.torque, .powered = true});
  EXPECT_EQ(laws::own_allocation_count(), before);
}

TEST(MotorWatch, RefusesACutoffThatTheTickCannotHave) {
  const auto made =
      MotorWatch::make({.deviations = 4.0, .cutoff_Hz = 600.0}, true_arm().chain, {0, 0, 0}, Seconds{tick_s});
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().parameter, "cutoff_Hz");
}

}  // namespace
}  // namespace tactus::arm_control::motor_watch_test
