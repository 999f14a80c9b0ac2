// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <string>

#include "tests/allocation_counter.hpp"
#include "tests/arm/random_arm.hpp"
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

namespace tactus::arm {
namespace {

/// A mass on a rod that turns about y, hanging down at 0.
Chain::Params pendulum(double mass_kg, double length_m) {
  Chain::Params params{.joints = Joints<JointParams>(1), .gravity = {}};
  params.joints[0].axis = {0.0, 1.0, 0.0};
  params.joints[0].body = {.mass_kg = mass_kg, .centre_z_m = -length_m};
  return params;
}

JointVector vector(std::initializer_list<double> values) {
  JointVector found(static_cast<int>(values.size()));
  int i = 0;
  for (const double value : values) found[i++] = value;
  return found;
}

TEST(Chain, APendulumHasTheTorqueOfItsClosedForm) {
  const double m = 2.0;
  const double l = 0.3;
  const Chain chain = *Chain::make(pendulum(m, l));
  for (const double q : {-2.0, 0.0, 0.4, 3.0}) {
    EXPECT_NEAR(chain.gravity_torque(vector({q}))[0], m * 9.81 * l * std::sin(q), 1e-14);
    EXPECT_NEAR(chain.mass_matrix(vector({q}))(0, 0), m * l * l, 1e-15);
    // One link feels no centrifugal torque about its own joint.
    EXPECT_NEAR(chain.inverse_dynamics(vector({q}), vector({5.0}), vector({7.0}))[0],
                m * l * l * 7.0 + m * 9.81 * l * std::sin(q), 1e-13);
  }
}

TEST(Chain, AMassOnASlideWeighsWhatItWeighs) {
  Chain::Params params{.joints = Joints<JointParams>(1), .gravity = {}};
  params.joints[0].kind = JointKind::prismatic;
  params.joints[0].body.mass_kg = 3.0;
  params.joints[0].drive = {.armature_kg_m2 = 0.5, .rotor_inertia_kg_m2 = 0.01, .gear_ratio = 10.0};
  const Chain chain = *Chain::make(params);
  EXPECT_NEAR(chain.gravity_torque(vector({0.2}))[0], 3.0 * 9.81, 1e-14);
  EXPECT_NEAR(chain.inverse_dynamics(vector({0.2}), vector({1.0}), vector({2.0}))[0], 3.0 * 9.81 + 2.0 * (3.0 + 1.5),
              1e-13);
  EXPECT_NEAR(chain.poses(vector({0.2}))[0].position_m.z(), 0.2, 1e-15);
}

/// Spong, Hutchinson, Vidyasagar, Robot Modeling and Control, 2006, eq. 7.87 to 7.94: two links in a plane that stands
/// upright, x ahead and y up.
TEST(Chain, TwoLinksHaveTheMatricesOfTheTextbook) {
  const double m1 = 1.3, m2 = 0.7, l1 = 0.4, c1 = 0.25, c2 = 0.15, i1 = 0.02, i2 = 0.01, g = 9.81;
  Chain::Params params{.joints = Joints<JointParams>(2), .gravity = {0.0, -g, 0.0}};
  params.joints[0].body = {.mass_kg = m1, .centre_x_m = c1, .xx_kg_m2 = i1, .yy_kg_m2 = i1, .zz_kg_m2 = i1};
  params.joints[1].body = {.mass_kg = m2, .centre_x_m = c2, .xx_kg_m2 = i2, .yy_kg_m2 = i2, .zz_kg_m2 = i2};
  params.joints[1].origin.x_m = l1;
  const Chain chain = *Chain::make(params);
  const double q1 = 0.6, q2 = -1.1, v1 = 1.7, v2 = -2.3, a1 = 4.0, a2 = 9.0;
  const double d11 = m1 * c1 * c1 + m2 * (l1 * l1 + c2 * c2 + 2.0 * l1 * c2 * std::cos(q2)) + i1 + i2;
  const double d12 = m2 * (c2 * c2 + l1 * c2 * std::cos(q2)) + i2;
  const double d22 = m2 * c2 * c2 + i2;
  const double h = -m2 * l1 * c2 * std::sin(q2);
  const double g1 = (m1 * c1 + m2 * l1) * g * std::cos(q1) + m2 * c2 * g * std::cos(q1 + q2);
  const double g2 = m2 * c2 * g * std::cos(q1 + q2);
  const JointMatrix mass = chain.mass_matrix(vector({q1, q2}));
  EXPECT_NEAR(mass(0, 0), d11, 1e-14);
  EXPECT_NEAR(mass(0, 1), d12, 1e-14);
  EXPECT_NEAR(mass(1, 1), d22, 1e-14);
  const JointVector torque = chain.inverse_dynamics(vector({q1, q2}), vector({v1, v2}), vector({a1, a2}));
  EXPECT_NEAR(torque[0], d11 * a1 + d12 * a2 + 2.0 * h * v1 * v2 + h * v2 * v2 + g1, 1e-13);
  EXPECT_NEAR(torque[1], d12 * a1 + d22 * a2 - h * v1 * v1 + g2, 1e-13);
}

TEST(Chain, TheMassMatrixIsSymmetricAndPositiveDefinite) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    RandomArm random(seed);
    const Chain chain = *Chain::make(random.arm(1 + seed % 8));
    const JointMatrix mass = chain.mass_matrix(random.vector(chain.joints(), 3.0));
    EXPECT_EQ((mass - mass.transpose()).norm(), 0.0);
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(mass).eigenvalues().minCoeff(), 0.0) << seed;
  }
}

