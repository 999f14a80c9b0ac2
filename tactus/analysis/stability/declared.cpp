// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/declared.hpp>
#include <tactus/kernel/core/binding.hpp>

#include <utility>

namespace tactus::stability {

namespace {

template <class Stage>
struct Nothing {};

Error inconsistent(const std::string& key, std::string message) {
  std::string parameter = join("control", key);
  return {
      .code = ErrorCode::inconsistent, .parameter = std::move(parameter), .message = std::move(message), .place = {}};
}

Check check_architecture(const control::ControlParams& control, Analysis analysis) {
  const control::Architecture* architecture = control::find_architecture(control.architecture);
  const control::Likeness likeness =
      architecture == nullptr ? control::Likeness::unknown : architecture->like_position_force;
  if (likeness == control::Likeness::equal) return {};
  if (analysis == Analysis::lanes) return detail::unfit(analysis, "architecture", "write position-force");
  if (likeness == control::Likeness::about_rest) return {};
  return detail::unfit(
      analysis, "architecture",
      "the loop of induced motion is that of position-force: choose it, or judge others by tactus run");
}

}  // namespace

Error detail::undeclared(Analysis analysis, const std::string& key) {
  const char* what = analysis == Analysis::linear ? "is linear" : "runs on lanes";
  return inconsistent(
      std::move(key),
      std::string("has not declared whether it ") + what +
          ": declare it in its class as tactus/kernel/control/stages/stage.hpp describes, or use `tactus "
          "run`");
}

Error detail::unfit(Analysis analysis, const std::string& key, const char* remedy) {
  if (analysis == Analysis::linear) return inconsistent(key, remedy);
  return inconsistent(key, std::string("asks for something that the loop of a map does not have: ") + remedy +
                               ", or use `tactus run` with an experiment of kind tapping");
}

Check check_declared(const control::ControlParams& control, Analysis analysis) {
  using control::PositionForceMaster;
  Check found = check_architecture(control, analysis);
  const auto below = [](const char* section) { return [section](std::string_view own) { return join(section, own); }; };
  if (!found) {
    found = check_stage<control::SlaveForce>(analysis, control.slave_force, below("slave_force"));
  }
  if (!found) found = check_stage<control::ServoPd>(analysis, control.slave, below("slave"));
  PositionForceMaster::each_stage<Nothing>(
      control, [&]<class Stage>(const char* name, const typename Stage::Params& own) {
        const auto key_of = [name](std::string_view key) { return PositionForceMaster::site_key(name, key); };
        if (!found) found = check_stage<Stage>(analysis, own, key_of);
        return Nothing<Stage>{};
      });
  return found;
}

}  // namespace tactus::stability
