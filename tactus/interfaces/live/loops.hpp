// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/interfaces/live/loop.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_pair.hpp>
#include <tactus/simulation/teleoperator/teleoperator.hpp>

#include <memory>
#include <variant>

/// The kinds of loops that can run under a visitor's hand.
namespace tactus::live {

/// What a loop is made of: a teleoperator of one axis, or a pair of arms.
using LoopParams = std::variant<simulation::Teleoperator::Params, experiments::ArmPairSetup>;

/// How far before the hand's rest the wall lies, as the master's hand sees it, in m.
inline constexpr double loop_wall_m = 0.01;

/// A loop at rest. One axis begins at `start_m` toward the wall; arms begin in the pose that their experiment states,
/// and their hand joins a path that is elsewhere within half a second. Errors: what the parameters refuse.
Result<std::unique_ptr<Loop>> make_loop(const LoopParams& params, double start_m);

/// What a loop continues with where its parameters have changed.
struct LoopChange {
  std::unique_ptr<Loop> made;  ///< none where nothing changed
  bool goes_on = false;        ///< with parts of `made`; else it starts over as `made`
};
/// Of a loop with the parameters `before`, which are of the same kind as `after`. Errors: those of `make_loop`.
Result<LoopChange> change_loop(const LoopParams& before, const LoopParams& after, double start_m);

/// The most that the master's motor displays, in N; 0 where no single number states it, as of arms.
double force_limit_N(const LoopParams& params);

}  // namespace tactus::live
