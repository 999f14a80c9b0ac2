// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm/chain.hpp>

#include <array>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace tactus::arm {
namespace {

/// Of the sum of the moments: enough for the rounding of six printed digits.
constexpr double tolerated_share = 1e-3;

Matrix3 inertia_about_centre(const Body& body) noexcept {
  Matrix3 inertia;
  inertia << body.xx_kg_m2, body.xy_kg_m2, body.xz_kg_m2,  //
      body.xy_kg_m2, body.yy_kg_m2, body.yz_kg_m2,         //
      body.xz_kg_m2, body.yz_kg_m2, body.zz_kg_m2;
  return inertia;
}

/// Steiner's share: of a mass at `centre`, about the origin, for each kilogram.
Matrix3 of_point(const Vector3& centre) noexcept {
  return centre.squaredNorm() * Matrix3::Identity() - centre * centre.transpose();
}

Matrix3 skew(const Vector3& v) noexcept {
  Matrix3 matrix;
  matrix << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return matrix;
}

/// I·v as a product with the six numbers xx, xy, xz, yy, yz, zz of I.
Eigen::Matrix<double, 3, 6> product_with_inertia(const Vector3& v) noexcept {
  Eigen::Matrix<double, 3, 6> matrix;
  matrix << v.x(), v.y(), v.z(), 0.0, 0.0, 0.0,  //
      0.0, v.x(), 0.0, v.y(), v.z(), 0.0,        //
      0.0, 0.0, v.x(), 0.0, v.y(), v.z();
  return matrix;
}

}  // namespace

BodyVector linear_parameters(const Body& body) noexcept {
  const Vector3 centre(body.centre_x_m, body.centre_y_m, body.centre_z_m);
  const Matrix3 inertia = inertia_about_centre(body) + body.mass_kg * of_point(centre);
  BodyVector numbers;
  numbers << body.mass_kg, body.mass_kg * centre, inertia(0, 0), inertia(0, 1), inertia(0, 2), inertia(1, 1),
      inertia(1, 2), inertia(2, 2);
  return numbers;
}

Body body_of(const BodyVector& parameters) noexcept {
  const double mass_kg = parameters[0];
  const Vector3 centre = mass_kg > 0.0 ? Vector3(parameters.segment<3>(1) / mass_kg) : Vector3::Zero();
  const Matrix3 steiner = mass_kg * of_point(centre);
  return {.mass_kg = mass_kg,
          .centre_x_m = centre.x(),
          .centre_y_m = centre.y(),
          .centre_z_m = centre.z(),
          .xx_kg_m2 = parameters[4] - steiner(0, 0),
          .yy_kg_m2 = parameters[7] - steiner(1, 1),
          .zz_kg_m2 = parameters[9] - steiner(2, 2),
          .xy_kg_m2 = parameters[5] - steiner(0, 1),
          .xz_kg_m2 = parameters[6] - steiner(0, 2),
          .yz_kg_m2 = parameters[8] - steiner(1, 2)};
}

Matrix3 rotation_of(const JointOrigin& origin) noexcept {
  return (Eigen::AngleAxisd(origin.yaw_rad, Vector3::UnitZ()) * Eigen::AngleAxisd(origin.pitch_rad, Vector3::UnitY()) *
          Eigen::AngleAxisd(origin.roll_rad, Vector3::UnitX()))
      .toRotationMatrix();
}

Check check(const Body& body) {
  if (Check wrong = validate(body)) return wrong;
  // A body is a heap of masses: the second moments of its mass, ½·trace(I)·1 − I, are none of them below zero.
  const Matrix3 inertia = inertia_about_centre(body);
  const Matrix3 moments = 0.5 * inertia.trace() * Matrix3::Identity() - inertia;
  const Eigen::SelfAdjointEigenSolver<Matrix3> solver(moments, Eigen::EigenvaluesOnly);
  const double least = solver.eigenvalues().minCoeff();
  if (least >= -tolerated_share * inertia.trace()) return {};
  return Error{.code = ErrorCode::inconsistent,
               .parameter = "xx_kg_m2",
               .message = "no body has this inertia: one principal moment exceeds the sum of the other two by " +
                          rounded_number(-2.0 * least) +
                          " kg m^2; correct the moments, which are those about the centre of mass",
               .place = {}};
}

