// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/report/text.hpp>
#include <tactus/simulation/experiments/gain_limit.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

/// Gain limits and shares as the results of experiments write them.
namespace tactus::experiments {

inline std::string percent(const std::optional<double>& share) {
  return share ? report::number(100.0 * *share, 2) : std::string("–");
}

inline nlohmann::ordered_json json_of(const GainLimit& limit) {
  nlohmann::ordered_json object{{"gain_limit", limit.gain}};
  if (limit.censored()) object["gain_limit_censored"] = true;
  return object;
}

/// The share of taps that settled, and after which time, with `NAME_censored` where the window cut it off.
inline nlohmann::ordered_json json_of_settling(const TappingMetrics& metrics) {
  nlohmann::ordered_json object{{"settled_fraction", metrics.settled_fraction},
                                {"settling_time_median_s", metrics.settling_time_median_s}};
  if (metrics.settling_time_median_censored) object["settling_time_median_s_censored"] = true;
  object["settling_time_p90_s"] = metrics.settling_time_p90_s;
  if (metrics.settling_time_p90_censored) object["settling_time_p90_s_censored"] = true;
  return object;
}

inline nlohmann::ordered_json json_of(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

}  // namespace tactus::experiments
