// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/chain.hpp>
#include <tactus/kernel/arm_control/tool_limit.hpp>
#include <tactus/kernel/core/result.hpp>

namespace tactus::arm_control {

using arm::JointMatrix;
using arm::JointVector;

/// Leaves slow free motion undamped. The dampers D of a leader, those of its drives with those over the bus, resist
/// whatever moves it; what they do to slow motion is given back over the bus:
///
///     τ = L·D·v_slow,    L = 1 − s·Jᵀn·nᵀ(J·Jᵀ)⁻¹·J,
///
/// with v_slow the joints' velocity behind a first-order low-pass at `washout_Hz`. In free motion s is 0, and the net
/// damper D·p/(p + ω) is one in series with a spring (Maxwell's element): passive, D above the corner and nothing at
/// rest. In contact s is 1, and along the contact's normal n the dampers act at every frequency, since that is what
/// stops the leader from being thrown back; across it they do not. A joint of the follower is in contact if its torque
/// from outside exceeds a hundredth of its effort limit. Then s rises within 3 ms; it falls by 1/e in 0.3 s. n is the
/// direction of the force at the tool whose torques come nearest to those.
class WashedDamping {
 public:
  /// At 0 Hz nothing is given back. `effort_limit` has one for each joint that the leader receives, in N m.
  WashedDamping(double washout_Hz, const JointVector& effort_limit, Seconds dt);

  [[nodiscard]] bool washes() const noexcept { return washed_ > 0.0; }
  /// Once a tick: where the leader moves, D as a matrix of its joints in N m s/rad, its velocity, and the follower's
  /// torque from outside in N m. Returns τ in N m. Real-time safe.
  JointVector step(const ToolJacobian& tool, const JointMatrix& dampers, const JointVector& velocity,
                   const JointVector& external) noexcept;
  /// L at the latest tick.
  [[nodiscard]] const JointMatrix& left() const noexcept { return left_; }
  /// s at the latest tick.
  [[nodiscard]] double contact() const noexcept { return contact_; }

 private:
  double dt_s_;
  double washed_;  ///< from tick to tick
  double faded_;   ///< of s, from tick to tick without contact
  JointVector touch_N_m_;
  JointVector slow_;
  double contact_ = 0.0;
  arm::Vector3 force_N_ = arm::Vector3::Zero();  ///< low-passed, for its direction
  JointMatrix left_;
};

}  // namespace tactus::arm_control
