// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/advice/bench.hpp>
#include <tactus/analysis/advice/trial.hpp>
#include <tactus/simulation/experiments/experiment.hpp>

#include <array>
#include <optional>
#include <string>
#include <vector>

/// What keeps a configuration from more force gain, one thing taken away at a time.
namespace tactus::advice {

struct Candidate;

/// One thing that could be otherwise.
struct Obstacle {
  std::string parameter;  ///< a key, or what an identification calls it
  std::string unit;
  double value = 0.0;
  std::optional<std::array<double, 2>> interval_95;  ///< where it is what is not known exactly
  std::optional<double> instead;                     ///< else: what was tried in its place
  experiments::GainLimit limit;                      ///< then
};

/// The name of what is not known, all of it taken together.
inline constexpr const char* all_uncertain = "everything uncertain";

/// Each uncertain parameter known exactly in turn, then all of them, then half the display, no delay, a wall half as
/// stiff, a finer encoder, a better force sensor, as far as the experiment has them. Limits are at least that of the
/// candidate.
Result<std::vector<Obstacle>> find_obstacles(const Bench& bench, const Candidate& candidate, const Draws& draws,
                                             const experiments::Progress& progress);

/// The obstacle whose absence gives the largest gain; none where that is not 5 % more.
const Obstacle* largest(const std::vector<Obstacle>& obstacles, const Candidate& candidate);
/// The same among single parameters that could be measured.
const Obstacle* worth_measuring(const std::vector<Obstacle>& obstacles, const Candidate& candidate);

}  // namespace tactus::advice
