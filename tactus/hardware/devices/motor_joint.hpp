// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/motor_bus.hpp>
#include <tactus/kernel/control/drive_law.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/station/device.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tactus::devices {

namespace joint_units {
inline constexpr Unit radian{"rad", "_rad"};
inline constexpr Unit radian_per_second{"rad/s", "_rad_per_s"};
inline constexpr Unit newton_metre{"N m", "_Nm"};
inline constexpr Unit newton_metre_per_second{"N m/s", "_Nm_per_s"};
inline constexpr Unit newton_metre_per_radian{"N m/rad", "_Nm_per_rad"};
inline constexpr Unit newton_metre_second_per_radian{"N m s/rad", "_Nms_per_rad"};
inline constexpr Unit degree_celsius{"degC", "_C"};
}  // namespace joint_units

/// A joint, the motor that moves it, and what it may do:
///
///     joint = sign · motor / gear + offset,   torque of the motor = sign · torque of the joint / gear,
///     gains of the motor's law = gains of the joint's / gear²
///
/// The motor's numbers are those at the output of its own gear. Where the joint slides, read m for rad and N for N m.
///
/// The sign of a joint, stated here for all headers: a joint has one positive sense, in which its position grows; of an
/// arm it is that of the URDF's axis, and leader and follower have the same. Position, velocity, commanded and reported
/// torque, and torque from outside are positive in that sense, so a positive torque of the motor moves a free joint up.
/// `sign` turns position and torque together, so it cannot correct a motor that moves against its torque. Force sensors
/// of one axis: `tactus/kernel/station/device.hpp`.
struct MotorJoint {
  std::int64_t sign = 1;
  double offset_rad = 0.0;
  double gear = 1.0;
  double lower_rad = 0.0;
  double upper_rad = 0.0;
  double velocity_limit_rad_per_s = 0.0;
  double torque_limit_Nm = 0.0;
  double torque_rate_limit_Nm_per_s = 0.0;
  double stiffness_limit_Nm_per_rad = 0.0;  ///< of the law that its motor runs; both 0: none
  double damping_limit_Nms_per_rad = 0.0;
  double temperature_limit_C = 70.0;
  bool gives_force = true;               ///< false: it reports where it is and takes no command
  double velocity_step_rad_per_s = 0.0;  ///< of the velocity that its motor reports, at the motor; 0: it reports none
  double turn_rad = 0.0;  ///< of the motor, after which its number restarts when it gets power; 0: it does not

  static constexpr auto fields() {
    using namespace joint_units;
    return List{
        field("sign", &MotorJoint::sign, between(-1.0, 1.0), "1, or -1 where the motor turns against the joint."),
        field("offset_rad", &MotorJoint::offset_rad, radian, between(-1000.0, 1000.0),
              "Where the joint is when its motor reads zero; `tactus device zero` writes it."),
        field("gear", &MotorJoint::gear, units::none, between(0.01, 1000.0),
              "Turns of the motor's output for one of the joint."),
        field("lower_rad", &MotorJoint::lower_rad, radian, between(-1000.0, 1000.0),
              "The joint has no power below that."),
        field("upper_rad", &MotorJoint::upper_rad, radian, between(-1000.0, 1000.0),
              "The joint has no power above that."),
        field("velocity_limit_rad_per_s", &MotorJoint::velocity_limit_rad_per_s, radian_per_second,
              positive_up_to(1000.0), "A joint that is faster loses its power."),
        field("torque_limit_Nm", &MotorJoint::torque_limit_Nm, newton_metre, positive_up_to(1000.0),
              "The largest torque at the joint, either way."),
        field("torque_rate_limit_Nm_per_s", &MotorJoint::torque_rate_limit_Nm_per_s, newton_metre_per_second,
              positive_up_to(1e6), "The fastest change of that torque."),
        field(
            "stiffness_limit_Nm_per_rad", &MotorJoint::stiffness_limit_Nm_per_rad, newton_metre_per_radian,
            between(0.0, 5e6),
            "The stiffest that its motor may hold it by itself, about the joint; until the next command the torque may "
            "leave its limit by that times the way."),
        field("damping_limit_Nms_per_rad", &MotorJoint::damping_limit_Nms_per_rad, newton_metre_second_per_radian,
              between(0.0, 5e4), "The most damping that its motor may give it by itself; both 0: it runs no law."),
        field("temperature_limit_C", &MotorJoint::temperature_limit_C, degree_celsius, between(20.0, 150.0),
              "A motor that is hotter loses its power.")};
  }

