// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/motors.hpp>
#include <tactus/kernel/core/parameters.hpp>

namespace tactus::arm_control {

using arm::ArmReading;
using arm::JointVector;

/// What FACTR's leader does in addition to gravity compensation and to displaying a share of the follower's torque:
///
///     τ = Coriolis ± dither·|bias| + (I − J⁺J)·(−k_n·(q − q0) − d_n·q̇) + limits − damping·q̇
///
/// - Friction is dithered: below a speed, a share of gravity and Coriolis torque is added and taken in turn, a tick
///   each.
/// - A weak spring and damper act in the null space of J, the tool's motion in all six ways: towards the pose at the
///   first tick, without moving the tool. Six joints that are not singular have no such motion.
/// - Within a margin of a joint's limits: −k_l·(q − limit ± margin) − d_l·q̇.
///
/// Gains are as released for a Franka leader of Dynamixel motors; the released null-space target is a pose of that arm.
/// There the displayed share (`control.force_gain`) is 3.0/94.565 = 0.032, and gravity is carried by 0.99. Paper: J. J.
/// Liu, Y. Li, K. Shaw, T. Tao, R. Salakhutdinov, D. Pathak, FACTR: force-attending curriculum training for
/// contact-rich policy learning, arXiv 2502.17432, 2025, eq. 1 (torque feedback), 3 (null space), 7 (static friction),
/// Sec. IX.B (limits, of which the release has this simpler form). Code: FACTR_Teleop (Apache-2.0),
/// src/factr_teleop/factr_teleop/factr_teleop.py, configs/franka_example.yaml.
class FactrLaw {
 public:
  struct Params {
    double damping_N_m_s_per_rad = 0.0;
    double dither_share = 0.6;
    double dither_below_rad_per_s = 0.9;
    double null_space_stiffness_N_m_per_rad = 0.1;
    double null_space_damping_N_m_s_per_rad = 0.01;
    double limit_stiffness_N_m_per_rad = 1.03561658022;
    double limit_damping_N_m_s_per_rad = 0.04315069084;
    double limit_margin_rad = 0.1;
    static constexpr auto fields() {
      using P = Params;
      namespace u = arm::units;
      constexpr Unit stiffness{"N m/rad", "_N_m_per_rad"};
      return List{
          field("damping_N_m_s_per_rad", &P::damping_N_m_s_per_rad, u::newton_metre_second_per_radian,
                between(0.0, 50.0), "Damping of each joint, computed by the site and commanded over the bus."),
          field("dither_share", &P::dither_share, tactus::units::none, between(0.0, 1.0),
                "Amplitude of the dither torque against static friction, as a share of the joint's gravity and "
                "Coriolis torque."),
          field("dither_below_rad_per_s", &P::dither_below_rad_per_s, u::radian_per_second, between(0.0, 10.0),
                "Speed of a joint above which it is not dithered."),
          field("null_space_stiffness_N_m_per_rad", &P::null_space_stiffness_N_m_per_rad, stiffness,
                between(0.0, 100.0),
                "Stiffness toward the initial pose, in the joint motions that do not move the tool."),
          field("null_space_damping_N_m_s_per_rad", &P::null_space_damping_N_m_s_per_rad,
                u::newton_metre_second_per_radian, between(0.0, 50.0),
                "Damping in parallel with null_space_stiffness_N_m_per_rad."),
          field("limit_stiffness_N_m_per_rad", &P::limit_stiffness_N_m_per_rad, stiffness, between(0.0, 1000.0),
                "Stiffness of the spring that pushes a joint back from its limits."),
          field("limit_damping_N_m_s_per_rad", &P::limit_damping_N_m_s_per_rad, u::newton_metre_second_per_radian,
                between(0.0, 50.0), "Damping in parallel with limit_stiffness_N_m_per_rad."),
          field("limit_margin_rad", &P::limit_margin_rad, u::radian, between(0.0, 3.0),
                "Distance from a joint limit at which this spring starts to act.")};
    }
  };

  FactrLaw(const Params& params, const arm::Chain::Params& arm, const arm::Chain& chain);

  /// In N m, once a tick. Real-time safe.
  JointVector step(const ArmReading& reading) noexcept;

 private:
  [[nodiscard]] JointVector without_moving_the_tool(const JointVector& position, JointVector torque) const noexcept;

  Params params_;
  arm::Chain chain_;
  JointVector lower_;  ///< where limits begin to act
  JointVector upper_;
  bool started_ = false;
  JointVector target_;
  JointVector dither_sign_;
};

}  // namespace tactus::arm_control
