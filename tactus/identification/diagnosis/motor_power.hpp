// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/diagnosis/signals.hpp>

#include <optional>

namespace tactus::diagnosis {

/// The phase by which the force of the follower's motor leads the follower's velocity below 3 Hz, from the fit F = J·a
/// + b·v. Inertia and friction need 0 to 90 degrees, a spring at the tip 0 to -90, a command that acts late a little
/// more than 90. About 180 degrees, the motor takes energy out of a follower that moves nevertheless: the sign of force
/// or position is wrong, or something else moves the follower. -90 to 270. None if force or position was not recorded,
/// the follower does not move, or the fit explains less than half of the force. Not real-time safe.
std::optional<double> motor_phase_deg(const Signals& signals);

}  // namespace tactus::diagnosis
