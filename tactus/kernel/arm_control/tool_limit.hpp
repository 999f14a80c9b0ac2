// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/chain.hpp>

namespace tactus::arm_control {

/// Velocity of the tool's point for one rad/s of each joint, m/s along the axes of the base.
using ToolJacobian = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, arm::most>;

/// Keeps what drives come to at the tool within a limit, in every direction alike.
///
/// Gains G of the joints, all of stiffness (N m/rad) or all of damping (N m s/rad), are (J·G⁻¹·Jᵀ)⁻¹ at the tool: as
/// uneven as the pose, and without bound near a singular one. `excess` is that matrix with each eigenvalue less the
/// limit, and 0 for one within it; a joint without gain leaves the tool free. G − Jᵀ·excess·J then is exactly the limit
/// at the tool where G alone is beyond it, is what G is where it is not, and never is below zero (Woodbury). It is
/// continuous in the pose, and bounded by G where J loses a rank. Drives take gains of each joint alone, so the site
/// takes the excess away by torques over the bus: late by its delay, which for what is taken away damps.
class ToolLimit {
 public:
  /// `most`, 0 for no limit, is in N/m or N s/m.
  ToolLimit(const arm::JointVector& gains, double most);

  [[nodiscard]] bool limits() const noexcept { return most_ > 0.0; }
  /// In N/m or N s/m, along the axes of the base; symmetric. Real-time safe.
  [[nodiscard]] arm::Matrix3 excess(const ToolJacobian& tool) const noexcept;

 private:
  arm::JointVector softness_;  ///< inverse of the gains
  double most_;
};

}  // namespace tactus::arm_control
