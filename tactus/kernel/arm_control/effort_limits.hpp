// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/chain.hpp>

#include <algorithm>

namespace tactus::arm_control {

/// The largest torque of each joint that is asked of its drive, either way, in N m: its effort limit, 100 at most.
inline arm::JointVector effort_limits(const arm::Chain::Params& arm) {
  constexpr double most_N_m = 100.0;
  arm::JointVector limits(static_cast<Eigen::Index>(arm.joints.size()));
  for (Eigen::Index i = 0; i < limits.size(); ++i) {
    limits[i] = std::min(most_N_m, arm.joints[static_cast<std::size_t>(i)].limits.effort_N_m);
  }
  return limits;
}

/// Real-time safe.
inline void saturate(arm::JointVector& torque, const arm::JointVector& limits) noexcept {
  for (Eigen::Index i = 0; i < torque.size(); ++i) torque[i] = std::clamp(torque[i], -limits[i], limits[i]);
}

}  // namespace tactus::arm_control
