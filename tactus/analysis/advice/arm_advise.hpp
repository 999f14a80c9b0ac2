// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/advice/arm_bench.hpp>
#include <tactus/analysis/advice/arm_trial.hpp>
#include <tactus/simulation/experiments/experiment.hpp>

#include <optional>
#include <string>
#include <vector>

/// Two arms: which configuration to start with in every hand, and at which force gain.
namespace tactus::advice {

/// The range of the search for force gains of arms, that of the contest of arms.
inline constexpr double lowest_arm_gain = 0.0625, highest_arm_gain = 16.0;
/// What a configuration may cost beyond plain position-force control on the bare pair at gain 1, in a free reach at
/// the file's own pose, in each hand: lag on top of plain's in each direction, and effort over plain's in the file's
/// own.
inline constexpr double most_lag_more_m = 0.007;
inline constexpr double most_effort_factor = 5.0;

struct ArmCandidate {
  Method method;
  std::string note;  ///< what it is alongside that, as `what the file has`; empty for what the search found
  /// On the taps that decide: what the gain is taken from.
  experiments::GainLimit limit;
  /// The limit less `reserve`, three digits, and lowered until 95 % of the taps of each hand settle that no search saw.
  /// Of a start, the gain that was given, where one was. 0: none does.
  double force_gain = 0.0;
  bool holds_asked = false;
  // At that gain, on the taps that no search saw:
  std::size_t taps = 0;
  double settled_fraction = 0.0;
  std::vector<double> felt;                  ///< of each hand (`ArmScore`)
  double presence = 0.0;                     ///< the least of these
  std::vector<experiments::ArmReach> reach;  ///< in each hand, along the file's own direction
  bool within_costs = false;                 ///< `most_lag_more_m` and `most_effort_factor`
};

/// Where a gain beyond the limit goes wrong first.
struct ArmFault {
  double gain = 0.0;
  Situation where;
  std::string how;  ///< `rings`, `runs away` or `does not touch`
};

/// A change that the climb made.
struct ArmChange {
  double gain = 0.0;  ///< at which taps failed before it
  std::string words;  ///< the configuration then
  std::size_t failed_before = 0;
  std::size_t failed = 0;
  std::size_t of = 0;  ///< taps
};

/// One thing that could be otherwise, and how far the start would then settle.
struct ArmObstacle {
  std::string words;             ///< `a sensor of torque in the follower's joints`
  experiments::Settings set;     ///< what takes it away
  experiments::GainLimit limit;  ///< at least that of the start
};

struct ArmAdvice {
  std::optional<ArmCandidate> start;
  std::vector<ArmCandidate> alternatives;    ///< what was tried to the end besides, the most presence first
  std::vector<experiments::ArmReach> plain;  ///< what `reach` is compared with
  std::vector<ArmChange> climb;              ///< what the search did in its second and third stage, in order
  std::optional<ArmFault> fault;             ///< of `start`; none where the search ended there
  std::vector<ArmObstacle> obstacles;        ///< of `start`, the one that gives most first
};

/// Searches for one configuration that serves every hand of the bench, in stages:
///
/// 1. Each coupling by itself, on the bare pair, at the file's own pose.
/// 2. From bare position-force on, a gain at a time in steps of √2: while taps fail, the one change of one dimension
///    (`arm_dimensions`) that lets most of them settle, and among equals the hand that has less feel most, within the
///    costs. It ends where no change helps. Taps in two poses.
/// 3. From there on, a gain at a time downward, the same on these taps and on those that fail in eight poses with one
///    of three alike. What settles there is changed once more while that lets the hand feel more.
/// 4. The configurations that got farthest, the best of 1 and what the file has: their limits on other taps in three
///    poses.
/// 5. What of that holds on taps that no search has seen, less `reserve`: in those poses and in four that no search
///    has seen either.
///
/// A gain holds where at least 95 % of the taps settle in each hand, as `arm-tapping` counts, and of each that does not
/// three alike in hand, pose and direction do. One that is advised holds at half of it too, for less may settle less:
/// a user begins there. Of those within the costs, the one with the largest presence is taken; of those within a
/// tenth of it, the one of least effort. What the file has is shown alongside it and never taken.
///
/// Equal benches give equal advice. Errors: those of reading the document. Not real-time safe; minutes, on all cores.
Result<ArmAdvice> advise(const ArmBench& bench, const experiments::Progress& progress);

}  // namespace tactus::advice
