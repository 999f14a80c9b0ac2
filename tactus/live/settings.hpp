#pragma once

#include <tactus/configuration/document.hpp>
#include <tactus/core/parameters.hpp>
#include <tactus/core/result.hpp>
#include <tactus/experiments/tapping/tapping.hpp>
#include <tactus/live/application.hpp>
#include <tactus/live/engine.hpp>

#include <array>
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
  /// From an experiment of the kind `tapping`. Its wall is put 10 mm before the place of rest. Errors: those of the
  /// document, and `wrong_type` for another kind.
  static Result<Settings> make(const configuration::Document& document);

  [[nodiscard]] const std::vector<ParameterDescription>& descriptions() const { return descriptions_; }
  [[nodiscard]] std::vector<Parameter> parameters() const;
  /// Errors: `unknown_key`, `wrong_type` and `out_of_bounds`, with name, value, bounds and remedy.
  Check set(const Parameter& wanted);

  /// The parameters of a loop as they are now set. Errors: what the described parameters refuse.
  [[nodiscard]] Result<simulation::Teleoperator::Params> of_loop(std::size_t loop) const;
  [[nodiscard]] bool runs(std::size_t loop) const;
  /// Nothing in it acts against instability.
  [[nodiscard]] bool is_plain(std::size_t loop) const;
  /// The wall as the master's hand sees it.
  static constexpr double wall_m = 0.01;

 private:
  explicit Settings(const configuration::Document& document) : document_(document) {}
  [[nodiscard]] const ParameterValue& value(std::string_view name) const;

  configuration::Document document_;
  std::vector<ParameterDescription> descriptions_;
  std::vector<ParameterValue> values_;
};

/// The parameters that the parts of a running loop hang on: what must be exchanged where `before` became `after`; none
/// where the loop must start over.
std::optional<simulation::Teleoperator::Parts> difference(const simulation::Teleoperator::Params& before,
                                                          const simulation::Teleoperator::Params& after);

}  // namespace tactus::live
