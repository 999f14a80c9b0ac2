// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/chain.hpp>
#include <tactus/kernel/core/result.hpp>

namespace tactus::arm_control {

using arm::JointVector;

/// What an observer of external torque reports although nothing touches the arm, because the masses of its model are
/// wrong: it changes with the pose, so it is followed by the distance that the tool travels, never by time. Each metre
/// of travel takes the bias nearer to the estimate behind a low-pass of 2 Hz; at rest, and while the tool presses, it
/// stays whatever the estimate does, so that a contact however slow is not taken for it.
///
/// Travel counts if the tool is faster than 30 mm/s (steps of a drive's velocity look like less) and no joint is in
/// contact: its torque less the bias is within its Coulomb friction and a hundredth of its effort limit. The bias is
/// never more than a twentieth of that limit. It starts at 0. A surface that is touched so lightly and slid along
/// fades.
class TorqueBias {
 public:
  /// `distance_m` for 63 %; 0 follows nothing.
  TorqueBias(double distance_m, const arm::Chain::Params& arm, Seconds dt);

  [[nodiscard]] bool follows() const noexcept { return distance_m_ > 0.0; }
  /// Once a tick: the estimate in N m and the tool's speed. Returns the bias in N m. Real-time safe.
  const JointVector& step(const JointVector& external, double tool_m_per_s) noexcept;

 private:
  double distance_m_;
  double dt_s_;
  double passed_;  ///< of the low-pass
  JointVector touch_N_m_;
  JointVector most_N_m_;
  JointVector slow_;
  JointVector bias_;
};

}  // namespace tactus::arm_control
