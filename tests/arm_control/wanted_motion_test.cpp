// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/wanted_motion.hpp>

#include <cmath>
#include <complex>
#include <numbers>

#include "tests/arm_identification/kdl_arm.hpp"
#include "tests/arm_plants/openarm.hpp"
#include <kdl/chainidsolver_recursive_newton_euler.hpp>

namespace tactus::arm_control::wanted_motion_test {
namespace {

constexpr Seconds tick{1e-3};
constexpr double friction_velocity_rad_per_s = 0.3;

arm::Chain::Params with_effort_limits(arm::Chain::Params params) {
  for (arm::JointParams& joint : params.joints) joint.limits.effort_N_m = 15.0;
  return params;
}

/// A follower of seven joints, and the torque of a wanted motion there.
struct Follower {
  arm::Chain::Params params = with_effort_limits(arm_identification::open_arm());
  arm::Chain chain = *arm::Chain::make(params);
  WantedMotion made =
      *WantedMotion::make({.cutoff_Hz = 6.0}, friction_velocity_rad_per_s, {params, chain, {0.0, 0.0, 0.15}}, tick);

  JointVector step(const JointVector& wanted, const JointVector& velocity, double external_N_m) {
    const ArmReading reading{.position = arm_plants::bent(), .velocity = velocity, .torque = JointVector::Zero(7)};
    return made.step(reading, wanted, JointVector::Unit(7, 1) * external_N_m);
  }
};

const JointVector still = JointVector::Zero(7);
const JointVector steady = JointVector::Constant(7, 0.2);

/// Torque in free motion that has lasted.
JointVector in_free_motion(Follower& follower) {
  JointVector torque;
  for (int k = 0; k < 2000; ++k) torque = follower.step(steady, still, 0.0);
  return torque;
}

double share_left(Follower& follower, const JointVector& free, const JointVector& velocity, double external_N_m,
                  int ticks) {
  JointVector torque;
  for (int k = 0; k < ticks; ++k) torque = follower.step(steady, velocity, external_N_m);
  return torque.norm() / free.norm();
}

TEST(WantedMotion, OfASlowSineItIsWhatKdlsInverseDynamicsAndTheJointsFrictionTake) {
  Follower follower;
  KDL::Chain kdl = arm_identification::kdl_chain(follower.params);
  KDL::ChainIdSolver_RNE weightless(kdl, KDL::Vector::Zero());
  const double w = 2.0 * std::numbers::pi * 0.8;
  const double corner = 2.0 * std::numbers::pi * 6.0;
  const JointVector amplitude = JointVector::LinSpaced(7, 0.4, -0.5);
  // The closed form of a Butterworth low-pass of second order.
  const std::complex<double> s(0.0, w);
  const std::complex<double> passed = corner * corner / (s * s + std::numbers::sqrt2 * corner * s + corner * corner);
  double worst_N_m = 0.0, largest_N_m = 0.0;
  for (int k = 0; k < 5000; ++k) {
    const double t = k * tick.value;
    const JointVector torque = follower.step(amplitude * std::sin(w * t), still, 0.0);
    if (k < 2500) continue;
    const JointVector velocity = amplitude * (passed * std::exp(s * t)).imag();
    const JointVector acceleration = amplitude * (s * passed * std::exp(s * t)).imag();
    KDL::JntArray q(7), rest(7), qdd(7), wanted(7);
    q.data = arm_plants::bent();
    qdd.data = acceleration;
    ASSERT_EQ(weightless.CartToJnt(q, rest, qdd, KDL::Wrenches(kdl.getNrOfSegments(), KDL::Wrench::Zero()), wanted), 0);
    for (int i = 0; i < 7; ++i) {
      const arm::JointParams& joint = follower.params.joints[static_cast<std::size_t>(i)];
      const double v = velocity[i];
      const double due_N_m = wanted(static_cast<unsigned>(i)) + joint.friction.viscous_N_m_s_per_rad * v +
                             joint.friction.coulomb_N_m * std::tanh(v / friction_velocity_rad_per_s);
      worst_N_m = std::max(worst_N_m, std::fabs(torque[i] - due_N_m));
      largest_N_m = std::max(largest_N_m, std::fabs(due_N_m));
    }
  }
  EXPECT_GT(largest_N_m, 0.5);
  EXPECT_LT(worst_N_m, 0.01 * largest_N_m) << "of implicit Euler at 1 kHz";
}

TEST(WantedMotion, ContactTakesItAwayAndFrictionDoesNot) {
  Follower follower;
  const double coulomb_N_m = follower.params.joints[1].friction.coulomb_N_m;
  const JointVector free = in_free_motion(follower);
  ASSERT_GT(free.norm(), 0.1);
  EXPECT_DOUBLE_EQ(share_left(follower, free, still, 1.9 * coulomb_N_m, 500), 1.0);
  // Behind 10 Hz four times the friction is beyond twice of it after 11 ms, and within 3 ms more it is gone.
  EXPECT_DOUBLE_EQ(share_left(follower, free, still, 0.0, 500), 1.0);
  EXPECT_DOUBLE_EQ(share_left(follower, free, still, 4.0 * coulomb_N_m, 10), 1.0);
  EXPECT_DOUBLE_EQ(share_left(follower, free, still, 4.0 * coulomb_N_m, 6), 0.0);
}

TEST(WantedMotion, ItComesBackAsTheToolLeavesWhatItTouched) {
  Follower follower;
  const JointVector free = in_free_motion(follower);
  ASSERT_DOUBLE_EQ(share_left(follower, free, still, 2.0, 200), 0.0);
  EXPECT_LT(share_left(follower, free, still, 0.0, 1000), 1e-9) << "it has not moved";
  const ToolJacobian tool = follower.chain.jacobian(arm_plants::bent(), 6, {0.0, 0.0, 0.15}).topRows<3>();
  const JointVector velocity = JointVector::Unit(7, 3) * (0.3 / tool.col(3).norm());
  EXPECT_NEAR(share_left(follower, free, velocity, 0.0, 500), 1.0 - std::exp(-1.0), 1e-3) << "0.15 m at 0.3 m/s";
}

TEST(WantedMotion, AJointWithoutFrictionIsNotInContactForANoise) {
  Follower follower;
  for (arm::JointParams& joint : follower.params.joints) joint.friction = {};
  follower.made = *WantedMotion::make({.cutoff_Hz = 6.0}, friction_velocity_rad_per_s,
                                      {follower.params, follower.chain, {0.0, 0.0, 0.15}}, tick);
  JointVector torque;
  for (int k = 0; k < 30; ++k) torque = follower.step(steady, still, 0.14);
  EXPECT_GT(torque.norm(), 0.1);
  for (int k = 0; k < 300; ++k) torque = follower.step(steady, still, 0.2);
  EXPECT_EQ(torque.norm(), 0.0);
}

}  // namespace
}  // namespace tactus::arm_control::wanted_motion_test
