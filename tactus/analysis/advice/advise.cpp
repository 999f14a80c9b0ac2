// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/advice/advise.hpp>
#include <tactus/simulation/experiments/contest/contest.hpp>
#include <tactus/simulation/teleoperator/parallel.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

namespace tactus::advice {

namespace {

using experiments::GainLimit;
using experiments::Progress;
using experiments::TappingParams;

constexpr std::size_t finalists = 5;
constexpr double screening_resolution = 1.2;
constexpr double about_as_good = 0.9;
constexpr std::size_t halvings = 3;
/// Draws of each step; what confirms an answer has seen no search.
constexpr Draws screening{.first = 0, .rigs = 4, .taps = 4};
constexpr Draws screening_grips{.first = 0, .rigs = 2, .taps = 4};
constexpr Draws deciding{.first = 0, .rigs = 12, .taps = 6};
constexpr Draws gripping{.first = 0, .rigs = 5, .taps = 4};
constexpr Draws confirming{.first = 1000, .rigs = 8, .taps = 20, .coarse = false};

/// `progress` from `from` to `to`.
Progress part(const Progress& progress, double from, double to) {
  return [&progress, from, to](double done) { progress(from + done * (to - from)); };
}

double rounded_down(double value) {
  const double near = rounded(value);
  return near > value ? rounded(value * (1.0 - 5e-3)) : near;
}

/// What a master weighs and how stiff its linkage is, for plant and model apart by more than the model's stated error.
Check check_model(const TappingParams& params, const Bench& bench) {
  if (auto error = bench.knowledge.fits(params.control.model)) return error;
  if (bench.knowledge.of_identification()) return {};
  const auto& mechanism = params.master.mechanism;
  const control::MasterModel& model = params.control.model;
  const double share = std::max(0.1, bench.knowledge.stated_error());
  const auto check = [&](const char* key, double modelled, double real, const char* unit) -> Check {
    if (std::fabs(modelled / real - 1.0) <= share) return {};
    return Error{ErrorCode::inconsistent,
                 std::string("control.model.") + key,
                 rounded_number(modelled) + " " + unit + " is not of this master, whose own is " +
                     rounded_number(real) + " " + unit + ", and task.model_error allows " + rounded_number(share) +
                     " of it: describe the device under [master], or name the model.toml of tactus identify with the "
                     "results.json next to it",
                 {}};
  };
  if (bench.given.contains("master.mechanism.motor.mass_kg")) return {};
  if (auto error = check("motor.mass_kg", model.motor.mass_kg, mechanism.motor.mass_kg, "kg")) return error;
  if (auto error = check("handle.mass_kg", model.handle.mass_kg, mechanism.tip.mass_kg, "kg")) return error;
  return check("linkage.stiffness_N_per_m", model.linkage.stiffness_N_per_m, mechanism.linkage.stiffness_N_per_m,
               "N/m");
}

/// The methods with the largest limits, the simplest of equals first.
std::vector<std::size_t> best_of(const std::vector<GainLimit>& limits, std::size_t most) {
  std::vector<std::size_t> order(limits.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&limits](std::size_t a, std::size_t b) { return limits[a].gain > limits[b].gain; });
  while (!order.empty() && (order.size() > most || limits[order.back()].gain == 0.0)) order.pop_back();
  return order;
}

class Search {
 public:
  Search(const Bench& bench, const TappingParams& as_given, const Progress& progress)
      : bench_(bench), as_given_(as_given), progress_(progress) {
    if (bench.given.contains("control.force_gain")) asked_gain_ = as_given.control.force_gain;
  }

