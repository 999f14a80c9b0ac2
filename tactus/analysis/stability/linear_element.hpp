// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/linearisation.hpp>
#include <tactus/analysis/stability/state_space.hpp>
#include <tactus/kernel/control/model/induced_motion_model.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/core/units.hpp>

#include <functional>

/// Linear models of sampled elements, found by stepping the very elements: there is no second copy of a difference
/// equation that could differ from the code that runs. Not real-time safe.
namespace tactus::stability {

/// The element that `step` steps, one input and one output, as a system of at most `order` states (1 or 2).
///
/// It gets a zero first, because some elements take their first sample for what has always been, then an impulse. The
/// recursion that the impulse response obeys is found by least squares (Prony); two states at most keep that well
/// conditioned. Errors: `failed` where no such recursion explains the response to 1e-9 of its peak, so for an element
/// that is not linear or has more states.
Result<StateSpace> probe(int order, const std::function<double(double)>& step);

/// The controller's model of induced motion: from the motor force in N, held over the tick, to the motor position in m
/// at its start. Its six states are those that the model shows; A and B are fitted to what it does under a random
/// force, and the fit must hold to 1e-9.
///
/// The quintic spring is left out. Friction and the linkage are as `linearisation` states, as those of the devices are:
/// friction, in the one model that has it, becomes dampers in the continuous form that the model's exact step over a
/// part of the tick has; the linkage has the chord that its law goes through when it is cycled.
/// Errors: those of `InducedMotionModel::make`; `failed` as in `probe`.
Result<StateSpace> probe_model(control::InducedMotionModel::Params params, Seconds dt,
                               const Linearisation& linearisation = {});

}  // namespace tactus::stability
