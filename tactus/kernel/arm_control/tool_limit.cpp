// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/tool_limit.hpp>

#include <algorithm>

#include <Eigen/Eigenvalues>

namespace tactus::arm_control {
namespace {

constexpr double least_gain = 1e-9;      ///< of a joint that has one
constexpr double least_softness = 1e-9;  ///< of the tool, m/N or m/(N s)

}  // namespace

ToolLimit::ToolLimit(const arm::JointVector& gains, double most)
    : softness_(gains.cwiseMax(least_gain).cwiseInverse()), most_(most) {}

arm::Matrix3 ToolLimit::excess(const ToolJacobian& tool) const noexcept {
  const arm::Matrix3 softness = tool * softness_.asDiagonal() * tool.transpose();
  Eigen::SelfAdjointEigenSolver<arm::Matrix3> along;
  along.computeDirect(softness);
  const arm::Vector3 beyond =
      (along.eigenvalues().cwiseMax(least_softness).cwiseInverse().array() - most_).cwiseMax(0.0);
  return along.eigenvectors() * beyond.asDiagonal() * along.eigenvectors().transpose();
}

}  // namespace tactus::arm_control
