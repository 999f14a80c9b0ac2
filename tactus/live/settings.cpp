#include <tactus/configuration/toml_writer.hpp>
#include <tactus/experiments/contest/contest.hpp>
#include <tactus/live/settings.hpp>

#include <algorithm>
#include <utility>

namespace tactus::live {

namespace {

using Kind = ParameterDescription::Kind;

constexpr const char* gain = "control.force_gain";
constexpr const char* stiffness = "environment.stiffness_N_per_m";
constexpr const char* delay = "channel.delay_s";
constexpr const char* grip = "operator.grip";
constexpr const char* side_by_side = "side_by_side";

constexpr const char* plain = "none";

std::string method_key(std::size_t loop) { return std::string(loop_names[loop]) + ".method"; }

/// The competitors of the contest as words of one kind: `cancellation-local-damping`; the one that does nothing against
/// instability is `none`.
std::string word_of(const experiments::ContestMethod& method) {
  if (method.name == "position-force") return plain;
  std::string word;
  for (const char c : method.name) {
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

template <Described T>
bool are_equal(const T& one, const T& other) {
  return configuration::to_toml(one) == configuration::to_toml(other);
}

}  // namespace

Result<Settings> Settings::make(const configuration::Document& document) {
  const auto params = document.read<experiments::TappingParams>();
  if (!params) return params.error();
  if (auto error = experiments::refuse_supervised(*params, "the live page")) return document.locate(*std::move(error));

  Settings settings(document);
  const auto add = [&settings](ParameterDescription description, ParameterValue value) {
    description.initial = value;
    settings.descriptions_.push_back(std::move(description));
    settings.values_.push_back(std::move(value));
  };
  const auto number = [&add](const char* name, const char* label, const Unit& unit, double least, double most,
                             double value, bool logarithmic = false) {
    // A file may say more than a visitor would try.
    add({.name = name,
         .label = label,
         .unit = unit,
         .bounds = between(std::min(least, value), std::max(most, value)),
         .logarithmic = logarithmic,
         .choices = {},
         .explanations = {}},
        value);
  };
  number(gain, "Force gain", units::none, 0.0, 30.0, params->control.force_gain);
  number(stiffness, "Wall stiffness", units::newton_per_metre, 100.0, 100000.0, params->environment.stiffness_N_per_m,
         true);
  number(delay, "Delay each way", units::second, 0.0, 0.2, params->channel.to_slave.delay_s);
  number(grip, "Grip", units::none, 0.25, 4.0, 1.0, true);
  std::vector<std::string> methods, explanations;
  for (const experiments::ContestMethod& method : experiments::contest_methods()) {
    methods.push_back(word_of(method));
    explanations.emplace_back(method.explanation);
  }
  constexpr std::array labels{"Method", "Compared with"};
  constexpr std::array first_methods{"cancellation", plain};
  for (std::size_t i = 0; i < loops; ++i) {
    add({.name = method_key(i),
         .label = labels[i],
         .kind = Kind::choice,
         .bounds = {},
         .choices = methods,
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
  return settings;
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

Result<simulation::Teleoperator::Params> Settings::of_loop(std::size_t loop) const {
  configuration::Document document = document_;
  const auto set = [&document](const std::string& key, const std::string& text) {
    return document.set(key + "=" + text);
  };
  const auto number = [this](const char* name) { return format_number(std::get<double>(value(name))); };
  const std::string& word = std::get<std::string>(value(method_key(loop)));
  for (const experiments::ContestMethod& method : experiments::contest_methods()) {
    if (word_of(method) != word) continue;
    for (const std::string_view setting : method.settings) {
      if (auto error = document.set(setting)) return *std::move(error);
    }
  }
  for (const auto& [key, text] :
       {std::pair{std::string(gain), number(gain)}, std::pair{std::string(stiffness), number(stiffness)},
        std::pair{std::string("channel.to_slave.delay_s"), number(delay)},
        std::pair{std::string("channel.to_master.delay_s"), number(delay)}}) {
    if (auto error = set(key, text)) return *std::move(error);
  }
  auto params = document.read<experiments::TappingParams>();
  if (!params) return params.error();
  params->person.grip = mechanics::scaled(params->person.grip, std::get<double>(value(grip)));
  params->environment.position_m = wall_m * params->control.position_scale;
  if (auto error = validate(*params)) return *std::move(error);
  return simulation::Teleoperator::Params(*params);
}

bool Settings::is_plain(std::size_t loop) const { return std::get<std::string>(value(method_key(loop))) == plain; }

bool Settings::runs(std::size_t loop) const { return loop == 0 || std::get<bool>(value(side_by_side)); }

std::optional<simulation::Teleoperator::Parts> difference(const simulation::Teleoperator::Params& before,
                                                          const simulation::Teleoperator::Params& after) {
  if (before.control.architecture != after.control.architecture) return std::nullopt;
  return simulation::Teleoperator::Parts{.grip = !are_equal(before.person, after.person),
                                         .environment = !are_equal(before.environment, after.environment),
                                         .channel = !are_equal(before.channel, after.channel),
                                         .controllers = !are_equal(before.control, after.control)};
}

}  // namespace tactus::live
