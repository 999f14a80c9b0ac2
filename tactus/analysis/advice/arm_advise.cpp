// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/advice/advise.hpp>
#include <tactus/analysis/advice/arm_advise.hpp>
#include <tactus/analysis/advice/arm_trial.hpp>
#include <tactus/analysis/advice/internal/arm_climb.hpp>
#include <tactus/analysis/advice/internal/arm_costs.hpp>
#include <tactus/analysis/advice/internal/arm_obstacles.hpp>
#include <tactus/simulation/teleoperator/parallel.hpp>

#include <algorithm>
#include <utility>

namespace tactus::advice {

namespace {

using experiments::ArmReach;
using experiments::ArmTappingParams;
using experiments::GainLimit;
using experiments::Progress;

/// Taps of each stage; what confirms an answer has seen no search.
constexpr ArmDraws alone{.first_seed = 0, .poses = 0, .brief = true};
constexpr ArmDraws settling{.first_seed = 2000, .first_pose = 2, .poses = 2, .own_taps = 1};
constexpr ArmDraws unseen{
    .first_seed = 3000, .first_pose = 1, .poses = most_poses, .own_pose = false, .own_taps = 8, .coarse = false};
/// Of each hand where `--set` leaves one pose, in place of the others.
constexpr std::size_t settling_at_one_pose = 7, unseen_at_one_pose = 19;
constexpr std::size_t farthest_taken = 2;  // configurations of the climb that are tried to the end
constexpr double nearly_as_much = 0.9;

ArmDraws for_bench(const ArmBench& bench, ArmDraws draws) {
  if (bench.poses.size() > 1) return draws;
  if (draws.own_taps > 0) draws.own_taps = draws.own_pose ? settling_at_one_pose : unseen_at_one_pose;
  draws.own_pose = true;
  return draws;
}

double rounded_below(double value) {
  const double near = rounded(value);
  return near > value ? rounded(value * (1.0 - 5e-3)) : near;
}

class ArmSearch {
 public:
  ArmSearch(const ArmBench& bench, const Progress& progress) : bench_(bench), progress_(progress) {}

  Result<ArmAdvice> run() {
    if (auto error = prepare()) return *std::move(error);
    if (auto error = try_alone()) return *std::move(error);
    ArmClimb climb(bench_, *costs_, dimensions_, progress_);
    if (auto error = climb.run()) return *std::move(error);
    gather(climb.steps());
    if (auto error = try_to_the_end()) return *std::move(error);
    return conclude(climb.changes());
  }

 private:
  Check prepare() {
    for (const Dimension& dimension : arm_dimensions(bench_.as_given, bench_.joints)) {
      auto choices = allowed(bench_, dimension);
      if (!choices) return choices.error();
      dimensions_.push_back(*std::move(choices));
    }
    auto rivals = allowed(bench_, arm_rivals(bench_.as_given));
    if (!rivals) return rivals.error();
    std::erase_if(*rivals, [](const Choice& choice) { return choice.settings.empty(); });
    rivals_ = *std::move(rivals);
    auto costs = ArmCosts::make(bench_, bare_method(arm_dimensions(bench_.as_given, bench_.joints)));
    if (!costs) return costs.error();
    costs_ = *std::move(costs);
    return {};
  }

  [[nodiscard]] Result<ArmTrial> trial_of(const Method& method, const ArmDraws& draws) const {
    const auto params = params_of(bench_, method);
    if (!params) return params.error();
    return ArmTrial::make(bench_, *params, for_bench(bench_, draws));
  }

  [[nodiscard]] std::vector<ArmReach> along_own_direction(std::vector<ArmReach> reach) const {
    reach.resize(bench_.hands.size());
    return reach;
  }

  /// Stage 1: leaves in `best_alone_` the coupling that shows most where it still settles.
  Check try_alone() {
    std::vector<Method> methods;
    for (const Dimension* couplings : {&dimensions_.front(), &rivals_}) {
      for (const Choice& choice : *couplings) {
        methods.push_back(bare_method(dimensions_));
        methods.back().choices.front() = choice;
      }
    }
    std::vector<Check> errors(methods.size());
    std::vector<double> presence(methods.size(), 0.0);
    simulation::for_each_in_parallel(
        methods.size(),
        [&](std::size_t i) {
          auto trial = trial_of(methods[i], alone);
          if (!trial) {
            errors[i] = trial.error();
            return;
          }
          const GainLimit limit = trial->limit(lowest_arm_gain, highest_arm_gain);
          if (limit.gain == 0.0) return;
          if (costs_->allow(methods[i], limit.gain))
            presence[i] = trial->at(limit.gain, trial->tried().size()).presence;
        },
        [this](double done) { progress_(0.1 * done); });
    for (std::size_t i = 0; i < methods.size(); ++i) {
      // A coupling with which the arms make no pair is none of theirs; that of the file is.
      if (errors[i] && i == 0) return errors[i];
    }
    const auto best = std::max_element(presence.begin(), presence.end());
    if (*best > 0.0) best_alone_ = methods[static_cast<std::size_t>(best - presence.begin())];
    return {};
  }

  /// Leaves the finalists in `candidates_`.
  void gather(const std::vector<ArmStep>& steps) {
    const auto add = [this](const Method& method, std::string note, double near = 1.0) {
      for (const ArmCandidate& one : candidates_) {
        if (one.method == method) return;
      }
      candidates_.push_back({.method = method, .note = std::move(note), .limit = {}, .felt = {}, .reach = {}});
      near_.push_back(near);
    };
    for (auto one = steps.rbegin(); one != steps.rend() && candidates_.size() < farthest_taken; ++one) {
      add(one->method, "", one->gain);
    }
    if (best_alone_) add(*best_alone_, "");
    add(Method{}, "what the file has");
  }

