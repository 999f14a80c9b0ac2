// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/advice/arm_trial.hpp>
#include <tactus/simulation/teleoperator/parallel.hpp>
#include <tactus/simulation/teleoperator/quantile.hpp>

#include <algorithm>
#include <numbers>
#include <utility>

namespace tactus::advice {

namespace {

/// The bracket's ends of a search in steps of √2 are so far apart: it does not go on between them.
constexpr double arm_step = 1.42;
constexpr double coarse_arm_step_s = 2.5e-4, brief_s = 0.4;

experiments::ArmTappingParams in_hand(const ArmBench& bench, experiments::ArmTappingParams params, std::size_t hand) {
  params.person.hand = bench.hands[hand].hand;
  params.task.taps = 1;
  return params;
}

}  // namespace

std::vector<Situation> situations(const ArmBench& bench, const ArmDraws& draws) {
  constexpr std::int64_t seeds = 1'000'000;
  const std::int64_t base = bench.as_given.task.seed % seeds * seeds + draws.first_seed;
  std::vector<std::int64_t> poses;
  if (draws.own_pose) poses.push_back(bench.poses.front());
  for (std::size_t i = draws.first_pose; i < std::min(bench.poses.size(), draws.first_pose + draws.poses); ++i) {
    poses.push_back(bench.poses[i]);
  }
  std::vector<Situation> all;
  const auto add = [&](std::size_t hand, std::int64_t pose, experiments::TapDirection direction) {
    all.push_back({hand, pose, direction, base + static_cast<std::int64_t>(all.size())});
  };
  for (const std::int64_t pose : poses) {
    for (const auto direction : bench.directions) {
      for (std::size_t hand = 0; hand < bench.hands.size(); ++hand) add(hand, pose, direction);
    }
  }
  for (std::size_t i = 0; i < draws.own_taps; ++i) {
    const auto direction = bench.directions[i % bench.directions.size()];
    for (std::size_t hand = 0; hand < bench.hands.size(); ++hand) add(hand, bench.poses.front(), direction);
  }
  return all;
}

std::string words_of(const ArmBench& bench, const Situation& situation) {
  return (bench.hands[situation.hand].name == "yours" ? "in your hand, " : "in a light grip, ") +
         std::string(name_of(situation.direction)) + ", pose " + std::to_string(situation.pose);
}

Result<ArmTrial> ArmTrial::make(const ArmBench& bench, const experiments::ArmTappingParams& params,
                                const ArmDraws& draws) {
  return make(bench, params, situations(bench, draws), draws);
}

Result<ArmTrial> ArmTrial::make(const ArmBench& bench, const experiments::ArmTappingParams& params,
                                std::vector<Situation> taps, const ArmDraws& detail) {
  ArmTrial trial;
  trial.bench_ = &bench;
  trial.params_ = params;
  if (detail.coarse) trial.params_.servo.plant_step_s = std::max(params.servo.plant_step_s, coarse_arm_step_s);
  if (detail.brief) trial.params_.task.observation_s = std::min(params.task.observation_s, brief_s);
  trial.situations_ = std::move(taps);
  trial.taps_.resize(trial.situations_.size());
  if (const auto first = trial.made(0); !first) return first.error();
  return trial;
}

Result<experiments::ArmTaps> ArmTrial::made(std::size_t tap) const {
  const Situation& situation = situations_[tap];
  experiments::ArmTappingParams one = in_hand(*bench_, params_, situation.hand);
  one.task.pose = situation.pose;
  one.task.direction = situation.direction;
  one.task.seed = situation.seed;
  return experiments::ArmTaps::make(one, bench_->folder);
}

experiments::ArmTapResult ArmTrial::run(double gain, std::size_t tap) {
  if (gain != gain_) {
    for (Tap& each : taps_) each.result.reset();
    gain_ = gain;
  }
  Tap& one = taps_[tap];
  if (one.result) return *one.result;
  if (!one.taps) {
    auto taps = made(tap);
    if (!taps) return {};
    one.taps = *std::move(taps);
    one.without_display = one.taps->run_without_display(0);
  }
  one.result = one.taps->run_at(gain, 0, one.without_display);
  return *one.result;
}

std::size_t ArmTrial::failures_among(const std::vector<std::size_t>& taps, double gain) {
  std::size_t failed = 0;
  for (const std::size_t tap : taps) failed += run(gain, tap).settled() ? 0U : 1U;
  return failed;
}

ArmScore ArmTrial::at(double gain, std::size_t most_failures, const std::vector<std::size_t>& first) {
  std::vector<std::size_t> order = first;
  for (std::size_t i = 0; i < taps_.size(); ++i) {
    if (std::find(first.begin(), first.end(), i) == first.end()) order.push_back(i);
  }
  ArmScore score;
  std::vector<std::vector<double>> felt(bench_->hands.size());
  for (const std::size_t i : order) {
    const experiments::ArmTapResult result = run(gain, i);
    felt[situations_[i].hand].push_back(result.contact.felt_share);
    if (result.settled()) continue;
    score.failed.push_back(i);
    if (score.failed.size() > most_failures) return score;
  }
  score.whole = true;
  for (std::vector<double>& shares : felt) score.felt.push_back(simulation::quantile(shares, 0.5));
  score.presence = *std::min_element(score.felt.begin(), score.felt.end());
  return score;
}

bool ArmTrial::settles(double gain) {
  const ArmScore score = at(gain, may_fail(), failed_last_);
  if (!score.whole) failed_last_ = score.failed;
  return score.whole;
}

experiments::GainLimit ArmTrial::limit(double lowest, double highest) {
  return experiments::find_gain_limit(
      lowest, highest, [this](double gain) { return settles(gain); }, arm_step);
}

experiments::GainLimit ArmTrial::limit_near(double near, double lowest, double highest) {
  const auto up_to = [this, lowest](double gain) {
    for (const double share : {1.0, 0.5, 0.25}) {
      if (share * gain >= lowest && !settles(share * gain)) return false;
    }
    return true;
  };
  double gain = near;
  while (!up_to(gain)) {
    if (gain == lowest) return {};
    gain = std::max(gain / std::numbers::sqrt2, lowest);
  }
  while (gain >= near) {
    if (gain >= highest) return {.gain = highest, .beyond_search = true};
    const double next = std::min(gain * std::numbers::sqrt2, highest);
    if (!settles(next)) break;
    gain = next;
  }
  return {.gain = gain};
}

std::string ArmTrial::fault(double gain, std::size_t situation) {
  const experiments::ArmTapResult result = run(gain, situation);
  if (result.settled()) return "settles";
  if (result.diverged || result.ran_away) return "runs away";
  return result.contact.touched ? "rings" : "does not touch";
}

bool fails_with_those_alike(const ArmBench& bench, const experiments::ArmTappingParams& params, const Situation& tap,
                            double gain, const ArmDraws& detail) {
  constexpr std::int64_t beyond_any_draw = 100'000;
  std::vector<Situation> alike(4, tap);
  for (std::size_t i = 1; i < alike.size(); ++i) alike[i].seed += static_cast<std::int64_t>(i) * beyond_any_draw;
  auto trial = ArmTrial::make(bench, params, alike, detail);
  if (!trial) return true;
  return trial->failures_among({0}, gain) > 0 && trial->failures_among({1, 2, 3}, gain) > 0;
}

Result<std::vector<experiments::ArmReach>> reaches(const ArmBench& bench, const experiments::ArmTappingParams& params) {
  const std::size_t hands = bench.hands.size();
  std::vector<Result<experiments::ArmReach>> found(bench.directions.size() * hands, experiments::ArmReach{});
  simulation::for_each_in_parallel(
      found.size(),
      [&](std::size_t i) {
        experiments::ArmTappingParams one = in_hand(bench, params, i % hands);
        one.task.direction = bench.directions[i / hands];
        const auto taps = experiments::ArmTaps::make(one, bench.folder);
        found[i] = taps ? Result<experiments::ArmReach>(taps->reach()) : taps.error();
      },
      [](double) {});
  std::vector<experiments::ArmReach> all;
  for (const auto& one : found) {
    if (!one) return one.error();
    all.push_back(*one);
  }
  return all;
}

}  // namespace tactus::advice
