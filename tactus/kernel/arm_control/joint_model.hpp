// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/chain.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <array>

namespace tactus::arm_control {

/// What a model takes the joints for.
enum class JointModel { rigid, elastic };
constexpr auto enumerators(JointModel) {
  return std::array{Enumerator{JointModel::rigid, "rigid"}, Enumerator{JointModel::elastic, "elastic"}};
}

/// `inconsistent`, under `joints`, unless each of `joints` joints has a stiffness above zero, in N m/rad.
inline Check check_stiffness(const arm::JointVector& stiffness_N_m_per_rad, int joints) {
  if (stiffness_N_m_per_rad.size() == joints && (stiffness_N_m_per_rad.array() > 0.0).all()) return std::nullopt;
  return Error{.code = ErrorCode::inconsistent,
               .parameter = "joints",
               .message = "a model of elastic joints needs the stiffness of each: state it, or take them for rigid",
               .place = {}};
}

}  // namespace tactus::arm_control
