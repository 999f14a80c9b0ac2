// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/site_tare.hpp>
#include <tactus/kernel/arm_control/tare.hpp>
#include <tactus/kernel/arm_control/torque_bias.hpp>
#include <tactus/kernel/arm_control/washed_damping.hpp>
#include <tactus/simulation/arm_plants/arm_plant.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>

#include "tests/arm_plants/openarm.hpp"
#include <gtest/gtest.h>

namespace tactus::arm_control::tare_test {
namespace {

constexpr Seconds tick{1e-3};

TEST(Tare, FindsWhatAPayloadAndTorqueConstantsAddAlthoughFrictionCouldHideIt) {
  arm_plants::ArmPlant::Params arm = arm_plants::openarm_class();
  const auto file = urdf::read(std::string(TACTUS_EXPERIMENT_FOLDER) + "/arms/openarm-class.urdf");
  for (std::size_t i = 0; i < 7; ++i) arm.chain.joints[i].friction = file->params.joints[i].friction;
  ASSERT_GT(arm.chain.joints[0].friction.coulomb_N_m, 0.3);
  const arm::Chain::Params believed = arm.chain;
  arm::Body& last = arm.chain.joints[arm.chain.joints.size() - 1].body;
  last = arm::body_of(arm::linear_parameters(last) +
                      arm::linear_parameters(arm::Body{.mass_kg = 0.3, .centre_z_m = 0.15}));
  const double scale = 1.05;
  for (arm::MotorParams& motor : arm.motors) motor.torque_scale = scale;
  const JointVector start = arm_plants::bent();
  auto plant = *arm_plants::ArmPlant::make(arm, start);
  const arm::Chain model = *arm::Chain::make(believed);
  JointVector stiffness(7), damping(7);
  stiffness << 240, 240, 240, 240, 24, 31, 25;
  damping << 3, 3, 3, 3, 0.2, 0.2, 0.2;
  Tare tare = *Tare::make({.cycles = 2}, model, {stiffness, damping}, tick);
  const auto steps = static_cast<int>(std::lround(tick.value / arm.step_s));
  int ticks = 0;
  for (; !tare.done(); ++ticks) {
    plant.write(tare.step(plant.read()));
    for (int i = 0; i < steps; ++i) plant.step({});
  }
  EXPECT_EQ(ticks, 3000);
  // MuJoCo's own torque that bears the true arm there, in the drives' count.
  const JointVector needed = arm_plants::ArmPlant::make(arm, start)->bearing_torque() / scale;
  const JointVector lacking = needed - model.gravity_torque(start);
  EXPECT_GT(lacking.cwiseAbs().maxCoeff(), 0.5);
  for (Eigen::Index i = 0; i < lacking.size(); ++i) EXPECT_NEAR(tare.lacking_N_m()[i], lacking[i], 0.05) << i;
}

TEST(Tare, RefusesWhatIsOutOfBounds) {
  const arm::Chain model = *arm::Chain::make(arm_plants::openarm_class().chain);
  const JointVector none = JointVector::Zero(7);
  EXPECT_EQ(Tare::make({.cycles = 1, .amplitude_rad = 0.0}, model, {none, none}, tick).error().parameter,
            "amplitude_rad");
}

/// A tare of an arm whose joints follow exactly, and whose drives report gravity and `more`.
SiteTare site_tare(const arm::Chain& model) {
  const JointVector none = JointVector::Zero(7);
  return *SiteTare::make({}, arm_plants::openarm_class().chain, model, {none, none}, none, tick);
}
void run(SiteTare& tare, const arm::Chain& model, const JointVector& more, double follows, int ticks) {
  const JointVector at = arm_plants::bent();
  double away_rad = 0.0;
  for (int i = 0; i < ticks; ++i) {
    const JointVector position = at + JointVector::Constant(7, follows * away_rad);
    if (tare.moves()) {
      away_rad = tare.away_rad(
          {.position = position, .velocity = JointVector::Zero(7), .torque = model.gravity_torque(position) + more});
    }
    tare.lacking_N_m();
  }
}

TEST(SiteTare, BringsInWhatItFoundWithoutAStepAndKeepsItWhenStopped) {
  const arm::Chain model = *arm::Chain::make(arm_plants::openarm_class().chain);
  JointVector more = JointVector::Zero(7);
  more[1] = 0.8;
  SiteTare tare = site_tare(model);
  EXPECT_EQ(tare.report().state, control::TareState::none);
  tare.begin();
  run(tare, model, more, 1.0, 3000);
  EXPECT_EQ(tare.report().state, control::TareState::under_way) << "it comes in within a cycle";
  double before = tare.lacking_N_m()[1];
  EXPECT_LT(before, 0.01);
  for (int i = 0; i < 1000; ++i) {
    const double now = tare.lacking_N_m()[1];
    EXPECT_LE(now - before, 0.8e-3 * 1.01);
    before = now;
  }
  EXPECT_EQ(tare.report().state, control::TareState::done);
  EXPECT_NEAR(before, 0.8, 1e-9);
  tare.begin();
  run(tare, model, -more, 1.0, 1500);
  tare.stop();
  EXPECT_EQ(tare.report().state, control::TareState::stopped);
  EXPECT_NEAR(tare.lacking_N_m()[1], 0.8, 1e-9);
  EXPECT_NEAR(tare.found_N_m()[1], 0.8, 1e-9);
}

TEST(SiteTare, RefusesAJointThatDoesNotFollowAndAWeightThatNobodyCarries) {
  const arm::Chain model = *arm::Chain::make(arm_plants::openarm_class().chain);
  JointVector more = JointVector::Zero(7);
  SiteTare blocked = site_tare(model);
  blocked.begin();
  run(blocked, model, more, 0.3, 3000);
  EXPECT_EQ(blocked.report().state, control::TareState::still);
  EXPECT_NEAR(blocked.report().value, 0.3, 0.02);
  EXPECT_EQ(blocked.lacking_N_m(), JointVector::Zero(7).eval());
  more[3] = -0.5 * arm_plants::openarm_class().chain.joints[3].limits.effort_N_m;
  SiteTare heavy = site_tare(model);
  heavy.begin();
  run(heavy, model, more, 1.0, 3000);
  EXPECT_EQ(heavy.report().state, control::TareState::too_large);
  EXPECT_EQ(heavy.report().joint, 3U);
  EXPECT_EQ(heavy.lacking_N_m(), JointVector::Zero(7).eval());
}

/// Three joints that move the tool along x, y and z.
struct Dampers {
  ToolJacobian tool = ToolJacobian::Identity(3, 3);
  JointMatrix damping = JointVector(arm::Vector3(10.0, 20.0, 30.0)).asDiagonal();
  JointVector velocity = arm::Vector3(0.1, 0.1, 0.1);
  JointVector none = JointVector::Zero(3);
};

TEST(WashedDamping, GivesAllOfTheDampersBackToSlowMotionAndNothingToFastOne) {
  Dampers at;
  WashedDamping washed(2.0, JointVector::Constant(3, 10.0), tick);
  JointVector back;
  for (int k = 0; k < 2000; ++k) back = washed.step(at.tool, at.damping, at.velocity, at.none);
  EXPECT_LT((back - at.damping * at.velocity).norm(), 1e-6);
  WashedDamping fast(2.0, JointVector::Constant(3, 10.0), tick);
  double most = 0.0;
  for (int k = 0; k < 2000; ++k) {
    const double v = 0.1 * std::sin(2.0 * std::numbers::pi * 40.0 * 1e-3 * k);
    back = fast.step(at.tool, at.damping, JointVector::Constant(3, v), at.none);
    if (k > 1000) most = std::max(most, back[2]);
  }
  EXPECT_NEAR(most, 30.0 * 0.1 / std::hypot(1.0, 20.0), 0.02) << "a low-pass of first order";
}

TEST(WashedDamping, InContactTheDampersActAlongTheNormalAlone) {
  Dampers at;
  WashedDamping washed(2.0, JointVector::Constant(3, 10.0), tick);
  JointVector touch = arm::Vector3(0.0, 0.0, 5.0);
  JointVector back;
  for (int k = 0; k < 2000; ++k) back = washed.step(at.tool, at.damping, at.velocity, touch);
  EXPECT_NEAR(back[0], 1.0, 1e-3);
  EXPECT_NEAR(back[1], 2.0, 1e-3);
  EXPECT_NEAR(back[2], 0.0, 1e-3) << "what resists is not given back";
  EXPECT_EQ(washed.contact(), 1.0);
  for (int k = 0; k < 3000; ++k) back = washed.step(at.tool, at.damping, at.velocity, at.none);
  EXPECT_NEAR(back[2], 3.0, 1e-3) << "the contact has ended";
}

arm::Chain::Params one_joint() {
  arm::Chain::Params arm = arm_plants::openarm_class().chain;
  Joints<arm::JointParams> first(1);
  first[0] = arm.joints[0];
  first[0].limits.effort_N_m = 40.0;
  first[0].friction.coulomb_N_m = 0.3;
  arm.joints = first;
  return arm;
}

TEST(TorqueBias, IsFollowedByTravelAndNeverByTime) {
  TorqueBias bias(0.3, one_joint(), tick);
  const JointVector estimate = JointVector::Constant(1, 0.2);
  for (int k = 0; k < 60000; ++k) bias.step(estimate, 0.0);
  EXPECT_EQ(bias.step(estimate, 0.0)[0], 0.0) << "a minute at rest";
  for (int k = 0; k < 3000; ++k) bias.step(estimate, 0.1);
  EXPECT_NEAR(bias.step(estimate, 0.0)[0], 0.2 * (1.0 - std::exp(-1.0)), 1e-3) << "0.3 m";
}

TEST(TorqueBias, KeepsWhatItIsInContact) {
  TorqueBias bias(0.3, one_joint(), tick);
  for (int k = 0; k < 3000; ++k) bias.step(JointVector::Constant(1, 1.0), 0.1);
  EXPECT_EQ(bias.step(JointVector::Constant(1, 1.0), 0.1)[0], 0.0);
}

}  // namespace
}  // namespace tactus::arm_control::tare_test
