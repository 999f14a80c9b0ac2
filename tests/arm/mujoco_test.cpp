// SPDX-License-Identifier: Apache-2.0
#include "tests/arm/mujoco_arm.hpp"
#include "tests/arm/random_arm.hpp"
#include <gtest/gtest.h>

namespace tactus::arm {
namespace {

TEST(AgainstMuJoCo, MassMatrixAndInverseDynamicsAgree) {
  constexpr double to_its_rounding = 1e-7;
  for (unsigned seed = 0; seed < 60; ++seed) {
    RandomArm random(seed);
    const Chain::Params params = random.arm(1 + seed % 8);
    const Chain chain = *Chain::make(params);
    const int joints = chain.joints();
    MuJoCoArm foreign(params);
    ASSERT_TRUE(foreign) << foreign.complaint();
    const JointVector q = random.vector(joints, 3.0);
    const JointVector v = random.vector(joints, 4.0);
    const JointVector a = random.vector(joints, 30.0);
    EXPECT_LT(apart(Eigen::MatrixXd(chain.mass_matrix(q)), foreign.mass_matrix(q)), to_its_rounding) << seed;
    EXPECT_LT(apart(Eigen::VectorXd(chain.inverse_dynamics(q, v, a)), foreign.inverse_dynamics(q, v, a)),
              to_its_rounding)
        << seed;
    EXPECT_LT(apart(Eigen::VectorXd(chain.gravity_torque(q)),
                    foreign.inverse_dynamics(q, JointVector::Zero(joints), JointVector::Zero(joints))),
              to_its_rounding)
        << seed;
  }
}

}  // namespace
}  // namespace tactus::arm
