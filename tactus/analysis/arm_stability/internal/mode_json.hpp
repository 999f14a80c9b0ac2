// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/arm_stability/arm_margins.hpp>

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace tactus::arm_stability {

/// A mode in documents; null where there is none.
inline nlohmann::ordered_json mode_json(const std::optional<ArmMode>& mode, const std::vector<std::string>& joints) {
  if (!mode) return nullptr;
  return {{"frequency_Hz", mode->frequency_Hz},
          {"arm", mode->of_leader ? "leader" : "follower"},
          {"joint", joints[static_cast<std::size_t>(mode->joint)]},
          {"share_of_arm", mode->share}};
}

}  // namespace tactus::arm_stability