  Result<Advice> run() {
    const auto searched = allowed(bench_, position_force_dimensions(as_given_.control.model));
    if (!searched) return searched.error();
    auto others = allowed(bench_, other_dimensions());
    if (!others) return others.error();
    if (auto error = look_among(combine(*searched, most_stages), as_given_.control.force_limit_N)) {
      return *std::move(error);
    }
    if (candidates_.empty() && !bench_.given.contains("control.architecture")) {
      if (auto error = look_among(combine(*others, most_stages), as_given_.control.force_limit_N)) {
        return *std::move(error);
      }
    }
    if (!bench_.given.contains("control.force_limit_N")) {
      double limit_N = as_given_.control.force_limit_N;
      for (std::size_t i = 0; i < halvings && candidates_.empty(); ++i) {
        limit_N *= 0.5;
        if (auto error = look_among(combine(*searched, most_stages), limit_N)) return *std::move(error);
      }
    }
    return conclude();
  }

 private:
  /// Leaves the finalists in `candidates_`, the one to take first.
  Check look_among(const std::vector<Method>& methods, double force_limit_N) {
    const auto limits = screened(methods, force_limit_N);
    if (!limits) return limits.error();
    const std::vector<std::size_t> best = best_of(*limits, finalists);
    if (best.empty()) return {};

    std::vector<Method> tuned;
    std::vector<std::size_t> of;
    for (const std::size_t i : best) {
      for (Method& method : retuned(methods[i])) {
        tuned.push_back(std::move(method));
        of.push_back(i);
      }
    }
    const auto tuned_limits =
        limits_of(bench_, tuned, force_limit_N, screening, screening_resolution, part(progress_, 0.35, 0.45));
    if (!tuned_limits) return tuned_limits.error();
    std::vector<Method> chosen;
    for (const std::size_t i : best) {
      const Method* method = &methods[i];
      double gain = (*limits)[i].gain;
      for (std::size_t k = 0; k < tuned.size(); ++k) {
        if (of[k] != i || (*tuned_limits)[k].gain <= gain) continue;
        gain = (*tuned_limits)[k].gain;
        method = &tuned[k];
      }
      chosen.push_back(*method);
    }
    if (auto error = add_for_any_grip(chosen, methods, force_limit_N)) return error;
    const auto decided =
        limits_of(bench_, chosen, force_limit_N, deciding, experiments::gain_resolution, part(progress_, 0.5, 0.7));
    if (!decided) return decided.error();
    for (const std::size_t i : best_of(*decided, chosen.size())) {
      Candidate candidate{
          .method = chosen[i], .force_limit_N = force_limit_N, .limit = (*decided)[i], .hand_error = {}};
      candidates_.push_back(std::move(candidate));
    }
    return rank();
  }

  /// The limits over the screening's draws of those that can be among the finalists, 0 for others. A limit on the first
  /// of these rigs alone is no less than that on all, so the methods are tried in its order until enough are better
  /// than it is for those that are left.
  [[nodiscard]] Result<std::vector<GainLimit>> screened(const std::vector<Method>& methods,
                                                        double force_limit_N) const {
    constexpr std::size_t at_once = 4;
    Draws one = screening;
    one.rigs = 1;
    const auto most = limits_of(bench_, methods, force_limit_N, one, screening_resolution, part(progress_, 0.0, 0.2));
    if (!most) return most.error();
    const std::vector<std::size_t> order = best_of(*most, methods.size());
    std::vector<GainLimit> limits(methods.size());
    for (std::size_t first = 0; first < order.size(); first += at_once) {
      // Of equals the first counts, as in `best_of`.
      const double bound = (*most)[order[first]].gain;
      std::size_t better = 0;
      for (std::size_t i = 0; i < limits.size(); ++i) {
        if (limits[i].gain > bound || (limits[i].gain == bound && i < order[first])) ++better;
      }
      if (better >= finalists) break;
      const std::vector<std::size_t> now(
          order.begin() + static_cast<std::ptrdiff_t>(first),
          order.begin() + static_cast<std::ptrdiff_t>(std::min(first + at_once, order.size())));
      std::vector<Method> some;
      std::transform(now.begin(), now.end(), std::back_inserter(some), [&](std::size_t i) { return methods[i]; });
      const double done = 0.2 + 0.15 * static_cast<double>(first) / static_cast<double>(order.size());
      const auto found =
          limits_of(bench_, some, force_limit_N, screening, screening_resolution, [&](double) { progress_(done); });
      if (!found) return found.error();
      for (std::size_t i = 0; i < now.size(); ++i) limits[now[i]] = (*found)[i];
    }
    progress_(0.35);
    return limits;
  }

