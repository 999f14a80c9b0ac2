// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/motors.hpp>
#include <tactus/kernel/arm_control/joint_low_pass.hpp>
#include <tactus/kernel/arm_control/tool_limit.hpp>
#include <tactus/kernel/core/parameters.hpp>

namespace tactus::arm_control {

using arm::ArmReading;
using arm::JointVector;

/// Torque of the motion that the leader wants, so that a follower whose drives are soft at the tool lags no more than a
/// stiff one:
///
///     τ = (1 − s)·(M(q)·a + viscous·v + Coulomb·tanh(v/v1))
///
/// v and a are the velocity that the leader sends and its derivative, both behind a Butterworth low-pass of second
/// order whose states they are. No part of it is the follower's own motion but the slow M(q), so it closes no loop in
/// free motion. (Friction that is made good by the measured velocity does, and halves the gain that settles.)
///
/// In contact it would: v is where the operator goes, not where the arm can go, and what it pushes comes back as force.
/// So s, 1 in contact and 0 away from it, takes it away. A joint is in contact whose torque from outside, behind a
/// low-pass of 10 Hz, exceeds twice its Coulomb friction and a hundredth of its effort limit; s then rises within 3 ms.
/// It falls by 1/e for each 0.15 m that the tool goes without contact: a tool that bounces off is still close to what
/// it bounced off.
///
/// Gravity and Coriolis torque are not in it: `FeedForward` compensates gravity, and Coriolis torque is small where
/// arms follow a hand.
class WantedMotion {
 public:
  struct Params {
    double cutoff_Hz = 0.0;
    static constexpr auto fields() {
      return List{field("cutoff_Hz", &Params::cutoff_Hz, tactus::units::hertz, between(0.0, 50.0),
                        "-3 dB frequency of the low-pass on the velocity that the leader sends, at most half the "
                        "sample rate; 0: no feed-forward.")};
    }
  };
  /// What it assumes of the follower.
  struct Arm {
    const arm::Chain::Params& params;
    const arm::Chain& chain;
    arm::Vector3 tool_m;  ///< on its last link
  };

  /// `friction_velocity_rad_per_s` is v1. Errors: a cutoff out of bounds or beyond half the sample rate.
  static Result<WantedMotion> make(const Params& params, double friction_velocity_rad_per_s, const Arm& arm,
                                   Seconds dt);

  [[nodiscard]] bool adds() const noexcept { return corner_rad_per_s_ > 0.0; }
  /// In N m, where it adds any. Once a tick: `wanted` is the velocity that the leader sends, `external` the torque from
  /// outside in N m, without a dead band. Real-time safe.
  JointVector step(const ArmReading& reading, const JointVector& wanted, const JointVector& external) noexcept;

 private:
  WantedMotion(const Params& params, double friction_velocity_rad_per_s, const Arm& arm, const JointLowPass& low_pass,
               Seconds dt);
  void follow(const JointVector& wanted) noexcept;
  void look_for_contact(const ArmReading& reading, const JointVector& external) noexcept;

  arm::Chain chain_;
  arm::Vector3 tool_m_;
  Joints<arm::JointFriction> friction_;
  double friction_velocity_rad_per_s_;
  double corner_rad_per_s_;
  double dt_s_;
  JointVector velocity_;      ///< v
  JointVector acceleration_;  ///< a
  JointLowPass external_;
  JointVector touch_N_m_;  ///< of it, beyond which a joint is in contact
  double contact_ = 0.0;   ///< s
};

}  // namespace tactus::arm_control
