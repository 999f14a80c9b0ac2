#pragma once

#include <tactus/experiments/gain_limit.hpp>
#include <tactus/report/text.hpp>

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

/// Gain limits and shares as the results of experiments write them.
namespace tactus::experiments {

inline std::string percent(const std::optional<double>& share) {
  return share ? report::number(100.0 * *share, 2) : std::string("–");
}

inline nlohmann::ordered_json json_of(const GainLimit& limit) {
  return {{"gain_limit", limit.gain}, {"beyond_search", limit.beyond_search}};
}

inline nlohmann::ordered_json json_of(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

}  // namespace tactus::experiments
