// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/chain.hpp>
#include <tactus/kernel/signal/low_pass.hpp>

#include <optional>

namespace tactus::arm_control {

/// A first-order low-pass (`signal::LowPass`) on each joint, or none at 0 Hz.
class JointLowPass {
 public:
  /// Errors: those of `signal::LowPass::make`.
  static Result<JointLowPass> make(const arm::JointVector& cutoff_Hz, Seconds dt) {
    JointLowPass made;
    for (Eigen::Index i = 0; i < cutoff_Hz.size(); ++i) {
      if (cutoff_Hz[i] == 0.0) continue;
      const auto one = signal::LowPass::make({.cutoff_Hz = cutoff_Hz[i]}, dt);
      if (!one) return one.error();
      made.each_[static_cast<std::size_t>(i)] = *one;
    }
    return made;
  }
  /// Real-time safe.
  arm::JointVector step(arm::JointVector value) noexcept {
    for (Eigen::Index i = 0; i < value.size(); ++i) {
      if (auto& filter = each_[static_cast<std::size_t>(i)]) value[i] = filter->step(value[i]);
    }
    return value;
  }
  /// As after a long rest there. Real-time safe.
  void settle(const arm::JointVector& value) noexcept {
    for (Eigen::Index i = 0; i < value.size(); ++i) {
      if (auto& filter = each_[static_cast<std::size_t>(i)]) filter->settle(value[i]);
    }
  }

 private:
  Joints<std::optional<signal::LowPass>> each_ = Joints<std::optional<signal::LowPass>>(most_joints);
};

}  // namespace tactus::arm_control
