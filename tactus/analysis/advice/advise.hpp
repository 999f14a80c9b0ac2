// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/advice/bench.hpp>
#include <tactus/analysis/advice/obstacles.hpp>
#include <tactus/analysis/advice/trial.hpp>
#include <tactus/simulation/experiments/experiment.hpp>

#include <optional>
#include <span>
#include <string>
#include <vector>

/// The configuration to start with: which method, which force gain, what limits it and what to measure next.
namespace tactus::advice {

/// The range of the search for force gains, that of the contest: what settles at the highest always does.
inline constexpr double lowest_gain = 0.25, highest_gain = 32.0;
/// Stages that a searched method has alongside cancellation, at most.
inline constexpr std::size_t most_stages = 2;
/// By what a gain limit is divided for the gain that is advised.
inline constexpr double reserve = 1.15;

/// A configuration and how far it holds.
struct Candidate {
  Method method;
  double force_limit_N = 0.0;
  experiments::GainLimit limit;  ///< on all rigs, in the operator's own grip
  /// The limit less the reserve, three digits, and lowered until it holds on rigs that no search saw. Of a start, the
  /// gain that was given, where one was.
  double force_gain = 0.0;
  bool holds_asked = false;  ///< the gain that was given, where one was
  /// Whether more was not tried: the search ended there.
  [[nodiscard]] bool censored() const {
    return limit.beyond_search && !holds_asked && force_gain > 0.99 * highest_gain / reserve;
  }
  /// The same over grips of ×0.25 to ×4 too, at most `force_gain`; 0: less than the lowest gain of the search.
  double first_gain = 0.0;
  /// The grip over one's own, of `any_grip`, that no longer settles above `first_gain`; none where each holds as far as
  /// was tried.
  std::optional<double> limiting_grip = {};
  // On the rig that is assumed:
  std::optional<double> hand_error;  ///< `experiments::GainScore::spectral_error`
  double effort_N = 0.0;             ///< `experiments::FreeSpaceScore::hand_force_rms_N`
};

struct Advice {
  /// None where nothing that was tried settles, or not at the gain that was given.
  std::optional<Candidate> start;
  std::vector<Candidate> alternatives;   ///< the best first
  experiments::TappingMetrics expected;  ///< of `start` on rigs and with taps that no search saw
  std::vector<Obstacle> obstacles;       ///< of `start`
  std::optional<double> asked_gain;      ///< the gain that was given
  double asked_limit_N = 0.0;            ///< of the display, as the document has it
};

/// Searches, on draws of the bench's knowledge: every combination of the stages of position-force control with at most
/// `most_stages` at a time; then, of the best, other values of their numbers; alongside them the one with an estimate
/// of the grip, and a stage at most, that is best over all grips; then more rigs for those. A gain holds where 95 % of
/// the taps settle on each rig, the median within 100 ms and two round trips
/// (`experiments::taps_settle`). Where nothing settles, other architectures and then smaller displays are tried. Of
/// those within a tenth of the largest gain, the one with the largest first gain is taken, and of those again, the one
/// with the smallest error at the hand.
///
/// Equal benches give equal advice. Errors: those of reading the document; `inconsistent` for a model that is not of
/// the bench's master. Not real-time safe; half a minute, on all cores.
Result<Advice> advise(const Bench& bench, const experiments::Progress& progress);

/// The gain limits of methods with one display, in their order: 0 for a method that the teleoperator refuses. Errors:
/// those of reading the document.
Result<std::vector<experiments::GainLimit>> limits_of(const Bench& bench, const std::vector<Method>& methods,
                                                      double force_limit_N, const Draws& draws, double resolution,
                                                      const experiments::Progress& progress,
                                                      std::span<const double> grips = own_grip);

}  // namespace tactus::advice
