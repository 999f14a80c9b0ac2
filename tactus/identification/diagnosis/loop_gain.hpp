// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/axis/axis_signals.hpp>
#include <tactus/kernel/core/units.hpp>

#include <optional>
#include <span>

namespace tactus::diagnosis {

/// The gain of a piecewise linear force to a sine, over its slope: `below` and `above` are the shares of a period that
/// the sine spends where the force does not follow, at its lower and at its upper end (out of contact, at a limit).
///
///     N = 2/π·[θ/2 + sin 2θ/4] from −π/2 + π·below to π/2 − π·above
///
/// 1 where both are 0, 0 where they fill the period. Source: Gelb and Vander Velde, Multiple-Input Describing Functions
/// and Nonlinear System Design, 1968, section 2.3.
double describing_gain(double below, double above);

/// The loop gain at an oscillation, for small motion, from the force that ends its growth: what sustains itself has the
/// gain 1 with its limits in it, so without them 1 / N: about by how much the loop must be turned down.
///
/// `force` is that of the oscillation alone. With `one_sided` its lower end is where it is zero (a contact that is
/// lost), else the other limit. Empty where it stays less than 3 % of the time at either end: nothing of this force
/// limits the motion. The interval is that of 95 % from a jackknife over eight blocks; it shows the scatter, not that
/// impacts are no sine.
std::optional<identification::Estimate> loop_gain(std::span<const double> force, bool one_sided);

}  // namespace tactus::diagnosis
