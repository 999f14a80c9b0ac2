// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm/largest_inertia.hpp>

#include <algorithm>
#include <cmath>

namespace tactus::arm {

namespace {

Vector3 origin_of(const JointParams& joint) { return {joint.origin.x_m, joint.origin.y_m, joint.origin.z_m}; }
Vector3 axis_of(const JointParams& joint) { return Vector3(joint.axis.x, joint.axis.y, joint.axis.z).normalized(); }
/// How far a joint may carry its link along its axis.
double slide_m(const JointParams& joint) {
  if (joint.kind != JointKind::prismatic) return 0.0;
  return std::max(std::fabs(joint.limits.lower_rad), std::fabs(joint.limits.upper_rad));
}

}  // namespace

JointVector largest_inertia(const Chain::Params& params) {
  const auto count = static_cast<Eigen::Index>(params.joints.size());
  JointVector largest = JointVector::Zero(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const JointParams& joint = params.joints[static_cast<std::size_t>(i)];
    const bool slides = joint.kind == JointKind::prismatic;
    const Vector3 axis = axis_of(joint);
    double apart_m = 0.0;
    largest[i] = joint.drive.reflected_kg_m2();
    for (Eigen::Index k = i; k < count; ++k) {
      const JointParams& beyond = params.joints[static_cast<std::size_t>(k)];
      const BodyVector body = linear_parameters(beyond.body);
      const double mass_kg = body[0];
      if (k > i) {
        const Vector3 offset = origin_of(beyond);
        apart_m += (k == i + 1 ? offset.cross(axis).norm() : offset.norm()) + slide_m(beyond);
      }
      if (slides) {
        largest[i] += mass_kg;
      } else if (k == i) {
        Matrix3 inertia;
        inertia << body[4], body[5], body[6], body[5], body[7], body[8], body[6], body[8], body[9];
        largest[i] += axis.dot(inertia * axis);
      } else {
        const double second_moment_kg_m2 = 0.5 * (body[4] + body[7] + body[9]);
        const double root = std::sqrt(mass_kg) * apart_m + std::sqrt(second_moment_kg_m2);
        largest[i] += root * root;
      }
    }
  }
  return largest;
}

}  // namespace tactus::arm
