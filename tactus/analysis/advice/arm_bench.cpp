// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/advice/arm_bench.hpp>
#include <tactus/data/configuration/text.hpp>
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_taps.hpp>

#include <algorithm>
#include <utility>

namespace tactus::advice {

namespace {

using experiments::ArmTappingParams;
using experiments::TapDirection;

constexpr const char* pose_key = "task.pose";
constexpr std::int64_t most_poses_tried = 40;

/// A dimension's setting is given where its key is, or a section that holds it.
bool is_given(const Conditions& given, const std::string& key) {
  return std::any_of(given.begin(), given.end(),
                     [&key](const std::string& one) { return key == one || key.starts_with(one + "."); });
}

Check set_each(configuration::Document& document, const experiments::Settings& settings) {
  for (const auto& [key, value] : settings) {
    if (auto error = document.set(key + "=" + value)) return error;
  }
  return {};
}

}  // namespace

Result<ArmBench> make_arm_bench(configuration::Document document, const std::vector<std::string>& set) {
  auto params = document.read<ArmTappingParams>();
  if (!params) return params.error();
  ArmBench bench{.document = std::move(document),
                 .folder = {},
                 .set = set,
                 .given = {},
                 .as_given = *params,
                 .hands = {{"yours", params->person.hand}},
                 .poses = {params->task.pose},
                 .directions = {params->task.direction},
                 .asked_gain = {}};
  bench.folder = std::filesystem::path(bench.document.name()).parent_path();
  for (const std::string& assignment : set) {
    bench.given.emplace(configuration::trimmed(std::string_view(assignment).substr(0, assignment.find('='))));
  }
  if (Check wrong = station::refuse_tool_coupling(*params, "tactus advise")) {
    return bench.document.locate(*std::move(wrong));
  }
  params->task.taps = 1;
  if (const auto taps = experiments::ArmTaps::make(*params, bench.folder); !taps) {
    return bench.document.locate(taps.error());
  }
  const auto setup = experiments::set_up_arm_pair(*params, bench.folder);
  if (!setup) return bench.document.locate(setup.error());
  bench.joints = setup->leader.joints.size();
  if (bench.given.contains("control.force_gain")) bench.asked_gain = params->control.force_gain;
  const bool hand_given = std::any_of(bench.given.begin(), bench.given.end(),
                                      [](const std::string& key) { return key.starts_with("operator"); });
  if (!hand_given && params->person.hand.stiffness_N_per_m > light_grip.stiffness_N_per_m) {
    bench.hands.push_back({"a light grip", light_grip});
  }
  if (!bench.given.contains("task.direction")) {
    for (const TapDirection one : {TapDirection::down, TapDirection::along_x, TapDirection::along_y}) {
      if (one != params->task.direction) bench.directions.push_back(one);
    }
  }
  if (bench.given.contains(pose_key)) return bench;
  for (std::int64_t pose = 1; pose <= most_poses_tried && bench.poses.size() < most_poses; ++pose) {
    if (pose == bench.poses.front()) continue;
    ArmTappingParams there = *params;
    there.task.pose = pose;
    if (experiments::set_up_arm_pair(there, bench.folder)) bench.poses.push_back(pose);
  }
  return bench;
}

Result<Dimension> allowed(const ArmBench& bench, const Dimension& dimension) {
  const std::string as_given = configuration::to_toml(bench.as_given);
  Dimension left;
  for (const Choice& choice : dimension) {
    experiments::Settings of_given;
    Choice without = choice;
    std::erase_if(without.settings, [&](const auto& setting) {
      if (!is_given(bench.given, setting.first)) return false;
      of_given.push_back(setting);
      return true;
    });
    if (!of_given.empty()) {
      configuration::Document document = bench.document;
      if (auto error = set_each(document, of_given)) return *std::move(error);
      const auto params = document.read<ArmTappingParams>();
      if (!params) return params.error();
      if (configuration::to_toml(*params) != as_given) continue;
    }
    if (is_given(bench.given, choice.tuned)) without.words.clear();
    left.push_back(std::move(without));
  }
  if (left.empty()) left.push_back({});
  return left;
}

Result<ArmTappingParams> params_of(const ArmBench& bench, const Method& method) { return params_of(bench, method, {}); }

Result<ArmTappingParams> params_of(const ArmBench& bench, const Method& method, const experiments::Settings& other) {
  configuration::Document document = bench.document;
  if (auto error = set_each(document, method.settings())) return *std::move(error);
  if (auto error = set_each(document, other)) return *std::move(error);
  return document.read<ArmTappingParams>();
}

}  // namespace tactus::advice