Result<Chain> Chain::make(const Params& params) {
  if (params.joints.size() == 0) {
    return Error{.code = ErrorCode::missing,
                 .parameter = "joint_1",
                 .message = "an arm has at least one joint; describe one",
                 .place = {}};
  }
  if (Check wrong = validate(params.gravity)) return under("gravity", *std::move(wrong));
  Chain chain;
  chain.gravity_m_per_s2_ = {params.gravity.x_m_per_s2, params.gravity.y_m_per_s2, params.gravity.z_m_per_s2};
  chain.links_ = Joints<Link>(params.joints.size());
  for (std::size_t joint = 0; joint < params.joints.size(); ++joint) {
    const JointParams& from = params.joints[joint];
    Check wrong = validate(from);
    if (!wrong) {
      wrong = check(from.body);
      if (wrong) wrong = under("body", *std::move(wrong));
    }
    if (wrong) return under_joint<Joints<JointParams>>(joint, *std::move(wrong));
    const Vector3 axis(from.axis.x, from.axis.y, from.axis.z);
    if (!(axis.norm() > 0.0)) {
      return under_joint<Joints<JointParams>>(joint, {.code = ErrorCode::inconsistent,
                                                      .parameter = "axis",
                                                      .message = "the axis has no length; state a direction",
                                                      .place = {}});
    }
    const Vector3 centre(from.body.centre_x_m, from.body.centre_y_m, from.body.centre_z_m);
    Link& link = chain.links_[joint];
    link.mounting = rotation_of(from.origin);
    link.origin_m = {from.origin.x_m, from.origin.y_m, from.origin.z_m};
    link.axis = axis.normalized();
    link.slides = from.kind == JointKind::prismatic;
    link.mass_kg = from.body.mass_kg;
    link.first_moment_kg_m = link.mass_kg * centre;
    link.inertia_kg_m2 = inertia_about_centre(from.body) + link.mass_kg * of_point(centre);
    link.armature_kg_m2 = from.drive.reflected_kg_m2();
    link.friction = from.friction;
  }
  return chain;
}

Chain::Step Chain::step_to(const Link& link, double position) noexcept {
  if (link.slides) return {link.mounting, link.origin_m + link.mounting * (position * link.axis)};
  return {link.mounting * Eigen::AngleAxisd(position, link.axis).toRotationMatrix(), link.origin_m};
}

Chain::Motion Chain::base() const noexcept { return {Vector3::Zero(), Vector3::Zero(), -gravity_m_per_s2_}; }

Chain::Motion Chain::move(const Link& link, const Step& step, const Motion& before, double velocity,
                          double acceleration) noexcept {
  const Matrix3 into = step.rotation.transpose();
  const Vector3 carried = before.acceleration + before.turning_acceleration.cross(step.offset_m) +
                          before.turning.cross(before.turning.cross(step.offset_m));
  Motion motion{into * before.turning, into * before.turning_acceleration, into * carried};
  const Vector3 own = velocity * link.axis;
  if (link.slides) {
    motion.acceleration += 2.0 * motion.turning.cross(own) + acceleration * link.axis;
  } else {
    motion.turning_acceleration += motion.turning.cross(own) + acceleration * link.axis;
    motion.turning += own;
  }
  return motion;
}

