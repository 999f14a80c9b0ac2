// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/interfaces/live/engine.hpp>
#include <tactus/interfaces/live/settings.hpp>
#include <tactus/simulation/experiments/arm_contest/arm_contest.hpp>
#include <tactus/simulation/experiments/contest/contest.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>

namespace tactus::live {

namespace {

using Kind = ParameterDescription::Kind;

constexpr const char* gain = "control.force_gain";
constexpr const char* stiffness = "environment.stiffness_N_per_m";
constexpr const char* arm_wall = "wall.stiffness_N_per_m";
constexpr const char* delay = "channel.delay_s";
constexpr const char* grip = "operator.grip";
constexpr const char* side_by_side = "side_by_side";

constexpr const char* plain = "none";

std::string method_key(std::size_t loop) { return std::string(loop_names[loop]) + ".method"; }

/// A competitor of a contest as a word of one kind: `cancellation-local-damping`; the one that does nothing against
/// instability is `none`.
std::string word_of(std::string_view method) {
  if (method == "position-force") return plain;
  std::string word;
  for (const char c : method) {
    if (c != ',') word += c == ' ' ? '-' : c;
  }
  return word;
}

std::string quoted(const ParameterValue& value) {
  if (const auto* number = std::get_if<double>(&value)) return format_number(*number);
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  return "'" + std::get<std::string>(value) + "'";
}

Error wrong_kind(const Parameter& wanted, const char* needed) {
  return Error{.code = ErrorCode::wrong_type,
               .parameter = wanted.name,
               .message = quoted(wanted.value).substr(0, 80) + " is not " + needed,
               .place = {}};
}

}  // namespace

Result<Settings> Settings::make(const configuration::Document& document) {
  const auto kind = document.text_at("task.kind");
  if (!kind) return kind.error();
  Settings settings(document);
  if (*kind != "tapping" && *kind != "arm-tapping") {
    return document.locate(Error{.code = ErrorCode::out_of_bounds,
                                 .parameter = "task.kind",
                                 .message = "'" + *kind + "' cannot be served: serve one of tapping, arm-tapping",
                                 .place = {}});
  }
  if (Check error = *kind == "tapping" ? settings.take_axis() : settings.take_arms()) {
    return document.locate(*std::move(error));
  }
  return settings;
}

Check Settings::take_axis() {
  const auto params = document_.read<experiments::TappingParams>();
  if (!params) return params.error();
  if (auto error = experiments::refuse_supervised(*params, "the live page")) return error;
  add_number(gain, "Force gain", units::none, between(0.0, 30.0), params->control.force_gain);
  add_number(stiffness, "Wall stiffness", units::newton_per_metre, between(100.0, 100000.0),
             params->environment.stiffness_N_per_m, true);
  add_number(delay, "Delay each way", units::second, between(0.0, 0.2), params->channel.to_slave.delay_s);
  add_number(grip, "Grip", units::none, between(0.25, 4.0), 1.0, true);
  for (const experiments::ContestMethod& method : experiments::contest_methods()) {
    methods_.push_back({word_of(method.name), {method.settings.begin(), method.settings.end()}, method.explanation});
  }
  add_comparison();
  return std::nullopt;
}

Check Settings::take_arms() {
  const auto params = document_.read<experiments::ArmTappingParams>();
  if (!params) return params.error();
  if (Check wrong = station::refuse_tool_coupling(*params, "tactus serve")) return *std::move(wrong);
  auto arms = experiments::set_up_arm_pair(*params, std::filesystem::path(document_.name()).parent_path());
  if (!arms) return arms.error();
  arms_ = *std::move(arms);
  add_number(gain, "Force gain", units::none, between(0.0, 12.0), params->control.force_gain);
  add_number(arm_wall, "Wall stiffness", units::newton_per_metre, between(500.0, 100000.0),
             params->wall.stiffness_N_per_m, true);
  add_number(grip, "Grip", units::none, between(0.25, 4.0), 1.0, true);
  for (const experiments::ArmContestMethod& method : experiments::arm_contest_methods()) {
    // What is served is as its file has it: those that stand on the pair as recommended are among the others.
    if (method.recommended) continue;
    const std::string word = word_of(method.name);
    // In the contest these two stand on bare arms.
    const std::string_view explanation =
        word == plain            ? "The follower's external torque comes back; damping and limits are the experiment's."
        : word == "cancellation" ? "What displayed torque does to the held leader is taken from the command; damping "
                                   "and limits are the experiment's."
                                 : method.explanation;
    methods_.push_back({word, {method.settings.begin(), method.settings.end()}, explanation});
  }
  add_comparison();
  return std::nullopt;
}

void Settings::add(ParameterDescription description, const ParameterValue& value) {
  description.initial = value;
  descriptions_.push_back(std::move(description));
  values_.push_back(value);
}

void Settings::add_number(const char* name, const char* label, const Unit& unit, const Bounds& usual, double value,
                          bool logarithmic) {
  // A file may say more than a visitor would try.
  add({.name = name,
       .label = label,
       .unit = unit,
       .bounds = between(std::min(usual.lower, value), std::max(usual.upper, value)),
       .logarithmic = logarithmic,
       .choices = {},
       .explanations = {}},
      value);
}

void Settings::add_comparison() {
  std::vector<std::string> words, explanations;
  for (const Method& method : methods_) {
    words.push_back(method.word);
    explanations.emplace_back(method.explanation);
  }
  constexpr std::array labels{"Method", "Compared with"};
  constexpr std::array first_methods{"cancellation", plain};
  for (std::size_t i = 0; i < loops; ++i) {
    add({.name = method_key(i),
         .label = labels[i],
         .kind = Kind::choice,
         .bounds = {},
         .choices = words,
         .explanations = explanations},
        first_methods[i]);
  }
  add({.name = side_by_side,
       .label = "Side by side",
       .kind = Kind::flag,
       .bounds = {},
       .choices = {},
       .explanations = {}},
      true);
}

std::vector<Parameter> Settings::parameters() const {
  std::vector<Parameter> all;
  for (std::size_t i = 0; i < values_.size(); ++i) all.push_back({descriptions_[i].name, values_[i]});
  return all;
}

Check Settings::set(const Parameter& wanted) {
  const auto found = std::find_if(descriptions_.begin(), descriptions_.end(),
                                  [&wanted](const auto& description) { return description.name == wanted.name; });
  if (found == descriptions_.end()) {
    return Error{.code = ErrorCode::unknown_key,
                 .parameter = wanted.name.substr(0, 80),
                 .message = "there is no such parameter: the list is in the server's information",
                 .place = {}};
  }
  switch (found->kind) {
    case Kind::number: {
      const auto* number = std::get_if<double>(&wanted.value);
      if (number == nullptr) return wrong_kind(wanted, "a number");
      if (!found->bounds.contain(*number)) return out_of_bounds(wanted.name, *number, found->bounds, found->unit);
      break;
    }
    case Kind::flag:
      if (!std::holds_alternative<bool>(wanted.value)) return wrong_kind(wanted, "true or false");
      break;
    case Kind::choice: {
      const auto* word = std::get_if<std::string>(&wanted.value);
      if (word == nullptr || std::find(found->choices.begin(), found->choices.end(), *word) == found->choices.end()) {
        std::string known;
        for (const std::string& choice : found->choices) known += (known.empty() ? "" : ", ") + choice;
        return wrong_kind(wanted, ("one of: " + known).c_str());
      }
      break;
    }
  }
  values_[static_cast<std::size_t>(found - descriptions_.begin())] = wanted.value;
  return std::nullopt;
}

const ParameterValue& Settings::value(std::string_view name) const {
  const auto found = std::find_if(descriptions_.begin(), descriptions_.end(),
                                  [name](const auto& description) { return description.name == name; });
  return values_[static_cast<std::size_t>(found - descriptions_.begin())];
}

Result<LoopParams> Settings::of_loop(std::size_t loop) const {
  configuration::Document document = document_;
  const std::string& word = std::get<std::string>(value(method_key(loop)));
  for (const Method& method : methods_) {
    if (method.word != word) continue;
    for (const std::string_view setting : method.settings) {
      if (auto error = document.set(setting)) return *std::move(error);
    }
  }
  if (auto error = document.set(gain + ("=" + format_number(number(gain))))) return *std::move(error);
  return arms_ ? arms(document) : axis(document);
}

Result<LoopParams> Settings::axis(const configuration::Document& document) const {
  auto params = document.read<experiments::TappingParams>();
  if (!params) return params.error();
  params->environment.stiffness_N_per_m = number(stiffness);
  params->channel.to_slave.delay_s = params->channel.to_master.delay_s = number(delay);
  params->person.grip = mechanics::scaled(params->person.grip, number(grip));
  params->environment.position_m = wall_m * params->control.position_scale;
  if (auto error = validate(*params)) return *std::move(error);
  return LoopParams(simulation::Teleoperator::Params(*params));
}

Result<LoopParams> Settings::arms(const configuration::Document& document) const {
  auto params = document.read<experiments::ArmTappingParams>();
  if (!params) return params.error();
  params->wall.stiffness_N_per_m = number(arm_wall);
  params->person.hand.stiffness_N_per_m *= number(grip);
  params->person.hand.damping_N_s_per_m *= number(grip);
  if (auto error = validate(*params)) return *std::move(error);
  experiments::ArmPairSetup setup = *arms_;
  setup.params = *std::move(params);
  return LoopParams(std::move(setup));
}

HandPoint Settings::workspace_m() const {
  constexpr double one_axis_m = 0.05;
  constexpr double arms_m = 0.1;
  return arms_ ? HandPoint{arms_m, arms_m, arms_m} : HandPoint{one_axis_m, 0.0, 0.0};
}

ScriptedTap Settings::tap() const {
  // Arms begin in their pose, not near the wall.
  return {.wall_m = wall_m, .approach_s = arms_ ? 0.3 : 0.0};
}

std::string Settings::configuration() const {
  return arms_ ? configuration::to_toml(arms_->params)
               : configuration::to_toml(*document_.read<experiments::TappingParams>());
}

bool Settings::is_plain(std::size_t loop) const { return std::get<std::string>(value(method_key(loop))) == plain; }

bool Settings::runs(std::size_t loop) const { return loop == 0 || std::get<bool>(value(side_by_side)); }

}  // namespace tactus::live
