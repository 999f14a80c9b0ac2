// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/joint.hpp>
#include <tactus/kernel/core/joints.hpp>

#include <cstddef>

#include <Eigen/Core>

/// The rigid-body dynamics of a serial arm of one to eight joints, for a tick: fixed capacity, no allocation.
namespace tactus::arm {

inline constexpr int most = static_cast<int>(most_joints);
/// Of a body: mass, mass times centre (3), inertia about the link's origin (xx, xy, xz, yy, yz, zz). Linear in them is
/// the torque that moves it.
inline constexpr int body_parameters = 10;
/// Of a joint: those of its body, then armature, Coulomb friction, viscous friction, offset.
inline constexpr int joint_parameters = 14;

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
/// A number for each joint: rad, rad/s, rad/s² or N m; m and N of one that slides.
using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, most, 1>;
using JointMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, most, most>;
/// Velocity (rows 1 to 3, m/s) and turning (4 to 6, rad/s) for one rad/s of each joint, along the axes of the base.
using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, most>;
using Regressor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, most, most * joint_parameters>;
using ParameterVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, most * joint_parameters, 1>;
using BodyVector = Eigen::Matrix<double, body_parameters, 1>;

/// Where a link is: a point p of its frame is at `rotation`·p + `position_m` in that of the base.
struct LinkPose {
  Matrix3 rotation = Matrix3::Identity();
  Vector3 position_m = Vector3::Zero();
};

/// A body as the ten numbers in which dynamics are linear, and back. A mass of 0 gives a centre of 0.
BodyVector linear_parameters(const Body& body) noexcept;
Body body_of(const BodyVector& parameters) noexcept;
/// Errors: `out_of_bounds` for a number outside its description; `inconsistent` for an inertia that no body can have: a
/// principal moment that exceeds the sum of the other two by more than a thousandth of all three. Not real-time safe.
Check check(const Body& body);
/// `Rz(yaw)·Ry(pitch)·Rx(roll)`.
Matrix3 rotation_of(const JointOrigin& origin) noexcept;

namespace detail {

/// A joint and its link, as the recursions need them.
struct ChainLink {
  Matrix3 mounting = Matrix3::Identity();  ///< turns vectors of this link, at position 0, into the link before
  Vector3 origin_m = Vector3::Zero();
  Vector3 axis = Vector3::UnitZ();
  bool slides = false;
  double mass_kg = 0.0;
  Vector3 first_moment_kg_m = Vector3::Zero();  ///< mass times centre
  Matrix3 inertia_kg_m2 = Matrix3::Zero();      ///< about the link's origin
  double armature_kg_m2 = 0.0;
  JointFriction friction = {};
};

}  // namespace detail

/// A serial arm on a base that does not move.
///
/// Signs: a torque is that which the motor must give, positive in the direction in which the position grows. External
/// torque of a force F at a point is Jᵀ·F. Recursive Newton-Euler in the links' own frames. Everything but `make` is
/// real-time safe: no allocation, no failure; numbers that are not finite come out not finite. All vectors must have
/// `joints()` rows.
/// Sources: Luh, Walker, Paul, On-line computational scheme for mechanical manipulators, 1980 (inverse dynamics);
/// Walker and Orin, Efficient dynamic computer simulation of robotic mechanisms, 1982, method 3 (mass matrix from
/// composite bodies); Atkeson, An, Hollerbach, Estimation of inertial parameters, 1986 (regressor).
class Chain {
 public:
  struct Params {
    Joints<JointParams> joints = {};
    Gravity gravity = {};
  };

  /// Errors: `out_of_bounds` for a number outside its description, under `joint_1` and on; `missing` without a joint;
  /// `inconsistent` for an axis of no length and for an inertia that no body can have.
  static Result<Chain> make(const Params& params);

  [[nodiscard]] int joints() const noexcept { return static_cast<int>(links_.size()); }

  /// Of each link.
  [[nodiscard]] Joints<LinkPose> poses(const JointVector& position) const noexcept;
  /// Of a point that is fixed to the link of a joint (from 0) and given in the link's frame.
  [[nodiscard]] Jacobian jacobian(const JointVector& position, int link, const Vector3& point_m) const noexcept;
  /// Symmetric, positive definite where every joint moves something. Armature included.
  [[nodiscard]] JointMatrix mass_matrix(const JointVector& position) const noexcept;
  /// What holds the arm still.
  [[nodiscard]] JointVector gravity_torque(const JointVector& position) const noexcept;
  /// Gravity, Coriolis and centrifugal torque: the inverse dynamics without acceleration.
  [[nodiscard]] JointVector bias(const JointVector& position, const JointVector& velocity) const noexcept;
  /// M·a + bias, armature included, friction not.
  [[nodiscard]] JointVector inverse_dynamics(const JointVector& position, const JointVector& velocity,
                                             const JointVector& acceleration) const noexcept;
  /// Of `JointFriction`, where `transmitted` is the torque without friction.
  [[nodiscard]] JointVector friction(const JointVector& velocity, const JointVector& transmitted) const noexcept;
  /// Inverse dynamics with friction.
  [[nodiscard]] JointVector motor_torque(const JointVector& position, const JointVector& velocity,
                                         const JointVector& acceleration) const noexcept;

  /// The matrix Y with Y·`parameters()` = `motor_torque` of joints without load-dependent and Stribeck friction:
  /// `joint_parameters` columns for each joint.
  [[nodiscard]] Regressor regressor(const JointVector& position, const JointVector& velocity,
                                    const JointVector& acceleration) const noexcept;
  [[nodiscard]] ParameterVector parameters() const noexcept;

 private:
  using Link = detail::ChainLink;
  /// How a link is in the link before.
  struct Step {
    Matrix3 rotation;
    Vector3 offset_m;
  };
  /// Of a link, in its own frame; `acceleration` is that of its origin less that of free fall.
  struct Motion {
    Vector3 turning;
    Vector3 turning_acceleration;
    Vector3 acceleration;
  };
  [[nodiscard]] static Step step_to(const Link& link, double position) noexcept;
  [[nodiscard]] static Motion move(const Link& link, const Step& step, const Motion& before, double velocity,
                                   double acceleration) noexcept;
  [[nodiscard]] Motion base() const noexcept;
  [[nodiscard]] JointVector newton_euler(const JointVector& position, const JointVector& velocity,
                                         const JointVector& acceleration) const noexcept;

  Joints<Link> links_;
  Vector3 gravity_m_per_s2_ = Vector3::Zero();
};

}  // namespace tactus::arm