JointVector Chain::newton_euler(const JointVector& position, const JointVector& velocity,
                                const JointVector& acceleration) const noexcept {
  const int count = joints();
  std::array<Step, most_joints> steps;
  std::array<Vector3, most_joints> forces;
  std::array<Vector3, most_joints> moments;
  Motion motion = base();
  for (int i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const Link& link = links_[at];
    steps[at] = step_to(link, position[i]);
    motion = move(link, steps[at], motion, velocity[i], acceleration[i]);
    const Vector3& h = link.first_moment_kg_m;
    forces[at] = link.mass_kg * motion.acceleration + motion.turning_acceleration.cross(h) +
                 motion.turning.cross(motion.turning.cross(h));
    moments[at] = link.inertia_kg_m2 * motion.turning_acceleration +
                  motion.turning.cross(link.inertia_kg_m2 * motion.turning) + h.cross(motion.acceleration);
  }
  JointVector torque(count);
  for (int i = count - 1; i >= 0; --i) {
    const auto at = static_cast<std::size_t>(i);
    const Link& link = links_[at];
    torque[i] = link.axis.dot(link.slides ? forces[at] : moments[at]) + link.armature_kg_m2 * acceleration[i];
    if (i == 0) break;
    const Vector3 force = steps[at].rotation * forces[at];
    forces[at - 1] += force;
    moments[at - 1] += steps[at].rotation * moments[at] + steps[at].offset_m.cross(force);
  }
  return torque;
}

Joints<LinkPose> Chain::poses(const JointVector& position) const noexcept {
  Joints<LinkPose> found(links_.size());
  LinkPose pose;
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Step step = step_to(links_[i], position[static_cast<int>(i)]);
    pose.position_m += pose.rotation * step.offset_m;
    pose.rotation = pose.rotation * step.rotation;
    found[i] = pose;
  }
  return found;
}

Jacobian Chain::jacobian(const JointVector& position, int link, const Vector3& point_m) const noexcept {
  const Joints<LinkPose> at = poses(position);
  const LinkPose& last = at[static_cast<std::size_t>(link)];
  const Vector3 point = last.position_m + last.rotation * point_m;
  Jacobian found = Jacobian::Zero(6, joints());
  for (int i = 0; i <= link; ++i) {
    const LinkPose& pose = at[static_cast<std::size_t>(i)];
    const Vector3 axis = pose.rotation * links_[static_cast<std::size_t>(i)].axis;
    if (links_[static_cast<std::size_t>(i)].slides) {
      found.col(i).head<3>() = axis;
    } else {
      found.col(i).head<3>() = axis.cross(point - pose.position_m);
      found.col(i).tail<3>() = axis;
    }
  }
  return found;
}

JointMatrix Chain::mass_matrix(const JointVector& position) const noexcept {
  const int count = joints();
  JointMatrix found = JointMatrix::Zero(count, count);
  std::array<Step, most_joints> steps;
  for (int i = 0; i < count; ++i) {
    steps[static_cast<std::size_t>(i)] = step_to(links_[static_cast<std::size_t>(i)], position[i]);
  }
  // What hangs on a joint, as one body in the frame of its link.
  double mass = 0.0;
  Vector3 h = Vector3::Zero();
  Matrix3 inertia = Matrix3::Zero();
  for (int i = count - 1; i >= 0; --i) {
    const auto at = static_cast<std::size_t>(i);
    const Link& link = links_[at];
    mass += link.mass_kg;
    h += link.first_moment_kg_m;
    inertia += link.inertia_kg_m2;
    Vector3 force = link.slides ? Vector3(mass * link.axis) : Vector3(link.axis.cross(h));
    Vector3 moment = link.slides ? Vector3(h.cross(link.axis)) : Vector3(inertia * link.axis);
    found(i, i) = link.axis.dot(link.slides ? force : moment) + link.armature_kg_m2;
    for (int j = i; j > 0; --j) {
      const Step& step = steps[static_cast<std::size_t>(j)];
      const Link& before = links_[static_cast<std::size_t>(j - 1)];
      const Vector3 turned = step.rotation * force;
      moment = step.rotation * moment + step.offset_m.cross(turned);
      force = turned;
      found(j - 1, i) = before.axis.dot(before.slides ? force : moment);
      found(i, j - 1) = found(j - 1, i);
    }
    const Vector3& p = steps[at].offset_m;
    const Vector3 turned = steps[at].rotation * h;
    // About the origin of the link before: I + the shift of a body whose first moment is not zero.
    inertia = steps[at].rotation * inertia * steps[at].rotation.transpose() + mass * of_point(p) +
              2.0 * p.dot(turned) * Matrix3::Identity() - p * turned.transpose() - turned * p.transpose();
    h = turned + mass * p;
  }
  return found;
}

