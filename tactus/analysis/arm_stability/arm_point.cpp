// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/arm_stability/arm_point.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_taps.hpp>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace tactus::arm_stability {
namespace {

double into_the_wall(const experiments::ArmPairSetup& setup) {
  constexpr double least_N_m_per_rad = 1e-9;  ///< of a drive without gain
  const auto& follower = setup.params.control.follower;
  const auto chain = arm::Chain::make(setup.follower.arm.chain).value();
  const Eigen::MatrixXd tool =
      chain.jacobian(setup.follower.start, chain.joints() - 1, setup.follower.arm.tool_m).topRows<3>();
  const auto gains = follower.gains.of(setup.follower.joints.size());
  Eigen::MatrixXd softness = Eigen::MatrixXd::Zero(3, 3);
  for (Eigen::Index i = 0; i < tool.cols(); ++i) {
    const double stiffness = follower.stiffness_share * gains[static_cast<std::size_t>(i)].stiffness_N_m_per_rad;
    softness += tool.col(i) * tool.col(i).transpose() / std::max(stiffness, least_N_m_per_rad);
  }
  return 1.0 / setup.outward.dot(softness * setup.outward);
}

/// The fastest growing mode of some loops just beyond their limit.
std::optional<ArmMode> mode_beyond(std::span<const ArmLoop> loops, const experiments::GainLimit& limit) {
  constexpr double just_beyond = 1.006;
  if (limit.censored()) return std::nullopt;
  std::optional<ArmMode> fastest;
  for (const ArmLoop& loop : loops) {
    const ArmMode mode = slowest_mode(loop, just_beyond * limit.gain);
    if (!fastest || std::abs(mode.pole) > std::abs(fastest->pole)) fastest = mode;
  }
  return fastest;
}

}  // namespace

Result<ArmPoint> make_arm_point(const experiments::ArmTappingParams& params, const std::filesystem::path& folder,
                                const ArmLinearisation& linearisation) {
  experiments::ArmTappingParams drawing = params;
  drawing.task.taps = models_drawn;
  const auto taps = experiments::ArmTaps::make(drawing, folder);
  if (!taps) return taps.error();
  const experiments::ArmPairSetup& setup = taps->setup();
  ArmPoint point{.joints = setup.leader.joints,
                 .force_gain = params.control.force_gain,
                 .hand_stiffness_N_per_m = params.person.hand.stiffness_N_per_m,
                 .model_error = 0.0,
                 .follower_stiffness_N_per_m = into_the_wall(setup),
                 .loops = {}};
  std::vector<experiments::ArmModelParams> model_params{setup.exact};
  const auto& follower = params.control.follower;
  const bool believes = params.control.method == arm_control::ArmMethod::cancellation ||
                        (follower.torque == arm_control::TorqueSource::observer &&
                         follower.observer.joints == arm_control::JointModel::elastic);
  if (believes) point.model_error = params.task.model_error;
  for (std::size_t i = 0; point.model_error > 0.0 && i < taps->size(); ++i)
    model_params.push_back(taps->tap(i).model_params);
  for (const experiments::ArmModelParams& one : model_params) {
    auto loop = ArmLoop::make(setup, one, linearisation);
    if (!loop) return loop.error();
    point.loops.push_back(*std::move(loop));
  }
  return point;
}

ArmLimit limit_of(const ArmPoint& point) {
  const std::span<const ArmLoop> all(point.loops), exact = all.first(1);
  ArmLimit found;
  found.exact = gain_limit(exact);
  found.beyond_exact = mode_beyond(exact, found.exact);
  found.drawn = all.size() > 1 ? gain_limit(all) : found.exact;
  found.beyond_drawn = all.size() > 1 ? mode_beyond(all, found.drawn) : found.beyond_exact;
  return found;
}

std::string words_of(const ArmMode& mode, const std::vector<std::string>& joints) {
  return joints[static_cast<std::size_t>(mode.joint)] + " of the " + (mode.of_leader ? "leader" : "follower");
}

}  // namespace tactus::arm_stability
