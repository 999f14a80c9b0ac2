// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

/// How a stage of a site is treated by those that judge the loop without running it: linear analysis, and lanes, which
/// run many loops at once by arithmetic of their own.
///
/// Each stage declares it alongside its parameters, and what declares nothing is refused there by name, on or off:
///
///     static constexpr int linear_states = 2;  // it is linear, its steps are its model, of at most so many states
///     static std::optional<Unfit> not_linear(const Params& params);    // or: linear where this finds nothing
///     static std::optional<Unfit> not_on_lanes(const Params& params);  // on lanes, or off, where this finds nothing
///
/// A stage that is always on lanes finds nothing with any parameters.
namespace tactus::control {

/// What asks for something that an analysis cannot have. Both texts are literals.
struct Unfit {
  const char* key;     ///< among those of the stage
  const char* remedy;  ///< what to write there
};

/// Whether a stage states how linear analysis treats it.
template <class Stage>
concept DeclaredLinear = requires {
  Stage::linear_states;
}
|| requires(const typename Stage::Params& params) { Stage::not_linear(params); };

/// Whether a stage states how lanes treat it.
template <class Stage>
concept DeclaredOnLanes = requires(const typename Stage::Params& params) {
  Stage::not_on_lanes(params);
};

}  // namespace tactus::control
