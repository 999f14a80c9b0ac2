// SPDX-License-Identifier: Apache-2.0
#include "tests/arm/random_arm.hpp"
#include <gtest/gtest.h>
#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <kdl/chainjnttojacsolver.hpp>

namespace tactus::arm {
namespace {

constexpr double agreed = 1e-9;
constexpr unsigned arms = 200;

KDL::Chain kdl(const Chain::Params& params) {
  KDL::Chain chain;
  for (const JointParams& joint : params.joints) {
    const KDL::Frame at(KDL::Rotation::RPY(joint.origin.roll_rad, joint.origin.pitch_rad, joint.origin.yaw_rad),
                        KDL::Vector(joint.origin.x_m, joint.origin.y_m, joint.origin.z_m));
    const KDL::Vector axis = at.M * KDL::Vector(joint.axis.x, joint.axis.y, joint.axis.z);
    const KDL::Joint made(at.p, axis, joint.kind == JointKind::prismatic ? KDL::Joint::TransAxis : KDL::Joint::RotAxis,
                          1.0, 0.0, joint.drive.reflected_kg_m2());
    const Body& body = joint.body;
    chain.addSegment(
        KDL::Segment(made, at,
                     KDL::RigidBodyInertia(body.mass_kg, KDL::Vector(body.centre_x_m, body.centre_y_m, body.centre_z_m),
                                           KDL::RotationalInertia(body.xx_kg_m2, body.yy_kg_m2, body.zz_kg_m2,
                                                                  body.xy_kg_m2, body.xz_kg_m2, body.yz_kg_m2))));
  }
  return chain;
}

KDL::JntArray kdl(const JointVector& v) {
  KDL::JntArray array(static_cast<unsigned>(v.size()));
  for (int i = 0; i < v.size(); ++i) array(static_cast<unsigned>(i)) = v[i];
  return array;
}

struct Case {
  Chain::Params params;
  Chain chain;
  KDL::Chain foreign;
  JointVector q, v, a;
};

/// Arms of one to eight joints in turn.
Case random_case(unsigned seed) {
  RandomArm random(seed);
  const std::size_t joints = 1 + seed % 8;
  const Chain::Params params = random.arm(joints);
  const int count = static_cast<int>(joints);
  return {params,
          *Chain::make(params),
          kdl(params),
          random.vector(count, 3.0),
          random.vector(count, 4.0),
          random.vector(count, 30.0)};
}

TEST(AgainstKdl, TheTipStandsWhereKdlPutsItAndMovesAsKdlSays) {
  for (unsigned seed = 0; seed < arms; ++seed) {
    const Case c = random_case(seed);
    const int last = c.chain.joints() - 1;
    KDL::ChainFkSolverPos_recursive forward(c.foreign);
    KDL::Frame frame;
    ASSERT_GE(forward.JntToCart(kdl(c.q), frame), 0);
    const LinkPose pose = c.chain.poses(c.q)[static_cast<std::size_t>(last)];
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(pose.position_m[i], frame.p(i), agreed) << seed;
      for (int j = 0; j < 3; ++j) EXPECT_NEAR(pose.rotation(i, j), frame.M(i, j), agreed) << seed;
    }
    KDL::ChainJntToJacSolver solver(c.foreign);
    KDL::Jacobian jacobian(static_cast<unsigned>(last + 1));
    ASSERT_GE(solver.JntToJac(kdl(c.q), jacobian), 0);
    const Eigen::MatrixXd own = c.chain.jacobian(c.q, last, Vector3::Zero());
    EXPECT_LT(apart(own, jacobian.data), agreed) << seed;
  }
}

TEST(AgainstKdl, MassMatrixGravityAndCoriolisTorqueAgree) {
  for (unsigned seed = 0; seed < arms; ++seed) {
    const Case c = random_case(seed);
    const auto joints = static_cast<unsigned>(c.chain.joints());
    const Gravity& g = c.params.gravity;
    KDL::ChainDynParam solver(c.foreign, KDL::Vector(g.x_m_per_s2, g.y_m_per_s2, g.z_m_per_s2));
    KDL::JntSpaceInertiaMatrix mass(c.chain.joints());
    ASSERT_GE(solver.JntToMass(kdl(c.q), mass), 0);
    EXPECT_LT(apart(Eigen::MatrixXd(c.chain.mass_matrix(c.q)), mass.data), agreed) << seed;
    KDL::JntArray gravity(joints);
    ASSERT_GE(solver.JntToGravity(kdl(c.q), gravity), 0);
    EXPECT_LT(apart(Eigen::VectorXd(c.chain.gravity_torque(c.q)), gravity.data), agreed) << seed;
    KDL::JntArray coriolis(joints);
    ASSERT_GE(solver.JntToCoriolis(kdl(c.q), kdl(c.v), coriolis), 0);
    EXPECT_LT(apart(Eigen::VectorXd(c.chain.bias(c.q, c.v)), Eigen::VectorXd(gravity.data + coriolis.data)), agreed)
        << seed;
  }
}

TEST(AgainstKdl, InverseDynamicsAgreeAndTheRegressorTimesItsParametersWithThem) {
  for (unsigned seed = 0; seed < arms; ++seed) {
    const Case c = random_case(seed);
    const Gravity& g = c.params.gravity;
    KDL::ChainIdSolver_RNE solver(c.foreign, KDL::Vector(g.x_m_per_s2, g.y_m_per_s2, g.z_m_per_s2));
    KDL::JntArray torque(static_cast<unsigned>(c.chain.joints()));
    ASSERT_GE(solver.CartToJnt(kdl(c.q), kdl(c.v), kdl(c.a), KDL::Wrenches(c.foreign.getNrOfSegments()), torque), 0);
    const Eigen::VectorXd own = c.chain.inverse_dynamics(c.q, c.v, c.a);
    EXPECT_LT(apart(own, torque.data), agreed) << seed;
    const Eigen::VectorXd by_regressor = c.chain.regressor(c.q, c.v, c.a) * c.chain.parameters();
    const Eigen::VectorXd with_friction = torque.data + Eigen::VectorXd(c.chain.friction(c.v, c.v));
    EXPECT_LT(apart(by_regressor, with_friction), agreed) << seed;
  }
}

}  // namespace
}  // namespace tactus::arm
