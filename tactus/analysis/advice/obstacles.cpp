// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/advice/advise.hpp>
#include <tactus/analysis/advice/obstacles.hpp>
#include <tactus/simulation/teleoperator/parallel.hpp>

#include <algorithm>
#include <functional>
#include <utility>

namespace tactus::advice {

namespace {

using experiments::TappingParams;

constexpr double worth_it = 1.05;

/// An obstacle with what takes it away.
struct Attempt {
  Obstacle obstacle;
  Known known = {};
  std::function<void(TappingParams&)> change = {};
};

std::vector<Attempt> attempts_at(const Bench& bench, const TappingParams& params) {
  std::vector<Attempt> attempts;
  const auto& uncertain = bench.knowledge.parameters();
  for (std::size_t i = 0; i < uncertain.size(); ++i) {
    const Uncertain& one = uncertain[i];
    attempts.push_back({.obstacle = {.parameter = one.name,
                                     .unit = one.unit,
                                     .value = one.value,
                                     .interval_95 = one.interval_95,
                                     .instead = {},
                                     .limit = {}},
                        .known = {.one = i}});
  }
  if (!uncertain.empty()) {
    attempts.push_back(
        {.obstacle = {.parameter = all_uncertain, .unit = {}, .interval_95 = {}, .instead = {}, .limit = {}},
         .known = {.all = true}});
  }
  const auto try_instead = [&attempts](std::string key, const Unit& unit, double value, double instead,
                                       std::function<void(TappingParams&)> change) {
    if (value == instead) return;
    attempts.push_back({.obstacle = {.parameter = std::move(key),
                                     .unit = unit.symbol,
                                     .value = value,
                                     .interval_95 = {},
                                     .instead = instead,
                                     .limit = {}},
                        .change = std::move(change)});
  };
  const double limit_N = params.control.force_limit_N;
  try_instead("control.force_limit_N", units::newton, limit_N, 0.5 * limit_N,
              [limit_N](TappingParams& rig) { rig.control.force_limit_N = 0.5 * limit_N; });
  try_instead("channel.to_slave.delay_s", units::second, params.channel.to_slave.delay_s, 0.0,
              [](TappingParams& rig) { rig.channel.to_slave.delay_s = 0.0; });
  try_instead("channel.to_master.delay_s", units::second, params.channel.to_master.delay_s, 0.0,
              [](TappingParams& rig) { rig.channel.to_master.delay_s = 0.0; });
  const double stiffness = params.environment.stiffness_N_per_m;
  try_instead("environment.stiffness_N_per_m", units::newton_per_metre, stiffness, 0.5 * stiffness,
              [stiffness](TappingParams& rig) { rig.environment.stiffness_N_per_m = 0.5 * stiffness; });
  const double resolution_m = params.master.encoder.resolution_m;
  try_instead("master.encoder.resolution_m", units::metre, resolution_m, 0.25 * resolution_m,
              [resolution_m](TappingParams& rig) { rig.master.encoder.resolution_m = 0.25 * resolution_m; });
  const double bandwidth_Hz = params.slave.force_sensor.bandwidth_Hz;
  try_instead("slave.force_sensor.bandwidth_Hz", units::hertz, bandwidth_Hz, 2.0 * bandwidth_Hz,
              [bandwidth_Hz](TappingParams& rig) { rig.slave.force_sensor.bandwidth_Hz = 2.0 * bandwidth_Hz; });
  try_instead("slave.force_sensor.noise_rms_N", units::newton, params.slave.force_sensor.noise_rms_N, 0.0,
              [](TappingParams& rig) { rig.slave.force_sensor.noise_rms_N = 0.0; });
  return attempts;
}

template <class Among>
const Obstacle* best(const std::vector<Obstacle>& obstacles, const Candidate& candidate, const Among& among) {
  const Obstacle* found = nullptr;
  double most = worth_it * candidate.limit.gain;
  for (const Obstacle& obstacle : obstacles) {
    if (!among(obstacle) || obstacle.limit.gain < most) continue;
    if (found != nullptr && obstacle.limit.gain == most) continue;
    most = obstacle.limit.gain;
    found = &obstacle;
  }
  return found;
}

}  // namespace

Result<std::vector<Obstacle>> find_obstacles(const Bench& bench, const Candidate& candidate, const Draws& draws,
                                             const experiments::Progress& progress) {
  const auto params = params_of(bench, candidate.method, candidate.force_limit_N);
  if (!params) return params.error();
  std::vector<Attempt> attempts = attempts_at(bench, *params);
  simulation::for_each_in_parallel(
      attempts.size(),
      [&](std::size_t i) {
        Attempt& attempt = attempts[i];
        attempt.obstacle.limit = candidate.limit;
        TappingParams changed = *params;
        if (attempt.change) attempt.change(changed);
        Draws own = draws;
        own.known = attempt.known;
        auto trial = Trial::make(bench.knowledge, changed, own);
        if (!trial || candidate.limit.beyond_search) return;
        // What does not bring that much is not named.
        if (!trial->settles(std::min(worth_it * candidate.limit.gain, highest_gain))) return;
        const auto limit = trial->limit(candidate.limit.gain, highest_gain);
        if (limit.gain > candidate.limit.gain) attempt.obstacle.limit = limit;
      },
      progress);
  std::vector<Obstacle> obstacles;
  for (Attempt& attempt : attempts) obstacles.push_back(std::move(attempt.obstacle));
  return obstacles;
}

const Obstacle* largest(const std::vector<Obstacle>& obstacles, const Candidate& candidate) {
  return best(obstacles, candidate, [](const Obstacle&) { return true; });
}

const Obstacle* worth_measuring(const std::vector<Obstacle>& obstacles, const Candidate& candidate) {
  return best(obstacles, candidate, [](const Obstacle& obstacle) { return obstacle.interval_95.has_value(); });
}

}  // namespace tactus::advice