/// Kinetic energy from the motion of each body's centre, by differences of where `poses` puts it: no inertia matrix of
/// joints in it.
double kinetic(const Chain& chain, const Chain::Params& params, const JointVector& q, const JointVector& v) {
  const double h = 1e-6;
  const auto before = chain.poses(q - h * v);
  const auto after = chain.poses(q + h * v);
  const auto now = chain.poses(q);
  double energy = 0.0;
  for (std::size_t i = 0; i < now.size(); ++i) {
    const Body& b = params.joints[i].body;
    const Vector3 centre(b.centre_x_m, b.centre_y_m, b.centre_z_m);
    const Vector3 velocity =
        (after[i].position_m + after[i].rotation * centre - before[i].position_m - before[i].rotation * centre) /
        (2.0 * h);
    const Matrix3 spin = (after[i].rotation - before[i].rotation) / (2.0 * h) * now[i].rotation.transpose();
    const Vector3 turning = now[i].rotation.transpose() * Vector3(spin(2, 1), spin(0, 2), spin(1, 0));
    Matrix3 inertia;
    inertia << b.xx_kg_m2, b.xy_kg_m2, b.xz_kg_m2, b.xy_kg_m2, b.yy_kg_m2, b.yz_kg_m2, b.xz_kg_m2, b.yz_kg_m2,
        b.zz_kg_m2;
    energy += 0.5 * b.mass_kg * velocity.squaredNorm() + 0.5 * turning.dot(inertia * turning) +
              0.5 * params.joints[i].drive.reflected_kg_m2() * v[static_cast<int>(i)] * v[static_cast<int>(i)];
  }
  return energy;
}

double potential(const Chain& chain, const Chain::Params& params, const JointVector& q) {
  const Vector3 g(params.gravity.x_m_per_s2, params.gravity.y_m_per_s2, params.gravity.z_m_per_s2);
  const auto poses = chain.poses(q);
  double energy = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Body& b = params.joints[i].body;
    const Vector3 centre(b.centre_x_m, b.centre_y_m, b.centre_z_m);
    energy -= b.mass_kg * g.dot(poses[i].position_m + poses[i].rotation * centre);
  }
  return energy;
}

TEST(Chain, HalfOfVelocityTimesMassTimesVelocityIsTheEnergyOfTheMovingBodies) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    RandomArm random(seed);
    const Chain::Params params = random.arm(1 + seed % 8);
    const Chain chain = *Chain::make(params);
    const JointVector q = random.vector(chain.joints(), 3.0);
    const JointVector v = random.vector(chain.joints(), 2.0);
    const double energy = kinetic(chain, params, q, v);
    EXPECT_NEAR(0.5 * v.dot(chain.mass_matrix(q) * v), energy, 1e-7 * energy) << seed;
  }
}

TEST(Chain, GravityIsTheSlopeOfPotentialEnergy) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    RandomArm random(seed);
    const Chain::Params params = random.arm(1 + seed % 8);
    const Chain chain = *Chain::make(params);
    const JointVector q = random.vector(chain.joints(), 3.0);
    const JointVector torque = chain.gravity_torque(q);
    for (int i = 0; i < chain.joints(); ++i) {
      JointVector up = q;
      JointVector down = q;
      up[i] += 1e-5;
      down[i] -= 1e-5;
      EXPECT_NEAR(torque[i], (potential(chain, params, up) - potential(chain, params, down)) / 2e-5, 1e-5) << seed;
    }
  }
}

/// d/dt (M v) − ½ ∂(vᵀ M v)/∂q is what remains of the bias without gravity: Lagrange's equations.
TEST(Chain, CoriolisTorqueIsWhatTheChangeOfTheMassMatrixAsksFor) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    RandomArm random(seed);
    const Chain chain = *Chain::make(random.arm(1 + seed % 8));
    const int joints = chain.joints();
    const JointVector q = random.vector(joints, 3.0);
    const JointVector v = random.vector(joints, 2.0);
    const double h = 1e-5;
    JointVector expected = (chain.mass_matrix(q + h * v) * v - chain.mass_matrix(q - h * v) * v) / (2.0 * h);
    for (int i = 0; i < joints; ++i) {
      JointVector up = q;
      JointVector down = q;
      up[i] += h;
      down[i] -= h;
      expected[i] -= 0.5 * v.dot((chain.mass_matrix(up) - chain.mass_matrix(down)) * v) / (2.0 * h);
    }
    const JointVector found = chain.bias(q, v) - chain.gravity_torque(q);
    EXPECT_LT((found - expected).norm(), 1e-6 * (1.0 + expected.norm())) << seed;
  }
}

