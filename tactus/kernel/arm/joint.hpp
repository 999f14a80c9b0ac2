// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/units.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <array>
#include <cmath>

/// What a serial arm is described by, one struct for each part of a joint and the link behind it.
///
/// Frames: a link's frame is that of the joint that moves it, as in URDF; at position 0 it lies at `JointOrigin` in the
/// frame of the link before, the base before the first. Units of a joint that slides: see units.hpp.
namespace tactus::arm {

/// Where a joint is on the link before: first turned about the fixed axes x, y, z by roll, pitch, yaw
/// (R = Rz·Ry·Rx), then moved, as `<origin>` of URDF.
struct JointOrigin {
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;
  double roll_rad = 0.0;
  double pitch_rad = 0.0;
  double yaw_rad = 0.0;
  static constexpr auto fields() {
    using J = JointOrigin;
    return List{field("x_m", &J::x_m, tactus::units::metre, any_finite, "Along x of the link before."),
                field("y_m", &J::y_m, tactus::units::metre, any_finite, "Along y of the link before."),
                field("z_m", &J::z_m, tactus::units::metre, any_finite, "Along z of the link before."),
                field("roll_rad", &J::roll_rad, units::radian, any_finite, "Turn about x, the first of the three."),
                field("pitch_rad", &J::pitch_rad, units::radian, any_finite, "Turn about the fixed y, the second."),
                field("yaw_rad", &J::yaw_rad, units::radian, any_finite, "Turn about the fixed z, the last.")};
  }
};

/// The direction of a joint in the frame of its link; of any length but 0.
struct JointAxis {
  double x = 0.0;
  double y = 0.0;
  double z = 1.0;
  static constexpr auto fields() {
    return List{field("x", &JointAxis::x, tactus::units::none, any_finite, "Component along x."),
                field("y", &JointAxis::y, tactus::units::none, any_finite, "Component along y."),
                field("z", &JointAxis::z, tactus::units::none, any_finite, "Component along z.")};
  }
};

/// Mass, its centre and the inertia about that centre along the axes of the link's frame. The products are those of the
/// matrix, as in URDF: `xy_kg_m2` is −∫xy dm.
struct Body {
  double mass_kg = 0.0;
  double centre_x_m = 0.0;
  double centre_y_m = 0.0;
  double centre_z_m = 0.0;
  double xx_kg_m2 = 0.0;
  double yy_kg_m2 = 0.0;
  double zz_kg_m2 = 0.0;
  double xy_kg_m2 = 0.0;
  double xz_kg_m2 = 0.0;
  double yz_kg_m2 = 0.0;
  static constexpr auto fields() {
    using B = Body;
    return List{
        field("mass_kg", &B::mass_kg, tactus::units::kilogram, non_negative, "Mass of the link."),
        field("centre_x_m", &B::centre_x_m, tactus::units::metre, any_finite, "Centre of mass along x."),
        field("centre_y_m", &B::centre_y_m, tactus::units::metre, any_finite, "Centre of mass along y."),
        field("centre_z_m", &B::centre_z_m, tactus::units::metre, any_finite, "Centre of mass along z."),
        field("xx_kg_m2", &B::xx_kg_m2, units::kilogram_metre2, non_negative, "Moment of inertia about the centre."),
        field("yy_kg_m2", &B::yy_kg_m2, units::kilogram_metre2, non_negative, "Moment of inertia about the centre."),
        field("zz_kg_m2", &B::zz_kg_m2, units::kilogram_metre2, non_negative, "Moment of inertia about the centre."),
        field("xy_kg_m2", &B::xy_kg_m2, units::kilogram_metre2, any_finite, "Product of inertia, -integral of x y."),
        field("xz_kg_m2", &B::xz_kg_m2, units::kilogram_metre2, any_finite, "Product of inertia, -integral of x z."),
        field("yz_kg_m2", &B::yz_kg_m2, units::kilogram_metre2, any_finite, "Product of inertia, -integral of y z.")};
  }
};

/// What turns with the motor. It adds to the joint's own diagonal of the mass matrix; the gyroscopic couple of a
/// spinning rotor is left out, as it is in MuJoCo's `armature`.
struct Drive {
  double armature_kg_m2 = 0.0;
  double rotor_inertia_kg_m2 = 0.0;
  double gear_ratio = 1.0;
  static constexpr auto fields() {
    using D = Drive;
    return List{
        field("armature_kg_m2", &D::armature_kg_m2, units::kilogram_metre2, non_negative,
              "Inertia at the joint's side of the gear."),
        field("rotor_inertia_kg_m2", &D::rotor_inertia_kg_m2, units::kilogram_metre2, non_negative,
              "Inertia at the motor's side; counts with the square of gear_ratio."),
        field("gear_ratio", &D::gear_ratio, tactus::units::none, positive, "Turns of the motor for one of the joint.")};
  }
  /// All of it at the joint's side.
  [[nodiscard]] double reflected_kg_m2() const noexcept {
    return armature_kg_m2 + gear_ratio * gear_ratio * rotor_inertia_kg_m2;
  }
};

/// The torque that motion takes alongside inertia and gravity, positive where it needs a positive torque of the motor:
///
///     tanh(v / v0) · (Coulomb + load · |transmitted torque| + excess · exp(−(v / vs)²)) + viscous · v + offset
///
/// A smooth law of the velocity: it can neither stick nor be evaluated wrongly at rest, and is meant for feed-forward,
/// observers and regression. A plant that sticks is in mechanics/friction.hpp. Sources: Armstrong-Hélouvry, Dupont,
/// Canudas de Wit, Automatica 30(7), 1994 (Stribeck's excess as a Gaussian); Hamon, Gautier, Garrec, IROS 2010 (load).
struct JointFriction {
  double coulomb_N_m = 0.0;
  double viscous_N_m_s_per_rad = 0.0;
  double offset_N_m = 0.0;
  double load = 0.0;
  double stribeck_N_m = 0.0;
  double stribeck_velocity_rad_per_s = 0.1;
  double velocity_scale_rad_per_s = 0.02;
  static constexpr auto fields() {
    using F = JointFriction;
    return List{
        field("coulomb_N_m", &F::coulomb_N_m, units::newton_metre, non_negative, "Friction while the joint slides."),
        field("viscous_N_m_s_per_rad", &F::viscous_N_m_s_per_rad, units::newton_metre_second_per_radian, non_negative,
              "Friction in proportion to velocity."),
        field("offset_N_m", &F::offset_N_m, units::newton_metre, any_finite, "What the torque reads too much."),
        field("load", &F::load, tactus::units::none, non_negative,
              "Further friction as a share of the torque that the gear transmits."),
        field("stribeck_N_m", &F::stribeck_N_m, units::newton_metre, any_finite,
              "Further friction in slow motion, above coulomb_N_m; below zero where slow motion has less."),
        field("stribeck_velocity_rad_per_s", &F::stribeck_velocity_rad_per_s, units::radian_per_second, positive,
              "Velocity at which stribeck_N_m has fallen to 1/e."),
        field("velocity_scale_rad_per_s", &F::velocity_scale_rad_per_s, units::radian_per_second, positive,
              "Velocity within which friction turns round: v0 of tanh(v/v0).")};
  }
  /// The torque in N m at a velocity, of a joint that transmits `transmitted_N_m`. Real-time safe.
  [[nodiscard]] double torque(double velocity_rad_per_s, double transmitted_N_m) const noexcept {
    const double slow = velocity_rad_per_s / stribeck_velocity_rad_per_s;
    const double dry = coulomb_N_m + load * std::fabs(transmitted_N_m) + stribeck_N_m * std::exp(-slow * slow);
    return direction(velocity_rad_per_s) * dry + viscous_N_m_s_per_rad * velocity_rad_per_s + offset_N_m;
  }
  /// tanh(v/v0): -1 to 1.
  [[nodiscard]] double direction(double velocity_rad_per_s) const noexcept {
    return std::tanh(velocity_rad_per_s / velocity_scale_rad_per_s);
  }
};

/// What a joint's maker allows. Nothing in this module enforces them.
struct JointLimits {
  double lower_rad = -1e9;
  double upper_rad = 1e9;
  double velocity_rad_per_s = 1e9;
  double effort_N_m = 1e9;
  static constexpr auto fields() {
    using L = JointLimits;
    return List{
        field("lower_rad", &L::lower_rad, units::radian, any_finite, "Least position."),
        field("upper_rad", &L::upper_rad, units::radian, any_finite, "Greatest position."),
        field("velocity_rad_per_s", &L::velocity_rad_per_s, units::radian_per_second, non_negative, "Greatest speed."),
        field("effort_N_m", &L::effort_N_m, units::newton_metre, non_negative, "Greatest torque.")};
  }
};

enum class JointKind { revolute, prismatic };
constexpr auto enumerators(JointKind) {
  return std::array{Enumerator{JointKind::revolute, "revolute"}, Enumerator{JointKind::prismatic, "prismatic"}};
}

/// A joint and the link that it moves.
struct JointParams {
  JointKind kind = JointKind::revolute;
  JointOrigin origin = {};
  JointAxis axis = {};
  Body body = {};
  Drive drive = {};
  JointFriction friction = {};
  JointLimits limits = {};
  static constexpr auto fields() {
    using J = JointParams;
    return List{field("kind", &J::kind, "Whether it turns about its axis or slides along it."),
                field("origin", &J::origin, "Place of the joint on the link before."),
                field("axis", &J::axis, "Its direction in the frame of its link."),
                field("body", &J::body, "The link that it moves, with all that is fixed to it."),
                field("drive", &J::drive, "What turns with its motor."),
                field("friction", &J::friction, "Its friction."),
                field("limits", &J::limits, "What its maker allows.")};
  }
};

/// The acceleration of free fall in the frame of the base.
struct Gravity {
  double x_m_per_s2 = 0.0;
  double y_m_per_s2 = 0.0;
  double z_m_per_s2 = -9.81;
  static constexpr auto fields() {
    using G = Gravity;
    return List{field("x_m_per_s2", &G::x_m_per_s2, units::metre_per_second2, any_finite, "Along x of the base."),
                field("y_m_per_s2", &G::y_m_per_s2, units::metre_per_second2, any_finite, "Along y of the base."),
                field("z_m_per_s2", &G::z_m_per_s2, units::metre_per_second2, any_finite, "Along z of the base.")};
  }
};

}  // namespace tactus::arm
