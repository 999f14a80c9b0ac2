// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/arm_stability/arm_margins.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tactus::arm_stability {

/// So many models are drawn within `task.model_error`, as the first taps of the task draw theirs.
inline constexpr int models_drawn = 8;

/// An experiment of the kind arm-tapping, made linear.
struct ArmPoint {
  std::vector<std::string> joints;  ///< names of the leader's, for the follower's too
  double force_gain = 1.0;
  double hand_stiffness_N_per_m = 0.0;
  double model_error = 0.0;
  /// What the gains of the follower's drives come to at its tool, into a smooth wall, before any limit there:
  /// 1/(n·J·K⁻¹·Jᵀ·n).
  double follower_stiffness_N_per_m = 0.0;
  /// The first with exact models; behind it, with cancellation or an observer of elastic joints, those that were drawn.
  std::vector<ArmLoop> loops;
};

/// Reads the URDF from `folder` on. Errors: those of `experiments::ArmTaps::make` and of `ArmLoop::make`.
Result<ArmPoint> make_arm_point(const experiments::ArmTappingParams& params, const std::filesystem::path& folder,
                                const ArmLinearisation& linearisation);

/// The gain limit of a point, and what rings just beyond it.
struct ArmLimit {
  experiments::GainLimit exact;         ///< with an exact model
  experiments::GainLimit drawn;         ///< largest up to which it is stable with all drawn ones too
  std::optional<ArmMode> beyond_exact;  ///< none where the search ended first
  std::optional<ArmMode> beyond_drawn;  ///< of the drawn loop that grows fastest
};

/// Takes about 50 ms without and 0.3 s with drawn models. Not real-time safe.
ArmLimit limit_of(const ArmPoint& point);

/// "joint_4 of the leader".
std::string words_of(const ArmMode& mode, const std::vector<std::string>& joints);

}  // namespace tactus::arm_stability