  /// Adds what holds best over all grips of the methods that follow the grip, with a stage at most: a lag costs a light
  /// hand most.
  Check add_for_any_grip(std::vector<Method>& chosen, const std::vector<Method>& methods, double force_limit_N) const {
    std::vector<Method> following;
    std::copy_if(methods.begin(), methods.end(), std::back_inserter(following),
                 [](const Method& method) { return method.has(grip_estimate) && method.stages() <= 1; });
    const auto limits = limits_of(bench_, following, force_limit_N, screening_grips, screening_resolution,
                                  part(progress_, 0.45, 0.5), any_grip);
    if (!limits) return limits.error();
    for (const std::size_t i : best_of(*limits, 1)) {
      if (std::find(chosen.begin(), chosen.end(), following[i]) == chosen.end()) chosen.push_back(following[i]);
    }
    return {};
  }

  /// Leaves out what holds on no rig that no search saw, unless a gain was given.
  Check rank() {
    std::vector<Check> errors(candidates_.size());
    simulation::for_each_in_parallel(
        candidates_.size(), [&](std::size_t i) { errors[i] = look_closer(candidates_[i]); },
        part(progress_, 0.7, 0.85));
    for (Check& error : errors) {
      if (error) return error;
    }
    if (!asked_gain_) {
      std::erase_if(candidates_, [](const Candidate& one) { return one.force_gain == 0.0; });
    }
    const auto largest = [this](const auto& value, const auto& among) {
      double most = 0.0;
      for (const Candidate& one : candidates_) most = among(one) ? std::max(most, value(one)) : most;
      return about_as_good * most;
    };
    const auto first_of = [](const Candidate& one) { return one.first_gain; };
    const auto gain_of = [](const Candidate& one) { return one.force_gain; };
    const double enough = largest(gain_of, [](const Candidate&) { return true; });
    const auto strong = [=](const Candidate& one) { return one.force_gain >= enough; };
    const double first_enough = largest(first_of, strong);
    const auto place = [=](const Candidate& one) {
      if (!strong(one)) return std::pair(2, -one.force_gain);
      if (one.first_gain < first_enough) return std::pair(1, -one.first_gain);
      return std::pair(0, one.hand_error.value_or(1.0));
    };
    std::stable_sort(candidates_.begin(), candidates_.end(),
                     [&](const Candidate& a, const Candidate& b) { return place(a) < place(b); });
    return {};
  }

  Check look_closer(Candidate& candidate) const {
    const auto params = params_of(bench_, candidate.method, candidate.force_limit_N);
    if (!params) return params.error();
    auto unseen = Trial::make(bench_.knowledge, *params, confirming);
    if (!unseen) return unseen.error();
    candidate.force_gain = confirmed(*unseen, rounded_down(candidate.limit.gain / reserve));
    candidate.holds_asked = asked_gain_ && candidate.limit.gain >= *asked_gain_ && unseen->settles(*asked_gain_);
    const double own_gain = candidate.holds_asked ? *asked_gain_ : candidate.force_gain;
    if (own_gain == 0.0) return {};

    auto gripped = Trial::make(bench_.knowledge, *params, gripping, any_grip);
    if (!gripped) return gripped.error();
    const double top = std::max(reserve * own_gain, 1.01 * lowest_gain);
    const GainLimit in_any_grip = gripped->limit(lowest_gain, top);
    candidate.first_gain = std::min(own_gain, rounded_down(in_any_grip.gain / reserve));
    // The search ends with the lowest gain that failed.
    if (!in_any_grip.beyond_search) candidate.limiting_grip = gripped->failed_last().person.grip_change.factor;
    TappingParams believed = bench_.knowledge.drawn(*params, 0);
    believed.task.taps = 8;
    believed.control.force_gain = own_gain;
    candidate.hand_error = experiments::score_taps(believed).spectral_error;
    believed.control.force_gain = 1.0;
    candidate.effort_N = experiments::score_free_space(believed).hand_force_rms_N;
    return {};
  }

