// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/linearisation.hpp>
#include <tactus/simulation/experiments/experiment.hpp>
#include <tactus/simulation/experiments/gain_limit.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>

#include <functional>
#include <optional>
#include <string>
#include <vector>

/// From the linear loop to the taps of a file: what each thing that is not linear does to the gain limit.
namespace tactus::stability {

inline constexpr double lowest_tried_gain = 0.05;
/// Highest gain of loops that are linear. Taps are tried up to that of the contest: what settles there always does.
inline constexpr double highest_linear_gain = 1000.0;
inline constexpr double highest_tapped_gain = 32.0;

/// A gain limit and what it has that the one before has not.
struct LimitRung {
  std::string key;    ///< for programs
  std::string words;  ///< of what this is the limit
  std::string adds;   ///< the effect that is added; empty for the first
  experiments::GainLimit limit;
  /// Of the taps of the file with this one thing taken out again; none where that is not a thing to take out.
  std::optional<experiments::GainLimit> without = {};
};

/// The rungs, in order:
///
/// - the linear loop; the same rig in time, tip glued to the wall; where cancellation is on and `task.model_error` not
/// 0,
///   the linear loop with the worst of 27 models wrong by that; the linear loop, with that model, whose modes above 15
///   Hz fall to a tenth in the time that the judge of taps allows (left out beyond 400 states);
/// - taps on the wall of the file with everything else linear and no force limited, then with one thing after the other
///   as the file has it: limits of force, the operator, friction, hysteresis, the model's quintic hand, encoders, and
///   last whatever is left (noise and offset of sensors, jitter and loss of the channel). What does not differ from the
///   linear rig is left out.
///
/// A ratio between two rungs depends on the order; `without` does not, and reports what a thing does among all others.
/// Errors: those of `make_loop` and of `TappingEnsemble::make`. Not real-time safe; some ten seconds, on all cores.
Result<std::vector<LimitRung>> limit_ladder(const experiments::TappingParams& params,
                                            const Linearisation& linearisation, const experiments::Progress& progress);

}  // namespace tactus::stability
