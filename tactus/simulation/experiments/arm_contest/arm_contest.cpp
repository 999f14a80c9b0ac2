// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/simulation/experiments/arm_contest/arm_contest.hpp>
#include <tactus/simulation/teleoperator/quantile.hpp>

#include <algorithm>
#include <limits>
#include <numbers>
#include <utility>

namespace tactus::experiments {

namespace {

using configuration::Document;

/// The bracket's ends of a search in steps of √2 are so far apart: it does not go on between them.
constexpr double step_of_search = 1.42;

Error of_key(const std::string& key, const Error& error) { return {error.code, key, describe(error), {}}; }

/// Puts the keys of a file, if one is named, on top.
Check put_on_top(Document& document, const std::filesystem::path& folder, const std::string& file,
                 const std::string& key) {
  if (file.empty()) return std::nullopt;
  const auto read = Document::load(folder / file);
  if (!read) return of_key(key, read.error());
  if (Check error = document.merge(*read)) return of_key(key, *error);
  return std::nullopt;
}

Result<ArmTaps> taps_of(const Document& document, const ArmContestTask& task, const std::filesystem::path& folder) {
  auto params = document.read<ArmTappingParams>();
  if (!params) return params.error();
  params->control.force_gain = 1.0;  // of the reach
  params->task.taps = task.taps;
  params->task.seed = task.seed;
  params->task.pose = task.pose;
  params->task.direction = task.direction;
  params->task.model_error = task.model_error;
  auto taps = ArmTaps::make(*params, folder);
  if (!taps) return document.locate(taps.error());
  return taps;
}

Error missing_name(const char* key, const char* message) {
  return {.code = ErrorCode::missing, .parameter = key, .message = message, .place = {}};
}

}  // namespace

std::span<const ArmContestMethod> arm_contest_methods() {
  constexpr std::string_view plain = "control.method=position-force";
  static const std::vector<ArmContestMethod> methods{
      {"position-force", false, {plain}, "The follower's external torque comes back; nothing acts against ringing."},
      {"command low-pass",
       false,
       {plain, "control.command_low_pass_Hz=8"},
       "The follower gets the leader's motion without what is above 8 Hz."},
      {"force low-pass",
       false,
       {plain, "control.force_low_pass_Hz=5"},
       "The hand gets the torque without what is above 5 Hz."},
      {"damper", false, {plain, "control.damping_N_s_per_m=40"}, "A damper of 40 N s/m at the leader's tool."},
      {"position-position",
       false,
       {"control.method=position-position"},
       "Each drive pulls to the other arm's position, as openarm_teleop has it; a gain on the leader's drives."},
      {"FACTR",
       false,
       {"control.method=factr", "control.feed_forward.friction_share=0"},
       "Position-force with dither against friction, a spring in the null space and at joint limits, as released; its "
       "own share of the force is 0.032."},
      {"FACTR, no dither",
       false,
       {"control.method=factr", "control.feed_forward.friction_share=0", "control.factr.dither_share=0"},
       "The same without dither, which is made for the friction of its small geared leader."},
      {"feedback avoidance",
       false,
       {"control.method=feedback-avoidance"},
       "A torque along the leader's motion fades with speed, as in franka_ros2_teleop; its own gain is 1."},
      {"four-channel",
       false,
       {"control.method=four-channel", "control.feed_forward.friction_share=0"},
       "Positions and torques both ways with observers of disturbance and reaction, as openarm_bilateral has it; its "
       "own gain is 1."},
      {"passivity, each joint",
       false,
       {plain, "control.passivity.port=joints"},
       "Position-force between ports at each joint that let no more energy out than went in: a damper at the leader's "
       "joint, and a follower that stays behind."},
      {"passivity, tool",
       false,
       {plain, "control.passivity.port=tool"},
       "The same with one port for all joints, whose power is that of the tool."},
      {"cancellation",
       false,
       {"control.method=cancellation"},
       "What displayed torque does to the held leader is taken from the command, and nothing else is done."},
      {"recommended, position-force",
       true,
       {plain},
       "Damping in the leader's drives and over the bus, limits at the tool, a dead band; no cancellation."},
      {"recommended, cancellation",
       true,
       {"control.method=cancellation"},
       "The same with cancellation, whose model takes every hand for firm."},
  };
  return methods;
}

Result<ArmContest> make_arm_contest(const ArmContestParams& params, const std::filesystem::path& folder) {
  if (!(params.task.lowest_gain < params.task.highest_gain)) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "task.highest_gain",
                 .message = rounded_number(params.task.highest_gain) + " is not above lowest_gain, " +
                            rounded_number(params.task.lowest_gain) + ": raise one or lower the other",
                 .place = {}};
  }
  struct Pair {
    ArmContestPair pair;
    std::string key;
  };
  struct Hand {
    ArmContestHand hand;
    std::string key;
  };
  std::vector<Pair> pairs;
  for_each_field<ArmContestPairs>([&](const auto& each) {
    const ArmContestPair& pair = params.pairs.*each.member;
    if (!pair.name.empty()) pairs.push_back({pair, "pairs." + std::string(each.name)});
  });
  std::vector<Hand> hands;
  for_each_field<ArmContestHands>([&](const auto& each) {
    const ArmContestHand& hand = params.hands.*each.member;
    if (!hand.name.empty()) hands.push_back({hand, "hands." + std::string(each.name)});
  });
  if (pairs.empty()) return missing_name("pairs.pair_1.name", "which arms? Name a pair and its file");
  if (hands.empty()) return missing_name("hands.hand_1.name", "who holds the leader? Name a hand");

  ArmContest contest;
  for (const Pair& one : pairs) contest.pairs.push_back(one.pair.name);
  for (const Hand& one : hands) contest.hands.push_back(one.hand.name);
  for (std::size_t pair = 0; pair < pairs.size(); ++pair) {
    const auto& [of_pair, pair_key] = pairs[pair];
    const auto file = Document::load(folder / of_pair.file);
    if (!file) return of_key(pair_key + ".file", file.error());
    const std::filesystem::path pair_folder = (folder / of_pair.file).parent_path();
    for (std::size_t hand = 0; hand < hands.size(); ++hand) {
      Document recommended = *file;
      if (Check error = put_on_top(recommended, folder, of_pair.with, pair_key + ".with")) return *std::move(error);
      if (Check error = put_on_top(recommended, folder, hands[hand].hand.with, hands[hand].key + ".with")) {
        return *std::move(error);
      }
      Document bare = recommended;
      if (Check error = put_on_top(bare, folder, params.task.bare, "task.bare")) return *std::move(error);
      for (std::size_t method = 0; method < arm_contest_methods().size(); ++method) {
        Document own = arm_contest_methods()[method].recommended ? recommended : bare;
        for (const std::string_view setting : arm_contest_methods()[method].settings) {
          if (Check error = own.set(setting)) return *std::move(error);
        }
        auto taps = taps_of(own, params.task, pair_folder);
        if (!taps) return of_key(pair_key + ".file", taps.error());
        contest.entries.push_back({pair, hand, method, *std::move(taps)});
      }
    }
  }
  return contest;
}