TEST(Chain, AFallingArmKeepsItsEnergyToTheOrderOfTheIntegrator) {
  RandomArm random(7);
  const Chain::Params params = random.arm(6);
  const Chain chain = *Chain::make(params);
  const auto slope = [&](const JointVector& q, const JointVector& v) -> JointVector {
    return Eigen::LLT<Eigen::MatrixXd>(chain.mass_matrix(q)).solve(-chain.bias(q, v));
  };
  const auto drift = [&](double h) {
    JointVector q = JointVector::Constant(6, 0.3);
    JointVector v = JointVector::Zero(6);
    const auto energy = [&] { return 0.5 * v.dot(chain.mass_matrix(q) * v) + potential(chain, params, q); };
    const double before = energy();
    for (double t = 0.0; t < 0.2 - 0.5 * h; t += h) {
      const JointVector a1 = slope(q, v);
      const JointVector v2 = v + 0.5 * h * a1;
      const JointVector a2 = slope(q + 0.5 * h * v, v2);
      const JointVector v3 = v + 0.5 * h * a2;
      const JointVector a3 = slope(q + 0.5 * h * v2, v3);
      const JointVector v4 = v + h * a3;
      const JointVector a4 = slope(q + h * v3, v4);
      q += h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
      v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    }
    return std::fabs(energy() - before);
  };
  const double coarse = drift(2e-3);
  const double fine = drift(1e-3);
  EXPECT_LT(fine, 1e-4);
  EXPECT_GT(coarse / fine, 8.0) << coarse << " " << fine;  // 16 or more of fourth order
}

TEST(Chain, FrictionFollowsItsLaw) {
  JointFriction friction{.coulomb_N_m = 0.5,
                         .viscous_N_m_s_per_rad = 0.2,
                         .offset_N_m = 0.03,
                         .load = 0.1,
                         .stribeck_N_m = 0.4,
                         .stribeck_velocity_rad_per_s = 0.3,
                         .velocity_scale_rad_per_s = 0.001};
  EXPECT_NEAR(friction.torque(0.0, 5.0), 0.03, 1e-15);
  EXPECT_NEAR(friction.torque(10.0, -2.0), 0.5 + 0.2 + 2.0 + 0.03, 1e-12);
  EXPECT_NEAR(friction.torque(-0.3, 0.0), -(0.5 + 0.4 * std::exp(-1.0)) - 0.06 + 0.03, 1e-12);
}

TEST(Chain, BodiesGoThereAndBack) {
  RandomArm random(3);
  for (int i = 0; i < 50; ++i) {
    const Body body = random.body();
    const Body back = body_of(linear_parameters(body));
    for_each_field<Body>([&](const auto& f) { EXPECT_NEAR(body.*f.member, back.*f.member, 1e-14) << f.name; });
  }
}

TEST(Chain, ATickDoesNotAllocate) {
  RandomArm random(11);
  const Chain chain = *Chain::make(random.arm(8));
  const JointVector q = random.vector(8, 3.0);
  const JointVector v = random.vector(8, 3.0);
  const JointVector a = random.vector(8, 3.0);
  const std::uint64_t before = laws::own_allocation_count();
  const Chain copy = chain;
  JointVector sum = copy.motor_torque(q, v, a) + chain.bias(q, v) + chain.gravity_torque(q);
  sum += chain.regressor(q, v, a) * chain.parameters();
  sum += chain.mass_matrix(q) * a +
         chain.jacobian(q, 7, Vector3::Ones()).transpose() * Eigen::Matrix<double, 6, 1>::Ones();
  sum[0] += chain.poses(q)[7].position_m.x();
  EXPECT_EQ(laws::own_allocation_count(), before);
  EXPECT_TRUE(sum.allFinite());
}

TEST(Chain, WrongDescriptionsAreRefusedWithTheJoint) {
  EXPECT_EQ(Chain::make({}).error().code, ErrorCode::missing);
  RandomArm random(1);
  Chain::Params params = random.arm(3);
  params.joints[1].body.mass_kg = -1.0;
  EXPECT_EQ(Chain::make(params).error().parameter, "joint_2.body.mass_kg");
  params = random.arm(3);
  params.joints[2].axis = {0.0, 0.0, 0.0};
  EXPECT_EQ(Chain::make(params).error().parameter, "joint_3.axis");
  params = random.arm(3);
  params.joints[0].body.xx_kg_m2 = params.joints[0].body.yy_kg_m2 + params.joints[0].body.zz_kg_m2 + 0.1;
  EXPECT_EQ(Chain::make(params).error().code, ErrorCode::inconsistent);
  params = random.arm(3);
  params.gravity.z_m_per_s2 = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(Chain::make(params).error().parameter, "gravity.z_m_per_s2");
}

}  // namespace
}  // namespace tactus::arm
