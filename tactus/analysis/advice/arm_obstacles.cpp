// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/advice/arm_trial.hpp>
#include <tactus/analysis/advice/internal/arm_obstacles.hpp>
#include <tactus/simulation/teleoperator/parallel.hpp>

#include <algorithm>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace tactus::advice {

namespace {

/// What can be taken away of a method's way, and how.
std::vector<ArmObstacle> possible_obstacles(const ArmBench& bench, const experiments::ArmTappingParams& params) {
  std::vector<ArmObstacle> all;
  const auto add = [&](std::string words, experiments::Settings set) {
    all.push_back({.words = std::move(words), .set = std::move(set), .limit = {}});
  };
  const bool elastic = has_elastic_follower(params);
  const bool models = params.control.method == arm_control::ArmMethod::cancellation;
  if ((models || elastic) && params.task.model_error > 0.0)
    add("an exact model of the arm", {{"task.model_error", "0"}});
  if (params.control.follower.torque == arm_control::TorqueSource::observer &&
      params.control.method != arm_control::ArmMethod::four_channel) {
    add("a sensor of torque in the follower's joints", {{"control.follower.torque", "sensor"}});
  }
  if (elastic) {
    add("rigid joints of the follower", {{params.arm.follower.urdf.empty() ? "arm.joint_stiffness_N_m_per_rad"
                                                                           : "arm.follower.joint_stiffness_N_m_per_rad",
                                          "0"},
                                         {"control.model.joints", "rigid"},
                                         {"control.follower.observer.joints", "rigid"}});
  }
  add("a bus twice as fast", {{"servo.rate_Hz", format_number(2.0 * params.servo.rate_Hz)}});
  add("a surface half as stiff", {{"wall.stiffness_N_per_m", format_number(0.5 * params.wall.stiffness_N_per_m)}});
  std::erase_if(all, [&bench](const ArmObstacle& one) { return bench.given.contains(one.set.front().first); });
  return all;
}

}  // namespace

Check look_for_obstacles(const ArmBench& bench, const ArmDraws& draws, ArmAdvice& advice,
                         const experiments::Progress& progress) {
  const ArmCandidate& start = *advice.start;
  if (start.limit.beyond_search) return {};
  const auto params = params_of(bench, start.method);
  if (!params) return params.error();
  auto trial = ArmTrial::make(bench, *params, draws);
  if (!trial) return trial.error();
  const double beyond = std::min(std::numbers::sqrt2 * start.limit.gain, highest_arm_gain);
  std::vector<std::size_t> failed;
  if (!trial->settles(beyond)) {
    failed = trial->failed_last();
    advice.fault = {beyond, trial->tried()[failed.front()], trial->fault(beyond, failed.front())};
  }
  advice.obstacles = possible_obstacles(bench, *params);
  simulation::for_each_in_parallel(
      advice.obstacles.size(),
      [&](std::size_t i) {
        ArmObstacle& obstacle = advice.obstacles[i];
        obstacle.limit = start.limit;
        const auto changed = params_of(bench, start.method, obstacle.set);
        if (!changed) return;
        auto other = ArmTrial::make(bench, *changed, draws);
        if (!other) return;
        constexpr int steps = 3;
        double gain = beyond;
        for (int k = 0; k < steps && gain > obstacle.limit.gain; ++k) {
          if (!other->at(gain, other->may_fail(), failed).whole) return;
          obstacle.limit.gain = gain;
          gain = std::min(std::numbers::sqrt2 * gain, highest_arm_gain);
        }
        obstacle.limit.beyond_search = true;
      },
      [&progress](double done) { progress(0.9 + 0.1 * done); });
  std::stable_sort(advice.obstacles.begin(), advice.obstacles.end(),
                   [](const ArmObstacle& a, const ArmObstacle& b) { return a.limit.gain > b.limit.gain; });
  return {};
}

}  // namespace tactus::advice
