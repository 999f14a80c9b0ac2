// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/arm_stability/arm_map.hpp>
#include <tactus/simulation/teleoperator/parallel.hpp>

#include <filesystem>
#include <utility>

namespace tactus::arm_stability {

Result<ArmMap> map_arms(const ArmMapRequest& request, const experiments::Progress& progress) {
  ArmMap map;
  std::vector<ArmPoint> points;
  for (const ArmMapHand& hand : request.hands) {
    experiments::Request varied = hand.request;
    varied.variations = request.variations;
    if (varied.variations.empty()) {
      varied.variations = {{"task.direction", {"down", "along-x", "along-y"}},
                           {"control.method", {"position-force", "cancellation"}},
                           {"task.pose", {"0", "1", "2", "3", "4", "5"}}};
    }
    const std::filesystem::path folder = std::filesystem::path(varied.document.name()).parent_path();
    auto cases = experiments::prepare_cases<experiments::ArmTappingParams, ArmPoint>(
        varied, [&](const experiments::ArmTappingParams& params) {
          return make_arm_point(params, folder, {.friction_speed_rad_per_s = request.friction_speed_rad_per_s});
        });
    if (!cases) return cases.error();
    if (map.points.empty()) map.configuration = cases->first_configuration;
    for (auto& one : cases->all) {
      map.points.push_back({.hand = map.hands.size(),
                            .settings = one.settings,
                            .joints = one.prepared.joints,
                            .hand_stiffness_N_per_m = one.prepared.hand_stiffness_N_per_m,
                            .limit = {}});
      points.push_back(std::move(one.prepared));
    }
    map.hands.push_back(hand.name);
  }
  simulation::for_each_in_parallel(
      points.size(), [&](std::size_t i) { map.points[i].limit = limit_of(points[i]); }, progress);
  return map;
}

}  // namespace tactus::arm_stability
