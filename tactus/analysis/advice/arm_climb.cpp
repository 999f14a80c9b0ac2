// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/advice/arm_trial.hpp>
#include <tactus/analysis/advice/internal/arm_climb.hpp>
#include <tactus/simulation/teleoperator/parallel.hpp>

#include <algorithm>
#include <cstdint>
#include <numbers>
#include <optional>
#include <utility>

namespace tactus::advice {

namespace {

constexpr ArmDraws climbing{.first_seed = 1000, .first_pose = 1, .poses = 1, .brief = true};
constexpr ArmDraws looking_about{.first_seed = 4000, .first_pose = 1, .poses = seen_poses, .brief = true};
constexpr std::size_t most_rounds = 48;  // of changes, over all gains
constexpr std::size_t most_added = 8;    // taps, at once
constexpr double worth_changing = 1.02;  // more presence

/// Those that are whole: what fails least first, and of these what shows most.
std::vector<std::size_t> by_worth(const std::vector<ArmScore>& scores) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    if (scores[i].whole) order.push_back(i);
  }
  const auto place = [&scores](std::size_t i) { return std::pair(scores[i].failed.size(), -scores[i].presence); };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return place(a) < place(b); });
  return order;
}

}  // namespace

Check ArmClimb::run() {
  taps_ = situations(bench_, climbing);
  if (auto error = climb()) return error;
  if (!steps_.empty()) {
    if (auto error = show_more(false)) return error;
    const auto mended = mend();
    if (!mended) return mended.error();
    if (*mended) {
      if (auto error = show_more(true)) return error;
    }
  }
  progress_(0.6);
  return {};
}

/// On the taps of the climb.
Result<ArmTrial> ArmClimb::trial_of(const Method& method) const {
  const auto params = params_of(bench_, method);
  if (!params) return params.error();
  return ArmTrial::make(bench_, *params, taps_, climbing);
}

/// Of each method at a gain, those taps first that fail without it: whole only where at most `most_failures` fail and,
/// where any failed, some of these settle.
std::vector<ArmScore> ArmClimb::scores(const std::vector<Method>& methods, double gain,
                                       const std::vector<std::size_t>& failed, std::size_t most_failures) const {
  std::vector<ArmScore> all(methods.size());
  simulation::for_each_in_parallel(
      methods.size(),
      [&](std::size_t i) {
        auto trial = trial_of(methods[i]);
        if (!trial) return;
        if (!failed.empty() && trial->failures_among(failed, gain) == failed.size()) return;
        all[i] = trial->at(gain, most_failures, failed);
      },
      [](double) {});
  return all;
}

/// Takes the best neighbour that is within the costs and fails less. Whether there is one.
bool ArmClimb::change(ArmStep& now, ArmScore& score) {
  const std::vector<Method> others = neighbours(now.method, dimensions_);
  const std::vector<ArmScore> all = scores(others, now.gain, score.failed, score.failed.size() - 1);
  for (const std::size_t i : by_worth(all)) {
    if (!costs_.allow(others[i], now.gain)) continue;
    now.method = others[i];
    changes_.push_back({.gain = now.gain,
                        .words = now.method.words(),
                        .failed_before = score.failed.size(),
                        .failed = all[i].failed.size(),
                        .of = taps_.size()});
    score = all[i];
    return true;
  }
  return false;
}

/// Changes a configuration, one thing at a time, until all taps settle at its gain. Whether they do. Errors: those of
/// reading the document.
Result<bool> ArmClimb::settle_all(ArmStep& now) {
  auto trial = trial_of(now.method);
  if (!trial) return trial.error();
  ArmScore score = trial->at(now.gain, taps_.size());
  while (!score.failed.empty() && round_ < most_rounds) {
    progress_(0.1 + 0.5 * static_cast<double>(++round_) / static_cast<double>(most_rounds));
    if (!change(now, score)) return false;
  }
  return score.failed.empty();
}

/// Leaves what settled at each gain in `steps_`.
Check ArmClimb::climb() {
  ArmStep now{.method = bare_method(dimensions_), .gain = bench_.asked_gain.value_or(1.0)};
  for (;;) {
    const auto settled = settle_all(now);
    if (!settled) return settled.error();
    if (!*settled) return {};
    steps_.push_back(now);
    if (bench_.asked_gain || now.gain >= highest_arm_gain) return {};
    now.gain = std::min(now.gain * std::numbers::sqrt2, highest_arm_gain);
  }
}

/// Tries a configuration in all poses that the search may see: taps that fail there become taps of the climb, unless
/// those alike settle, `most_added` of them at once. Whether there are any. Errors: those of reading the document.
Result<bool> ArmClimb::look_about(const ArmStep& now) {
  const auto params = params_of(bench_, now.method);
  if (!params) return params.error();
  const std::vector<Situation> about = situations(bench_, looking_about);
  std::vector<std::uint8_t> fails(about.size(), 0);
  simulation::for_each_in_parallel(
      about.size(),
      [&](std::size_t i) { fails[i] = fails_with_those_alike(bench_, *params, about[i], now.gain, looking_about); },
      [](double) {});
  std::vector<Situation> failing;
  for (std::size_t i = 0; i < about.size(); ++i) {
    if (fails[i] != 0) failing.push_back(about[i]);
  }
  // From everywhere alike.
  const std::size_t added = std::min(failing.size(), most_added);
  for (std::size_t i = 0; i < added; ++i) taps_.push_back(failing[i * failing.size() / added]);
  return added > 0;
}

/// From the top of the climb on, what settles in all poses that the search may see: at a lower gain where no change
/// helps. Whether there is any. Taps that were added at a higher gain are left out again, for those alike may settle
/// now.
Result<bool> ArmClimb::mend() {
  const ArmStep top = steps_.back();
  for (double gain = top.gain; gain >= lowest_arm_gain; gain /= std::numbers::sqrt2) {
    ArmStep now{.method = top.method, .gain = gain};
    taps_ = situations(bench_, climbing);
    for (;;) {
      const auto settled = settle_all(now);
      if (!settled) return settled.error();
      if (!*settled) break;
      const auto more = look_about(now);
      if (!more) return more.error();
      if (*more) continue;
      steps_.push_back(now);
      return true;
    }
    if (bench_.asked_gain) break;
  }
  return false;
}

/// Of what settles at the gain of the last step, `everywhere` or on the taps of the climb, the neighbour that shows
/// most, until none shows more.
Check ArmClimb::show_more(bool everywhere) {
  for (;; ++round_) {
    const ArmStep now = steps_.back();
    auto trial = trial_of(now.method);
    if (!trial) return trial.error();
    const double presence = trial->at(now.gain, taps_.size()).presence;
    const std::vector<Method> others = neighbours(now.method, dimensions_);
    const std::vector<ArmScore> all = scores(others, now.gain, {}, 0);
    std::optional<ArmStep> better;
    for (const std::size_t i : by_worth(all)) {
      if (better || all[i].presence < worth_changing * presence) break;
      const ArmStep other{.method = others[i], .gain = now.gain};
      if (!costs_.allow(other.method, other.gain)) continue;
      const auto more = everywhere ? look_about(other) : Result<bool>(false);
      if (!more) return more.error();
      if (!*more) better = other;
    }
    if (!better || round_ >= most_rounds) return {};
    steps_.push_back(*better);
  }
}

}  // namespace tactus::advice