  /// The gain, lowered until it holds; 0 where it does not even then.
  static double confirmed(Trial& unseen, double gain) {
    constexpr int steps = 6;
    constexpr double step = 0.84;
    for (int i = 0; i < steps && gain >= lowest_gain / reserve; ++i) {
      if (unseen.settles(gain)) return gain;
      gain = rounded_down(step * gain);
    }
    return 0.0;
  }

  Result<Advice> conclude() {
    Advice advice;
    advice.asked_gain = asked_gain_;
    advice.asked_limit_N = as_given_.control.force_limit_N;
    for (Candidate& candidate : candidates_) {
      if (!advice.start && (!asked_gain_ || candidate.holds_asked)) {
        advice.start = candidate;
        if (asked_gain_) advice.start->force_gain = *asked_gain_;
      } else {
        advice.alternatives.push_back(std::move(candidate));
      }
    }
    std::stable_sort(advice.alternatives.begin(), advice.alternatives.end(),
                     [](const Candidate& a, const Candidate& b) { return a.force_gain > b.force_gain; });
    if (advice.start) {
      const auto params = params_of(bench_, advice.start->method, advice.start->force_limit_N);
      if (!params) return params.error();
      const auto unseen = Trial::make(bench_.knowledge, *params, confirming);
      if (!unseen) return unseen.error();
      advice.expected = unseen->metrics(advice.start->force_gain);
      auto obstacles = find_obstacles(bench_, *advice.start, deciding, part(progress_, 0.85, 1.0));
      if (!obstacles) return obstacles.error();
      advice.obstacles = *std::move(obstacles);
    }
    progress_(1.0);
    return advice;
  }

  const Bench& bench_;
  const TappingParams& as_given_;
  const Progress& progress_;
  std::optional<double> asked_gain_;
  std::vector<Candidate> candidates_;
};

}  // namespace

Result<std::vector<GainLimit>> limits_of(const Bench& bench, const std::vector<Method>& methods, double force_limit_N,
                                         const Draws& draws, double resolution, const Progress& progress,
                                         std::span<const double> grips) {
  std::vector<std::optional<Trial>> trials(methods.size());
  for (std::size_t i = 0; i < methods.size(); ++i) {
    const auto params = params_of(bench, methods[i], force_limit_N);
    if (!params) return params.error();
    if (auto trial = Trial::make(bench.knowledge, *params, draws, grips)) trials[i] = *std::move(trial);
  }
  std::vector<GainLimit> limits(methods.size());
  simulation::for_each_in_parallel(
      methods.size(),
      [&](std::size_t i) {
        if (trials[i]) limits[i] = trials[i]->limit(lowest_gain, highest_gain, resolution);
        trials[i].reset();
      },
      progress);
  return limits;
}

Result<Advice> advise(const Bench& bench, const Progress& progress) {
  const auto as_given = bench.document.read<TappingParams>();
  if (!as_given) return as_given.error();
  TappingParams one = *as_given;
  one.task.taps = 1;
  if (const auto ensemble = experiments::TappingEnsemble::make(one); !ensemble) {
    return bench.document.locate(ensemble.error());
  }
  if (auto error = check_model(*as_given, bench)) return bench.document.locate(*std::move(error));
  return Search(bench, *as_given, progress).run();
}

}  // namespace tactus::advice
