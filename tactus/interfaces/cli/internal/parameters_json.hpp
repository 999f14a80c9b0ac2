// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/arm/parameters.hpp>

#include <vector>

#include <nlohmann/json.hpp>

namespace tactus::cli {

/// The numbers of one joint of an arm, as `identify arm` and `identify excitation` print them.
inline nlohmann::ordered_json parameters_json(const std::vector<arm_identification::ArmParameter>& parameters) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const arm_identification::ArmParameter& p : parameters) {
    all.push_back({{"name", p.name},
                   {"value", p.value},
                   {"unit", p.unit},
                   {"interval_95", {p.lower, p.upper}},
                   {"determined", p.determined}});
  }
  return all;
}

}  // namespace tactus::cli
