// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/simulation/experiments/arm_tapping/arm_taps.hpp>
#include <tactus/simulation/experiments/gain_limit.hpp>

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Every way to couple two arms, side by side: the same taps on each pair of arms that is named, in each hand.
namespace tactus::experiments {

enum class ArmContestKind { arm_contest };
constexpr auto enumerators(ArmContestKind) {
  return std::array{Enumerator{ArmContestKind::arm_contest, "arm-contest"}};
}

/// The taps and the search. What `arm-tapping` has too means the same.
struct ArmContestTask {
  ArmContestKind kind = ArmContestKind::arm_contest;
  std::int64_t taps = 2;
  std::int64_t seed = 1;
  std::int64_t pose = 0;
  TapDirection direction = TapDirection::down;
  double model_error = 0.2;
  double lowest_gain = 0.0625;
  double highest_gain = 16.0;
  std::string bare;
  static constexpr auto fields() {
    using T = ArmContestTask;
    return List{
        field("kind", &T::kind, "Kind of the experiment."),
        field("taps", &T::taps, between(1, 100000), "Number of taps at each gain that is tried."),
        field("seed", &T::seed, non_negative, "Seed from which the taps are drawn."),
        field("pose", &T::pose, between(0, 1000), "Initial pose of both arms, as in `arm-tapping`."),
        field("direction", &T::direction,
              "Direction in which the operator moves to the surface: down, or along the x or y axis of the base."),
        field("model_error", &T::model_error, units::none, between(0.0, 0.5),
              "Largest error of the model of induced motion, as a share, as in `arm-tapping`."),
        field("lowest_gain", &T::lowest_gain, units::none, between(0.001, 100.0),
              "Lower end of the search for the largest force gain. The search starts at a gain of 1."),
        field("highest_gain", &T::highest_gain, units::none, between(0.001, 100.0), "Upper end of the search."),
        field("bare", &T::bare,
              "File whose keys remove the recommended settings from a pair. It applies to all methods whose name does "
              "not start with `recommended`. A relative path starts at the folder of this file.")};
  }
};

/// A pair of arms: an experiment of the kind arm-tapping, and a file in place of some of its keys.
struct ArmContestPair {
  std::string name;
  std::string file;
  std::string with;
  static constexpr auto fields() {
    using P = ArmContestPair;
    return List{field("name", &P::name, "Name of the pair in the table; empty: this pair does not exist."),
                field("file", &P::file,
                      "Experiment file of the kind arm-tapping with the recommended settings. A relative path starts "
                      "at the folder of this file."),
                field("with", &P::with,
                      "File whose keys replace those of the experiment in `file`; empty: none. A relative path starts "
                      "at the folder of this file.")};
  }
};

/// A hand that holds the leader.
struct ArmContestHand {
  std::string name;
  std::string with;
  static constexpr auto fields() {
    return List{field("name", &ArmContestHand::name, "Name of the hand in the table; empty: this hand does not exist."),
                field("with", &ArmContestHand::with,
                      "File that describes the hand; empty: the hand of each pair's experiment. A relative path starts "
                      "at the folder of this file.")};
  }
};

struct ArmContestPairs {
  ArmContestPair pair_1 = {}, pair_2 = {}, pair_3 = {}, pair_4 = {};
  static constexpr auto fields() {
    using P = ArmContestPairs;
    return List{field("pair_1", &P::pair_1, "The first pair of arms."), field("pair_2", &P::pair_2, "The second."),
                field("pair_3", &P::pair_3, "The third."), field("pair_4", &P::pair_4, "The fourth.")};
  }
};

struct ArmContestHands {
  ArmContestHand hand_1 = {}, hand_2 = {};
  static constexpr auto fields() {
    return List{field("hand_1", &ArmContestHands::hand_1, "The first hand."),
                field("hand_2", &ArmContestHands::hand_2, "The second.")};
  }
};

struct ArmContestParams {
  ArmContestTask task;
  ArmContestPairs pairs;
  ArmContestHands hands;
  static constexpr auto fields() {
    using P = ArmContestParams;
    return List{field("task", &P::task,
                      "The taps and the search. For each method, pair of arms and hand, the contest determines the "
                      "largest force gain at which at least 95 % of the taps settle."),
                field("pairs", &P::pairs, "The arms."), field("hands", &P::hands, "The hands that hold the leader.")};
  }
};

/// A competitor: its name, and what it sets on top of a pair's experiment, as `key=value`.
struct ArmContestMethod {
  std::string_view name;
  bool recommended;  ///< is on the experiment as recommended, without `task.bare`
  std::vector<std::string_view> settings;
  std::string_view explanation;  ///< what it does, in one sentence
};

/// All competitors, in the order in which they are shown.
std::span<const ArmContestMethod> arm_contest_methods();

/// What a method came to in a hand on a pair.
struct ArmContestScore {
  GainLimit limit;  ///< largest gain up to which every one that was tried settled, to a step of √2
  ArmReach reach;   ///< at gain 1
  /// Of the contact force above 15 Hz that the hand feels at gain 1, median over the taps; none where they don't settle
  /// there.
  std::optional<double> felt_share;
  std::optional<double> felt_share_at_limit;  ///< the same at the limit; none where nothing settles
};

/// One method, hand and pair, ready to run.
struct ArmContestEntry {
  std::size_t pair, hand, method;
  ArmTaps taps;
};

struct ArmContest {
  std::vector<std::string> pairs;
  std::vector<std::string> hands;
  std::vector<ArmContestEntry> entries;  ///< pair slowest, then hand
};

/// Reads every pair with every hand and method; files count from `folder`. Errors: `missing` without a pair or a hand;
/// those of a file, under the key that names it; `inconsistent` for a search that ends where it begins.
Result<ArmContest> make_arm_contest(const ArmContestParams& params, const std::filesystem::path& folder);

/// The search, the reach, and the taps at gain 1. A gain settles where at least 95 % of the taps do, as `arm-tapping`
/// counts.
ArmContestScore score_of(const ArmTaps& taps, double lowest_gain, double highest_gain);

/// Which methods to use on a pair: the one that lets the hand that feels least feel most at its limit, and behind it
/// those that come to within a factor √2 of that. Scores are of `contest`'s entries; indices into the methods.
std::vector<std::size_t> arm_contest_winners(const ArmContest& contest, const std::vector<ArmContestScore>& scores,
                                             std::size_t pair);

}  // namespace tactus::experiments
