// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/simulation/experiments/gain_limit.hpp>
#include <tactus/simulation/teleoperator/teleoperator.hpp>

/// The gain limit in time: the simulated teleoperator itself, run at one gain after the other.
namespace tactus::stability {

/// The same rig without anything that is not linear: friction off, linkages straight at their average stiffness,
/// quintic hand off, sensors without steps, noise and offset, a still operator, the wall as a bond with the linearised
/// stiffness and damping at `preload_N`, a channel without jitter and loss.
simulation::Teleoperator::Params linear_version(simulation::Teleoperator::Params params, double preload_N = 1.0);

/// Whether a touch of a micrometre by the hand dies away, in the rig as it is, tip at the wall. The judge is the
/// second difference of the contact force from tick to tick, which slow motion of the hand hardly enters: its power in
/// the last of ten parts of the run over that in the third. For rigs that `linear_version` made. `params` must be those
/// of a teleoperator that can be made.
bool disturbance_decays(const simulation::Teleoperator::Params& params, double duration_s = 1.0);

/// The gain limit of a linear rig by bisection of `disturbance_decays`, between `lowest` and `highest`, to 0.1 %.
/// 0 where not even the lowest is stable; `beyond_search` where the highest still is.
experiments::GainLimit bisect_linear_limit(simulation::Teleoperator::Params params, double lowest, double highest);

}  // namespace tactus::stability
