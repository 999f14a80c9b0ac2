// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/architecture.hpp>
#include <tactus/kernel/control/stages/stage.hpp>
#include <tactus/kernel/core/result.hpp>

#include <functional>
#include <optional>
#include <string>
#include <string_view>

/// What architectures and stages have declared of themselves, and what is refused because they have not.
namespace tactus::stability {

/// Those that judge a loop without running it.
enum class Analysis { linear, lanes };

/// Finds nothing where `analysis` knows the loop of `control`. Else an error, `inconsistent`, that names the key, with
/// its section, and the remedy: an architecture or a stage that does not fit, or that has not declared how it is
/// treated.
Check check_declared(const control::ControlParams& control, Analysis analysis);

/// The same of one stage with the parameters `own`; `key_of` makes the key in a file of that of the stage, which is
/// empty for the stage itself.
template <class Stage>
Check check_stage(Analysis analysis, const typename Stage::Params& own,
                  const std::function<std::string(std::string_view)>& key_of);

namespace detail {

Error undeclared(Analysis analysis, const std::string& key);
Error unfit(Analysis analysis, const std::string& key, const char* remedy);

}  // namespace detail

template <class Stage>
Check check_stage(Analysis analysis, const typename Stage::Params& own,
                  const std::function<std::string(std::string_view)>& key_of) {
  std::optional<control::Unfit> found;
  if (analysis == Analysis::linear) {
    if constexpr (!control::DeclaredLinear<Stage>) return detail::undeclared(analysis, key_of(""));
    if constexpr (requires { Stage::not_linear(own); }) found = Stage::not_linear(own);
  } else {
    if constexpr (!control::DeclaredOnLanes<Stage>) return detail::undeclared(analysis, key_of(""));
    if constexpr (requires { Stage::not_on_lanes(own); }) found = Stage::not_on_lanes(own);
  }
  if (!found) return {};
  return detail::unfit(analysis, key_of(found->key), found->remedy);
}

}  // namespace tactus::stability
