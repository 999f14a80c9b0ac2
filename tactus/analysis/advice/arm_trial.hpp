// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/advice/arm_bench.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_taps.hpp>
#include <tactus/simulation/experiments/gain_limit.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/// Trying configurations of two arms in several hands, poses and directions.
namespace tactus::advice {

/// A tap: who holds the leader, where the arms are and the surface lies, and what draws its speed, depth and errors
/// of the model.
struct Situation {
  std::size_t hand = 0;  ///< of the bench
  std::int64_t pose = 0;
  experiments::TapDirection direction = experiments::TapDirection::down;
  std::int64_t seed = 0;
};

/// Which taps a gain is tried with. Poses are `first_pose` and the following ones of the bench, as far as it has them,
/// and its first pose where `own_pose` is.
struct ArmDraws {
  std::int64_t first_seed = 0;  ///< apart: taps apart
  std::size_t first_pose = 1;
  std::size_t poses = 0;
  bool own_pose = true;
  std::size_t own_taps = 0;  ///< alongside these, in each hand at the first pose, in its directions by turns
  /// Plants in steps of 250 µs, where the file has shorter ones: what settles does so too, and 1 to 3 % are felt more
  /// or less.
  bool coarse = true;
  bool brief = false;  ///< taps are observed for 0.4 s, where the file has longer
};
std::vector<Situation> situations(const ArmBench& bench, const ArmDraws& draws);

/// `in a light grip, along-y, pose 3`.
std::string words_of(const ArmBench& bench, const Situation& situation);

/// What came of a gain.
struct ArmScore {
  std::vector<std::size_t> failed;  ///< situations, in the order tried
  bool whole = false;               ///< all were tried
  double presence = 0.0;            ///< where they were, the least of `felt`
  /// Of the contact force above 15 Hz that each hand feels: the median over its taps.
  std::vector<double> felt;
};

/// A configuration with its taps. The bench outlives it.
class ArmTrial {
 public:
  /// Errors: those of `ArmTaps::make` at the first tap; another that cannot be made counts as failed.
  static Result<ArmTrial> make(const ArmBench& bench, const experiments::ArmTappingParams& params,
                               const ArmDraws& draws);
  /// The same of any taps; of `detail` only how closely they are looked at is used.
  static Result<ArmTrial> make(const ArmBench& bench, const experiments::ArmTappingParams& params,
                               std::vector<Situation> taps, const ArmDraws& detail);

  /// Runs the taps, those in `first` before all others, and stops where more than `most_failures` fail. What was run at
  /// this gain before is not run again.
  ArmScore at(double gain, std::size_t most_failures, const std::vector<std::size_t>& first = {});
  /// How many of these taps fail at a gain.
  std::size_t failures_among(const std::vector<std::size_t>& taps, double gain);
  /// How many of a hand's taps, or of all, may fail: one in twenty.
  [[nodiscard]] std::size_t may_fail() const { return taps_.size() / 20; }
  /// Whether at most `may_fail` fail. What failed last is tried first.
  bool settles(double gain);
  /// `experiments::find_gain_limit` over `settles`, in steps of √2.
  experiments::GainLimit limit(double lowest, double highest);
  /// The same from `near` on, in its steps of √2; up to it half of it and a quarter must settle too.
  experiments::GainLimit limit_near(double near, double lowest, double highest);
  /// The situation that failed last in `settles`.
  [[nodiscard]] const std::vector<std::size_t>& failed_last() const { return failed_last_; }
  /// How the tap goes wrong at a gain.
  std::string fault(double gain, std::size_t situation);
  [[nodiscard]] const std::vector<Situation>& tried() const { return situations_; }

 private:
  struct Tap {
    std::optional<experiments::ArmTaps> taps;  ///< one, made when it is first run
    experiments::ArmContact without_display;
    std::optional<experiments::ArmTapResult> result;  ///< at `gain_`
  };
  [[nodiscard]] Result<experiments::ArmTaps> made(std::size_t tap) const;
  experiments::ArmTapResult run(double gain, std::size_t tap);

  const ArmBench* bench_ = nullptr;
  experiments::ArmTappingParams params_;
  std::vector<Situation> situations_;
  std::vector<Tap> taps_;
  double gain_ = -1.0;
  std::vector<std::size_t> failed_last_;
};

/// Whether a tap fails at a gain, and with it one at least of three more of its hand, pose and direction that no draw
/// has. Of `detail` only how closely they are looked at is used. What cannot be made fails.
bool fails_with_those_alike(const ArmBench& bench, const experiments::ArmTappingParams& params, const Situation& tap,
                            double gain, const ArmDraws& detail);

/// What reaching freely costs in each hand of the bench, along its own direction and then each other, at the gain of
/// `params`. Errors: those of `ArmTaps::make`.
Result<std::vector<experiments::ArmReach>> reaches(const ArmBench& bench, const experiments::ArmTappingParams& params);

}  // namespace tactus::advice