ArmContestScore score_of(const ArmTaps& taps, double lowest_gain, double highest_gain) {
  std::vector<ArmContact> without_display;
  for (std::size_t tap = 0; tap < taps.size(); ++tap) without_display.push_back(taps.run_without_display(tap));
  const std::size_t may_fail = taps.size() / 20;
  ArmContestScore score;
  double largest = 0.0;  // that settled so far
  const auto settles = [&](double gain) {
    std::size_t failed = 0;
    std::vector<double> felt;
    for (std::size_t tap = 0; tap < taps.size() && failed <= may_fail; ++tap) {
      const ArmTapResult result = taps.run_at(gain, tap, without_display[tap]);
      if (!result.settled()) ++failed;
      felt.push_back(result.contact.felt_share);
    }
    if (failed > may_fail) return false;
    if (gain == 1.0) score.felt_share = simulation::quantile(felt, 0.5);
    if (gain >= largest) {
      largest = gain;
      score.felt_share_at_limit = simulation::quantile(felt, 0.5);
    }
    return true;
  };
  score.limit = find_gain_limit(lowest_gain, highest_gain, settles, step_of_search);
  score.reach = taps.reach();
  return score;
}

std::vector<std::size_t> arm_contest_winners(const ArmContest& contest, const std::vector<ArmContestScore>& scores,
                                             std::size_t pair) {
  const std::size_t methods = arm_contest_methods().size();
  std::vector<double> felt(methods, std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < scores.size(); ++i) {
    const ArmContestEntry& entry = contest.entries[i];
    if (entry.pair != pair) continue;
    felt[entry.method] = std::min(felt[entry.method], scores[i].felt_share_at_limit.value_or(0.0));
  }
  const double most = *std::max_element(felt.begin(), felt.end());
  std::vector<std::size_t> winners;
  for (std::size_t method = 0; method < methods; ++method) {
    if (most > 0.0 && felt[method] * std::numbers::sqrt2 >= most) winners.push_back(method);
  }
  std::stable_sort(winners.begin(), winners.end(), [&](std::size_t a, std::size_t b) { return felt[a] > felt[b]; });
  return winners;
}

}  // namespace tactus::experiments