  /// Stages 3 and 4.
  Check try_to_the_end() {
    std::vector<Check> errors(candidates_.size());
    simulation::for_each_in_parallel(
        candidates_.size(), [&](std::size_t i) { errors[i] = try_to_the_end(candidates_[i], near_[i]); },
        [this](double done) { progress_(0.6 + 0.3 * done); });
    for (Check& error : errors) {
      if (error) return error;
    }
    return {};
  }

  Check try_to_the_end(ArmCandidate& candidate, double near) const {
    const auto params = params_of(bench_, candidate.method);
    if (!params) return params.error();
    auto trial = trial_of(candidate.method, settling);
    if (!trial) return trial.error();
    candidate.limit =
        trial->limit_near(std::clamp(near, lowest_arm_gain, highest_arm_gain), lowest_arm_gain, highest_arm_gain);
    auto check = trial_of(candidate.method, unseen);
    if (!check) return check.error();
    constexpr int steps = 12;
    constexpr double step = 0.84;
    double gain = rounded_below(candidate.limit.gain / reserve);
    for (int i = 0; i < steps && gain >= lowest_arm_gain / reserve; ++i, gain = rounded_below(step * gain)) {
      if (!holds(*check, *params, gain) || !holds(*check, *params, 0.5 * gain)) continue;
      candidate.force_gain = gain;
      break;
    }
    if (bench_.asked_gain) {
      candidate.holds_asked = candidate.limit.gain >= *bench_.asked_gain && holds(*check, *params, *bench_.asked_gain);
    }
    const double own = candidate.holds_asked ? *bench_.asked_gain : candidate.force_gain;
    auto reach = costs_->of(candidate.method, own > 0.0 ? own : 1.0);
    if (!reach) return reach.error();
    candidate.within_costs = costs_->allow(*reach);
    candidate.reach = along_own_direction(*std::move(reach));
    if (own == 0.0) return {};
    const ArmScore score = check->at(own, check->tried().size());
    candidate.taps = check->tried().size();
    candidate.settled_fraction = 1.0 - static_cast<double>(score.failed.size()) / static_cast<double>(candidate.taps);
    candidate.felt = score.felt;
    candidate.presence = score.presence;
    return {};
  }

  /// At least 95 % of the taps in each hand, and of those alike in hand, pose and direction three of four.
  [[nodiscard]] bool holds(ArmTrial& trial, const ArmTappingParams& params, double gain) const {
    const ArmScore score = trial.at(gain, trial.may_fail());
    if (!score.whole) return false;
    for (std::size_t hand = 0; hand < bench_.hands.size(); ++hand) {
      std::size_t taps = 0;
      for (const Situation& one : trial.tried()) taps += one.hand == hand ? 1U : 0U;
      std::size_t failed = 0;
      for (const std::size_t one : score.failed) failed += trial.tried()[one].hand == hand ? 1U : 0U;
      if (20 * failed > taps) return false;
    }
    return std::none_of(score.failed.begin(), score.failed.end(), [&](std::size_t one) {
      return fails_with_those_alike(bench_, params, trial.tried()[one], gain, unseen);
    });
  }

  Result<ArmAdvice> conclude(const std::vector<ArmChange>& changes) {
    ArmAdvice advice;
    advice.plain = along_own_direction(costs_->plain());
    advice.climb = changes;
    const auto eligible = [this](const ArmCandidate& one) {
      return one.note.empty() && one.within_costs && (bench_.asked_gain ? one.holds_asked : one.force_gain > 0.0);
    };
    double most = 0.0;
    for (const ArmCandidate& one : candidates_) most = eligible(one) ? std::max(most, one.presence) : most;
    const ArmCandidate* start = nullptr;
    const auto effort = [](const ArmCandidate& one) {
      double largest = 0.0;
      for (const ArmReach& reach : one.reach) largest = std::max(largest, reach.effort_N);
      return largest;
    };
    for (const ArmCandidate& one : candidates_) {
      if (!eligible(one) || one.presence < nearly_as_much * most) continue;
      if (start == nullptr || effort(one) < effort(*start)) start = &one;
    }
    for (const ArmCandidate& one : candidates_) {
      if (&one == start) {
        advice.start = one;
        if (bench_.asked_gain) advice.start->force_gain = *bench_.asked_gain;
      } else {
        advice.alternatives.push_back(one);
      }
    }
    std::stable_sort(advice.alternatives.begin(), advice.alternatives.end(),
                     [](const ArmCandidate& a, const ArmCandidate& b) { return a.presence > b.presence; });
    if (advice.start) {
      if (auto error = look_for_obstacles(bench_, for_bench(bench_, settling), advice, progress_)) {
        return *std::move(error);
      }
    }
    progress_(1.0);
    return advice;
  }

  const ArmBench& bench_;
  const Progress& progress_;
  std::vector<Dimension> dimensions_;
  Dimension rivals_;
  std::optional<ArmCosts> costs_;
  std::optional<Method> best_alone_;
  std::vector<ArmCandidate> candidates_;
  std::vector<double> near_;  ///< of each candidate, where its limit may be
};

}  // namespace

Result<ArmAdvice> advise(const ArmBench& bench, const Progress& progress) { return ArmSearch(bench, progress).run(); }

}  // namespace tactus::advice