JointVector Chain::gravity_torque(const JointVector& position) const noexcept {
  const JointVector none = JointVector::Zero(joints());
  return newton_euler(position, none, none);
}

JointVector Chain::bias(const JointVector& position, const JointVector& velocity) const noexcept {
  return newton_euler(position, velocity, JointVector::Zero(joints()));
}

JointVector Chain::inverse_dynamics(const JointVector& position, const JointVector& velocity,
                                    const JointVector& acceleration) const noexcept {
  return newton_euler(position, velocity, acceleration);
}

JointVector Chain::friction(const JointVector& velocity, const JointVector& transmitted) const noexcept {
  JointVector torque(joints());
  for (int i = 0; i < joints(); ++i) {
    torque[i] = links_[static_cast<std::size_t>(i)].friction.torque(velocity[i], transmitted[i]);
  }
  return torque;
}

JointVector Chain::motor_torque(const JointVector& position, const JointVector& velocity,
                                const JointVector& acceleration) const noexcept {
  const JointVector transmitted = newton_euler(position, velocity, acceleration);
  return transmitted + friction(velocity, transmitted);
}

Regressor Chain::regressor(const JointVector& position, const JointVector& velocity,
                           const JointVector& acceleration) const noexcept {
  const Eigen::Index count = joints();
  Regressor found = Regressor::Zero(count, count * joint_parameters);
  std::array<Step, most_joints> steps;
  Motion motion = base();
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const Link& link = links_[at];
    steps[at] = step_to(link, position[k]);
    motion = move(link, steps[at], motion, velocity[k], acceleration[k]);
    const Matrix3 around = skew(motion.turning);
    // Force and moment about the link's origin for each of the body's ten numbers.
    Eigen::Matrix<double, 3, body_parameters> force = Eigen::Matrix<double, 3, body_parameters>::Zero();
    Eigen::Matrix<double, 3, body_parameters> moment = Eigen::Matrix<double, 3, body_parameters>::Zero();
    force.col(0) = motion.acceleration;
    force.middleCols<3>(1) = skew(motion.turning_acceleration) + around * around;
    moment.middleCols<3>(1) = -skew(motion.acceleration);
    moment.rightCols<6>() =
        product_with_inertia(motion.turning_acceleration) + around * product_with_inertia(motion.turning);
    const Eigen::Index first = k * joint_parameters;
    for (Eigen::Index i = k; i >= 0; --i) {
      const auto on = static_cast<std::size_t>(i);
      found.block<1, body_parameters>(i, first) = links_[on].axis.transpose() * (links_[on].slides ? force : moment);
      force = steps[on].rotation * force;
      moment = steps[on].rotation * moment + skew(steps[on].offset_m) * force;
    }
    found(k, first + body_parameters) = acceleration[k];
    found(k, first + body_parameters + 1) = link.friction.direction(velocity[k]);
    found(k, first + body_parameters + 2) = velocity[k];
    found(k, first + body_parameters + 3) = 1.0;
  }
  return found;
}

ParameterVector Chain::parameters() const noexcept {
  const Eigen::Index count = joints();
  ParameterVector found(count * joint_parameters);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Link& link = links_[static_cast<std::size_t>(k)];
    found.segment<joint_parameters>(k * joint_parameters) << link.mass_kg, link.first_moment_kg_m,
        link.inertia_kg_m2(0, 0), link.inertia_kg_m2(0, 1), link.inertia_kg_m2(0, 2), link.inertia_kg_m2(1, 1),
        link.inertia_kg_m2(1, 2), link.inertia_kg_m2(2, 2), link.armature_kg_m2, link.friction.coulomb_N_m,
        link.friction.viscous_N_m_s_per_rad, link.friction.offset_N_m;
  }
  return found;
}

}  // namespace tactus::arm
