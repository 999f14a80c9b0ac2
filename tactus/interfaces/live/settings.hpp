// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/configuration/document.hpp>
#include <tactus/interfaces/live/application.hpp>
#include <tactus/interfaces/live/hand.hpp>
#include <tactus/interfaces/live/loops.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_pair.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tactus::live {

/// A parameter of the live view as a page needs it to show a control.
struct ParameterDescription {
  enum class Kind { number, choice, flag };
  std::string name;
  std::string label;
  Unit unit = units::none;
  Kind kind = Kind::number;
  Bounds bounds;
  bool logarithmic = false;
  std::vector<std::string> choices;
  std::vector<std::string> explanations;  ///< one sentence for each choice
  ParameterValue initial = 0.0;           ///< what it is until somebody changes it
};

/// What can be changed while the loops run, and from it the parameters of each loop. A value: a change is tried on a
/// copy.
class Settings {
 public:
  /// From an experiment of the kind `tapping` or `arm-tapping`. Its wall is put 10 mm before the place of rest. Errors:
  /// those of the document and of the arms, and `out_of_bounds` for another kind.
  static Result<Settings> make(const configuration::Document& document);

  [[nodiscard]] const std::vector<ParameterDescription>& descriptions() const { return descriptions_; }
  [[nodiscard]] std::vector<Parameter> parameters() const;
  /// Errors: `unknown_key`, `wrong_type` and `out_of_bounds`, with name, value, bounds and remedy.
  Check set(const Parameter& wanted);

  /// The parameters of a loop as they are now set. Errors: what the described parameters refuse.
  [[nodiscard]] Result<LoopParams> of_loop(std::size_t loop) const;
  [[nodiscard]] bool runs(std::size_t loop) const;
  /// Nothing in it acts against instability.
  [[nodiscard]] bool is_plain(std::size_t loop) const;
  /// How far to either side of rest the hand may go, in each direction; 0 is a direction that the devices do not have.
  [[nodiscard]] HandPoint workspace_m() const;
  [[nodiscard]] ScriptedTap tap() const;
  /// The arms behind the loops, as the experiment has them; null for one axis.
  [[nodiscard]] const experiments::ArmPairSetup* arms() const { return arms_ ? &*arms_ : nullptr; }
  /// The experiment with all its keys, as TOML.
  [[nodiscard]] std::string configuration() const;
  /// The wall as the master's hand sees it.
  static constexpr double wall_m = loop_wall_m;

 private:
  /// A word of the choice of methods, and what it sets in the experiment.
  struct Method {
    std::string word;
    std::vector<std::string_view> settings;
    std::string_view explanation;
  };

  explicit Settings(const configuration::Document& document) : document_(document) {}
  Check take_axis();
  Check take_arms();
  void add(ParameterDescription description, const ParameterValue& value);
  void add_number(const char* name, const char* label, const Unit& unit, const Bounds& usual, double value,
                  bool logarithmic = false);
  /// The choice of each loop's method, and whether both run.
  void add_comparison();
  [[nodiscard]] Result<LoopParams> axis(const configuration::Document& document) const;
  [[nodiscard]] Result<LoopParams> arms(const configuration::Document& document) const;
  [[nodiscard]] const ParameterValue& value(std::string_view name) const;
  [[nodiscard]] double number(std::string_view name) const { return std::get<double>(value(name)); }

  configuration::Document document_;
  std::optional<experiments::ArmPairSetup> arms_;
  std::vector<Method> methods_;
  std::vector<ParameterDescription> descriptions_;
  std::vector<ParameterValue> values_;
};

}  // namespace tactus::live
