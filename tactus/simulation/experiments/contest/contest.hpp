// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/simulation/experiments/gain_limit.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Every way to keep contact stable, side by side: the same hand, devices, wall and taps for all of them.
namespace tactus::experiments {

/// The word that selects an experiment in a file.
enum class ContestKind { contest };
constexpr auto enumerators(ContestKind) { return std::array{Enumerator{ContestKind::contest, "contest"}}; }

/// A search for the largest gain at which taps settle.
struct GainSearch : TapSeries {
  double strong_display_N = 10.0;
  double lowest_gain = 0.25;
  double highest_gain = 32.0;
  static constexpr auto fields() {
    return joined(
        List{field("strong_display_N", &GainSearch::strong_display_N, units::newton, positive_up_to(100.0),
                   "A second limit of the displayed force. Gain limits are determined at `control.force_limit_N` and "
                   "at this one, which is meant to be greater, so that the displayed force saturates less."),
             field("lowest_gain", &GainSearch::lowest_gain, units::none, between(0.01, 1000.0),
                   "Lower end of the search for the largest force gain. The search starts at a gain of 1."),
             field("highest_gain", &GainSearch::highest_gain, units::none, between(0.01, 1000.0),
                   "Upper end of the search.")},
        TapSeries::fields());
  }
};

/// An error unless the search ends above where it begins.
Check check(const GainSearch& search);

struct ContestTask : GainSearch {
  ContestKind kind = ContestKind::contest;
  static constexpr auto fields() {
    return joined(List{field("kind", &ContestTask::kind, "Kind of the experiment.")}, GainSearch::fields());
  }
};

struct ContestParams : simulation::Teleoperator::Params {
  ContestTask task;
  static constexpr auto fields() {
    return joined(simulation::Teleoperator::Params::fields(),
                  List{field("task", &ContestParams::task,
                             "The taps and the search. For each method of keeping contact stable, the contest "
                             "determines the largest force gain at which at least 95 % of the taps settle, half of "
                             "them within 0.1 s plus two round trips of the link.")});
  }
};

/// A competitor: its name, and what it sets on top of the file, as `key=value`.
struct ContestMethod {
  std::string_view name;
  std::vector<std::string_view> settings;
  std::string_view explanation;  ///< what it does, in one sentence
};

/// All competitors, in the order in which they are shown.
std::span<const ContestMethod> contest_methods();

/// Conditions of the contest, each on top of the file's own.
inline constexpr std::array contest_delays_s{0.005, 0.02, 0.1};  ///< each way
inline constexpr std::array contest_grips{0.25, 4.0};            ///< times the nominal
inline constexpr std::array contest_gains{1.0, 3.0, 10.0};
inline constexpr double contest_band_lower_Hz = 20.0;
inline constexpr double contest_band_upper_Hz = 1000.0;

/// An ensemble at one gain.
struct GainScore {
  double force_gain = 0.0;
  double force_limit_N = 0.0;
  TappingMetrics metrics;
  /// Median over the taps of `spectral_error` between what the hand should feel, the contact force times the force gain
  /// and saturated at the force limit, and the force that the hand feels, from 5 ms before first touch to the end of
  /// the observation. None where no tap touched.
  std::optional<double> spectral_error;
  /// Median over the taps that touched of the RMS difference between the force that the slave sent and the contact
  /// force of the tick before, from first touch to the end of the observation. None where no tap touched.
  std::optional<double> sent_force_error_N;
};

/// A reach of 60 mm in 0.5 s that meets nothing, at force gain 1.
struct FreeSpaceScore {
  double hand_force_rms_N = 0.0;       ///< over the reach: the effort
  double displayed_force_rms_N = 0.0;  ///< by the master's motor, over the reach: false, for there is nothing to feel
  /// How much later than the master's motor the slave's tip is half-way. None where it never gets there.
  std::optional<double> lag_s;
};

struct MethodScore {
  GainLimit limit;                                             ///< as the file has it
  GainLimit strong_display;                                    ///< with `strong_display_N`
  std::array<GainLimit, contest_delays_s.size()> delayed;      ///< for each of `contest_delays_s`
  std::array<GainLimit, contest_grips.size()> gripped;         ///< for each of `contest_grips`
  std::array<GainScore, contest_gains.size()> at_gain;         ///< at the file's force limit
  std::array<GainScore, contest_gains.size()> strong_at_gain;  ///< with `strong_display_N`
  FreeSpaceScore free_space;
};

/// The taps of a file for a teleoperator.
TappingParams tapping_of(const simulation::Teleoperator::Params& teleoperator, const TapSeries& taps);
/// With a display that saturates at `force_limit_N`.
TappingParams with_display(TappingParams params, double force_limit_N);
/// In a hand that holds `factor` times as firmly, from the start of the run on, so that a grip sensor measures it and
/// an estimate has the approach to learn it.
TappingParams with_grip(TappingParams params, double factor);
/// With this delay in both directions, and five round trips longer observed, for a contact over a delay takes that long
/// to determine whether it calms down.
TappingParams with_delay(TappingParams params, double each_way_s);

/// Whether a gain settles: at least 95 % of the taps settle, and the median within 100 ms plus two round trips of
/// delay. Ends at the first tap that decides. `params` must be valid.
bool taps_settle(const TappingParams& params);

/// The largest force gain that settles, searched within the bounds of `search`. Both must be valid.
GainLimit tapping_gain_limit(TappingParams params, const GainSearch& search);

/// The taps of an ensemble and what reached the hand. `params` must be valid.
GainScore score_taps(const TappingParams& params);

/// The reach that meets nothing. `params` must be valid.
FreeSpaceScore score_free_space(const simulation::Teleoperator::Params& params);

/// One piece of a competitor's score, which any process can compute: a task.
struct ContestJob {
  std::size_t method = 0;
  std::string name;                  ///< of the piece, as no other one of this competitor
  std::function<std::string()> run;  ///< computes the piece, as bytes
  /// Writes the piece to its own place in the score. False for bytes that are no such piece.
  std::function<bool(std::string_view piece, MethodScore& score)> take;
};

/// What has to be computed for the competitor with index `method` and these parameters, in independent pieces. Errors:
/// a value, or a condition of the contest, that the teleoperator refuses; `inconsistent` for a search that ends where
/// it begins.
Result<std::vector<ContestJob>> contest_jobs(std::size_t method, const ContestParams& params);

}  // namespace tactus::experiments
