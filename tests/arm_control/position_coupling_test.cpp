// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/position_coupling.hpp>
#include <tactus/simulation/arm_plants/arm_plant.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::arm_control {
namespace {

JointVector one(double value) { return JointVector::Constant(1, value); }
JointMatrix only(double value) { return JointMatrix::Constant(1, 1, value); }

TEST(PositionCoupling, OfOneJointHasTheMarginOfTheClosedForm) {
  for (const double inertia : {0.0167, 0.05, 0.27}) {
    for (const double share : {1.0, 0.7}) {
      const auto closed = delay_limit_of_joint(240.0, 3.0, inertia, share);
      const CoupledArm arm{only(inertia), only(0.0), only(0.0)};
      const auto searched = delay_limit(arm, arm, {one(240.0), one(3.0), share});
      ASSERT_TRUE(closed && searched) << inertia;
      EXPECT_NEAR(searched->delay_s, closed->delay_s, 1e-6) << inertia << " " << share;
      EXPECT_NEAR(searched->frequency_Hz, closed->frequency_Hz, 1e-4);
    }
    const double w = std::sqrt(480.0 / inertia);
    EXPECT_NEAR(delay_limit_of_joint(240.0, 3.0, inertia)->delay_s, 2.0 / w * std::atan(w * 3.0 / 240.0), 1e-12);
  }
}

TEST(PositionCoupling, ThatDampsTowardsRestBearsEveryDelayWhereDampingSquaredExceedsTwiceStiffnessTimesInertia) {
  EXPECT_FALSE(delay_limit_of_joint(240.0, 3.0, 0.0167, 0.0)) << "9 > 8.0";
  EXPECT_TRUE(delay_limit_of_joint(240.0, 3.0, 0.0200, 0.0)) << "9 < 9.6";
  const CoupledArm light{only(0.0167), only(0.0), only(0.0)}, heavy{only(0.02), only(0.0), only(0.0)};
  EXPECT_FALSE(delay_limit(light, light, {one(240.0), one(3.0), 0.0}));
  EXPECT_TRUE(delay_limit(heavy, heavy, {one(240.0), one(3.0), 0.0}));
}

/// Two turntables in MuJoCo, each drive with the other's state of `delay_steps` ago: by how much what they are apart
/// grows from the first half of three seconds to the second.
double growth(double inertia, double delay_s, double damping, double share) {
  constexpr double step_s = 1e-4;
  arm_plants::ArmPlant::Params params{.chain = {.joints = Joints<arm::JointParams>(1), .gravity = {}},
                                      .motors = Joints<arm_plants::MotorParams>(1)};
  params.chain.joints[0].body = {.mass_kg = 1.0, .xx_kg_m2 = 0.01, .yy_kg_m2 = 0.01, .zz_kg_m2 = 0.01};
  params.chain.joints[0].drive.armature_kg_m2 = inertia - 0.01;
  auto first = *arm_plants::ArmPlant::make(params, one(0.01));
  auto second = *arm_plants::ArmPlant::make(params, one(-0.01));
  // One step passes between reading and acting.
  const auto late = static_cast<std::size_t>(std::lround(delay_s / step_s));
  std::vector<arm::ArmReading> of_first(late + 1, first.read()), of_second(late + 1, second.read());
  double before = 0.0, after = 0.0;
  constexpr int steps = 30000;
  for (int k = 0; k < steps; ++k) {
    const std::size_t now = static_cast<std::size_t>(k) % (late + 1), old = (now + 1) % (late + 1);
    of_first[now] = first.read();
    of_second[now] = second.read();
    const auto told = [&](const arm::ArmReading& other) {
      return arm::ArmCommand{other.position, share * other.velocity, one(240.0), one(damping), one(0.0)};
    };
    first.write(told(of_second[old]));
    second.write(told(of_first[old]));
    first.step({});
    second.step({});
    const double apart = std::fabs(first.read().position[0] - second.read().position[0]);
    if (k >= steps / 3) (k < 2 * steps / 3 ? before : after) = std::max(k < 2 * steps / 3 ? before : after, apart);
  }
  return after / before;
}

TEST(PositionCoupling, OfSimulatedArmsGrowsAboveTheLimitAndDiesOutBelow) {
  for (const double inertia : {0.0167, 0.1, 0.27}) {
    const double limit_s = delay_limit_of_joint(240.0, 3.0, inertia)->delay_s;
    EXPECT_LT(growth(inertia, 0.95 * limit_s, 3.0, 1.0), 1.0) << inertia;
    EXPECT_GT(growth(inertia, 1.05 * limit_s, 3.0, 1.0), 1.0) << inertia;
  }
  EXPECT_LT(growth(0.0167, 0.05, 3.0, 0.0), 1.0) << "damped towards rest it bears any delay";
  EXPECT_GT(growth(0.0167, 0.05, 3.0, 1.0), 1.0);
}

TEST(PositionCoupling, OfSeveralJointsOscillatesInTheOneOfTheLeastLimit) {
  JointMatrix inertia(2, 2);
  inertia << 0.27, 0.0, 0.0, 0.005;
  const JointMatrix none = JointMatrix::Zero(2, 2);
  const CoupledArm arm{inertia, none, none};
  PositionCoupling coupling{JointVector(2), JointVector(2), 1.0};
  coupling.stiffness << 240.0, 31.0;
  coupling.damping << 3.0, 0.2;
  const auto found = delay_limit(arm, arm, coupling);
  const auto wrist = delay_limit_of_joint(31.0, 0.2, 0.005);
  ASSERT_TRUE(found && wrist);
  EXPECT_EQ(found->joint, 1);
  EXPECT_NEAR(found->delay_s, wrist->delay_s, 1e-6);
  EXPECT_FALSE(delay_limit(arm, arm, coupling, 0.5 * wrist->delay_s));
}

TEST(PositionCoupling, WithAWrongVelocityScaleGrowsByDampingAndNotByStiffness) {
  const double inertia = 0.27;
  const CoupledArm free{only(inertia), only(0.0), only(0.0)};
  const auto growth = [&](double stiffness, double damping, double share, double scale) {
    return growth_per_s(free, free, {one(stiffness), one(damping), share}, one(scale));
  };
  EXPECT_NEAR(growth(240.0, 3.0, 1.0, 1.0), 0.0, 1e-6) << "they glide together";
  for (const double scale : {0.5, 2.0, 4.5}) {
    // The positive root of J² s³ + 2 J Kd s² + 2 J Kp s + Kp Kd (2 − scale − 1/scale).
    const double s = growth(240.0, 3.0, 1.0, scale), asked = scale + 1.0 / scale;
    ASSERT_GT(s, 0.0);
    const double terms = 2.0 * inertia * 240.0 * s;
    EXPECT_NEAR(inertia * inertia * s * s * s + 2.0 * inertia * 3.0 * s * s + terms, 240.0 * 3.0 * (asked - 2.0),
                1e-6 * terms);
    EXPECT_GT(growth(240.0, 5.0, 1.0, scale), s) << "more damping drives them more";
    EXPECT_NEAR(growth(60.0, 3.0, 1.0, scale), s, 0.5 * s) << "less stiffness hardly helps";
    EXPECT_GT(growth(240.0, 3.0, 1.01 * 2.0 / asked, scale), 0.0);
    EXPECT_NEAR(growth(240.0, 3.0, 0.99 * 2.0 / asked, scale), 0.0, 1e-9) << "only where they stand together";
  }
}

TEST(PositionCoupling, WithAWrongVelocityScaleIsCalmedByAHandThatDampsMoreThanItDrives) {
  const double driven = 3.0 * (2.0 + 0.5 - 2.0);  // N m s/rad at scale 2
  const CoupledArm free{only(0.27), only(0.0), only(0.0)};
  const auto held = [&](double damping) { return CoupledArm{only(0.27), only(damping), only(20.0)}; };
  const PositionCoupling coupling{one(240.0), one(3.0), 1.0};
  EXPECT_LT(growth_per_s(held(1.3 * driven), free, coupling, one(2.0)), 0.0);
  EXPECT_GT(growth_per_s(held(0.7 * driven), free, coupling, one(2.0)), 0.0);
}

TEST(PositionCoupling, HeldByAHandBearsMoreDelayThanAlone) {
  const CoupledArm alone{only(0.27), only(0.0), only(0.0)}, held{only(0.35), only(6.0), only(80.0)};
  const PositionCoupling coupling{one(240.0), one(3.0), 1.0};
  EXPECT_GT(delay_limit(held, alone, coupling)->delay_s, delay_limit(alone, alone, coupling)->delay_s);
}

}  // namespace
}  // namespace tactus::arm_control
