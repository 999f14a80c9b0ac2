// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/arm_stability/arm_point.hpp>
#include <tactus/simulation/experiments/experiment.hpp>

#include <optional>
#include <string>
#include <vector>

/// Maps of the linear limit of two arms over poses, directions, hands and whatever else a file states.
namespace tactus::arm_stability {

/// The same experiment in another hand.
struct ArmMapHand {
  std::string name;
  experiments::Request request;  ///< with the hand's file in its document; its variations are not looked at
};

/// What a map is asked for.
struct ArmMapRequest {
  std::vector<ArmMapHand> hands;                   ///< one at least
  std::vector<experiments::Variation> variations;  ///< none: poses 0 to 5, three directions, both methods
  double friction_speed_rad_per_s = 0.0;
};

struct ArmMapPoint {
  std::size_t hand = 0;
  experiments::Settings settings;
  std::vector<std::string> joints;
  double hand_stiffness_N_per_m = 0.0;
  ArmLimit limit;
};

struct ArmMap {
  std::vector<std::string> hands;
  std::vector<ArmMapPoint> points;  ///< hand slowest, then the first key
  std::string configuration;        ///< of the first point, as TOML
};

/// Every point, on all cores. Equal requests give equal results. Errors: those of `prepare_cases` and `make_arm_point`.
Result<ArmMap> map_arms(const ArmMapRequest& request, const experiments::Progress& progress);

/// The map for every reader.
struct ArmMapReport {
  experiments::Outcome outcome;
  std::string csv;                 ///< a line a point
  std::optional<std::string> svg;  ///< none where no two keys, or key and hands, span a plane
};
ArmMapReport report_arm_map(const ArmMap& map, const experiments::Request& request, double friction_speed_rad_per_s);

}  // namespace tactus::arm_stability