  [[nodiscard]] double position_rad(double of_motor_rad) const noexcept {
    return static_cast<double>(sign) * of_motor_rad / gear + offset_rad;
  }
  /// The same of what a motor reports first: a number that restarts after each turn stands for all turns, and the one
  /// that is nearest to the middle of the joint's range is meant.
  [[nodiscard]] double first_position_rad(double of_motor_rad) const noexcept {
    const double told_rad = position_rad(of_motor_rad);
    if (!(turn_rad > 0.0)) return told_rad;
    const double of_joint_rad = turn_rad / gear;
    return told_rad + of_joint_rad * std::round((0.5 * (lower_rad + upper_rad) - told_rad) / of_joint_rad);
  }
  [[nodiscard]] double velocity_rad_per_s(double of_motor_rad_per_s) const noexcept {
    return static_cast<double>(sign) * of_motor_rad_per_s / gear;
  }
  /// Within the joint's limit; what is not a number stays none.
  [[nodiscard]] double motor_torque_Nm(double of_joint_Nm) const noexcept {
    const double held_Nm =
        std::isnan(of_joint_Nm) ? of_joint_Nm : std::clamp(of_joint_Nm, -torque_limit_Nm, torque_limit_Nm);
    return static_cast<double>(sign) * held_Nm / gear;
  }
  [[nodiscard]] double torque_Nm(double of_motor_Nm) const noexcept {
    return static_cast<double>(sign) * gear * of_motor_Nm;
  }
  /// The law of the motor that is that law of the joint, `turns_rad` of the joint being what its motor's number does
  /// not count (`first_position_rad`).
  [[nodiscard]] MotorLaw motor_law(const control::DriveLaw& of_joint, double turns_rad) const noexcept {
    const double way = static_cast<double>(sign) * gear;
    return {.position_rad = way * (of_joint.position_m - offset_rad - turns_rad),
            .velocity_rad_per_s = way * of_joint.velocity_m_per_s,
            .stiffness_Nm_per_rad = of_joint.stiffness_N_per_m / (gear * gear),
            .damping_Nms_per_rad = of_joint.damping_N_s_per_m / (gear * gear)};
  }
  /// The command of its motor with which the joint gets that force and law, at this reading within the torque limit. It
  /// reports nothing of power. Real-time safe.
  [[nodiscard]] MotorCommand motor_command(const station::DeviceCommand& of_joint, const station::DeviceReading& at,
                                           double turns_rad) const noexcept {
    if (!of_joint.law.acts()) return {.torque_Nm = motor_torque_Nm(of_joint.force_N)};
    double force_N = of_joint.force_N;
    control::DriveLaw law = of_joint.law;
    const double whole_N = force_N + law.force_N(at.position_m, at.motor_report.velocity_m_per_s);
    if (std::fabs(whole_N) > torque_limit_Nm) {
      control::keep_part(force_N, law, whole_N, std::copysign(torque_limit_Nm, whole_N));
    }
    return {.torque_Nm = static_cast<double>(sign) * force_N / gear, .law = motor_law(law, turns_rad)};
  }
  [[nodiscard]] bool contains(double position_rad) const noexcept {
    return position_rad >= lower_rad && position_rad <= upper_rad;
  }
  /// Whether it may have power at the speed that its motor reports.
  [[nodiscard]] bool allows_speed(const MotorReading& motor) const noexcept {
    return std::fabs(velocity_rad_per_s(motor.velocity_rad_per_s)) <= velocity_limit_rad_per_s;
  }
  /// Whether it may have power while its motor is so warm. What a motor does not report counts for it.
  [[nodiscard]] bool allows_warmth(const MotorReading& motor) const noexcept {
    return !(motor.temperature_C > temperature_limit_C);
  }
  /// As its device states them. A motor that gives no force has next to none, so that nobody assumes more.
  [[nodiscard]] station::DeviceLimits limits() const noexcept {
    constexpr double no_force_N = 1e-9, no_rate_N_per_s = 1.0;
    return {.force_N = gives_force ? torque_limit_Nm : no_force_N,
            .handle_force_N = 0.0,
            .rate_N_per_s = gives_force ? torque_rate_limit_Nm_per_s : no_rate_N_per_s,
            .velocity_m_per_s = velocity_limit_rad_per_s,
            .position_m = std::max(std::fabs(lower_rad), std::fabs(upper_rad)),
            .stiffness_N_per_m = stiffness_limit_Nm_per_rad,
            .damping_N_s_per_m = damping_limit_Nms_per_rad,
            .velocity_step_m_per_s = velocity_step_rad_per_s / gear};
  }
};

}  // namespace tactus::devices
