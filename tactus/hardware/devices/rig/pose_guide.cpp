// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/rig/pose_guide.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactus::devices {

namespace {

/// In which pose a joint is turned: the first joint is number 1, odd.
std::size_t pose_of(Eigen::Index joint) { return joint % 2 == 0 ? 1 : 2; }

}  // namespace

std::vector<arm::JointVector> guide_poses(const arm::Chain::Params& arm) {
  constexpr double margin_rad = 0.1, right_angle_rad = 0.5 * std::numbers::pi;
  const auto joints = static_cast<Eigen::Index>(arm.joints.size());
  std::vector<arm::JointVector> poses(3, arm::JointVector::Zero(joints));
  for (Eigen::Index i = 0; i < joints; ++i) {
    const arm::JointLimits& limits = arm.joints[static_cast<std::size_t>(i)].limits;
    const double middle_rad = 0.5 * (limits.lower_rad + limits.upper_rad);
    const double lowest_rad = std::min(limits.lower_rad + margin_rad, middle_rad),
                 highest_rad = std::max(limits.upper_rad - margin_rad, middle_rad);
    const double first_rad = std::clamp(0.0, lowest_rad, highest_rad);
    const double up_rad = std::min(right_angle_rad, highest_rad - first_rad),
                 down_rad = std::min(right_angle_rad, first_rad - lowest_rad);
    for (arm::JointVector& pose : poses) pose[i] = first_rad;
    poses[pose_of(i)][i] += up_rad >= down_rad ? up_rad : -down_rad;
  }
  return poses;
}

std::vector<GuideFinding> judge_poses(std::span<const arm::JointVector> poses, std::span<const arm::JointVector> read) {
  constexpr double moved_share = 0.3, least_ratio = 0.7, most_ratio = 1.0 / least_ratio, zero_rad = 0.25,
                   placed_rad = 0.21;
  const Eigen::Index joints = poses[0].size();
  const auto expected = [&](Eigen::Index i) { return poses[pose_of(i)][i] - poses[0][i]; };
  /// How far joint i turned by its reading in the pose in which joint `with` is turned.
  const auto turned = [&](Eigen::Index i, Eigen::Index with) { return read[pose_of(with)][i] - read[0][i]; };
  const auto moves = [&](Eigen::Index i, Eigen::Index with) {
    return std::fabs(turned(i, with)) > moved_share * std::fabs(expected(with));
  };
  std::vector<GuideFinding> found(static_cast<std::size_t>(joints));
  for (Eigen::Index i = 0; i < joints; ++i) {
    GuideFinding& finding = found[static_cast<std::size_t>(i)];
    finding = {.fault = GuideFault::none, .expected_rad = expected(i), .read_rad = turned(i, i)};
    if (!moves(i, i)) {
      finding.fault = GuideFault::unmoved;
      // The nearest one of the other pose that has not moved either reads this one's motion.
      Eigen::Index nearest = -1;
      for (Eigen::Index j = 0; j < joints; ++j) {
        if (pose_of(j) == pose_of(i) || moves(j, j) || !moves(i, j) || !moves(j, i)) continue;
        if (nearest < 0 || std::abs(j - i) < std::abs(nearest - i)) nearest = j;
      }
      if (nearest < 0) continue;
      finding.fault = GuideFault::swapped;
      finding.other = static_cast<std::size_t>(nearest);
      continue;
    }
    const double ratio = finding.read_rad / finding.expected_rad;
    if (ratio < 0.0) {
      finding.fault = GuideFault::direction;
    } else if ((ratio < least_ratio || ratio > most_ratio) &&
               std::fabs(finding.read_rad - finding.expected_rad) > placed_rad) {
      finding.fault = GuideFault::gear;
    } else if (std::fabs(read[0][i] - poses[0][i]) > zero_rad) {
      finding = {.fault = GuideFault::zero, .expected_rad = poses[0][i], .read_rad = read[0][i]};
    }
  }
  return found;
}

}  // namespace tactus::devices
