// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/chain.hpp>

#include <cmath>
#include <cstddef>
#include <random>

/// Arms, motions and bodies that nobody chose.
namespace tactus::arm {

class RandomArm {
 public:
  explicit RandomArm(unsigned seed) : engine_(seed) {}

  double between(double lower, double upper) { return std::uniform_real_distribution<double>(lower, upper)(engine_); }
  JointVector vector(int joints, double most_of_each) {
    JointVector found(joints);
    for (int i = 0; i < joints; ++i) found[i] = between(-most_of_each, most_of_each);
    return found;
  }

  /// Of a few masses at random, so that a body can have it.
  Body body() {
    Matrix3 inertia = Matrix3::Zero();
    for (int i = 0; i < 6; ++i) {
      const Vector3 p(between(-0.1, 0.1), between(-0.1, 0.1), between(-0.1, 0.1));
      inertia += between(0.1, 0.5) * (p.squaredNorm() * Matrix3::Identity() - p * p.transpose());
    }
    return {.mass_kg = between(0.2, 4.0),
            .centre_x_m = between(-0.2, 0.2),
            .centre_y_m = between(-0.2, 0.2),
            .centre_z_m = between(-0.2, 0.2),
            .xx_kg_m2 = inertia(0, 0),
            .yy_kg_m2 = inertia(1, 1),
            .zz_kg_m2 = inertia(2, 2),
            .xy_kg_m2 = inertia(0, 1),
            .xz_kg_m2 = inertia(0, 2),
            .yz_kg_m2 = inertia(1, 2)};
  }

  /// One joint in four slides.
  Chain::Params arm(std::size_t joints) {
    Chain::Params params{.joints = Joints<JointParams>(joints), .gravity = {}};
    params.gravity = {between(-10.0, 10.0), between(-10.0, 10.0), between(-10.0, 10.0)};
    for (JointParams& joint : params.joints) {
      joint.kind = between(0.0, 1.0) < 0.25 ? JointKind::prismatic : JointKind::revolute;
      joint.origin = {between(-0.4, 0.4), between(-0.4, 0.4), between(-0.4, 0.4),
                      between(-3.0, 3.0), between(-1.5, 1.5), between(-3.0, 3.0)};
      joint.axis = {between(-1.0, 1.0), between(-1.0, 1.0), between(0.1, 1.0)};
      joint.body = body();
      joint.drive = {.armature_kg_m2 = between(0.0, 0.05),
                     .rotor_inertia_kg_m2 = between(0.0, 1e-5),
                     .gear_ratio = between(1.0, 100.0)};
      joint.friction = {.coulomb_N_m = between(0.0, 1.0),
                        .viscous_N_m_s_per_rad = between(0.0, 1.0),
                        .offset_N_m = between(-0.1, 0.1)};
    }
    return params;
  }

 private:
  std::mt19937 engine_;
};

/// Of two vectors or matrices: how far they lie apart, as a share of the greater one's length.
template <class A, class B>
double apart(const A& a, const B& b) {
  const double length = std::max(a.norm(), b.norm());
  return length > 0.0 ? (a - b).norm() / length : 0.0;
}

}  // namespace tactus::arm
