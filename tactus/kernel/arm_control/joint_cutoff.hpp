// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm_control/each_joint.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <string>

namespace tactus::arm_control {

/// `inconsistent`, under the key at fault, unless the corner of all and those of single joints lie below half the
/// sample rate. The keys: `of_all`, and those of `of_each`. Not real-time safe.
inline Check check_cutoffs(const std::string& of_all, double cutoff_Hz, const std::string& of_each,
                           const EachJoint<JointCutoff>& each, int joints, Seconds dt) {
  if (Check wrong = signal::check_below_nyquist(of_all, cutoff_Hz, dt)) return wrong;
  const arm::JointVector own_Hz = each.of(joints, &JointCutoff::cutoff_Hz);
  for (int i = 0; i < joints; ++i) {
    const std::string key = of_each + ".joint_" + std::to_string(i + 1) + ".cutoff_Hz";
    if (Check wrong = signal::check_below_nyquist(key, own_Hz[i], dt)) return wrong;
  }
  return std::nullopt;
}

}  // namespace tactus::arm_control
