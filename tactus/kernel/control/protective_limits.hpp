// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/architecture.hpp>

#include <string>

namespace tactus::control {

/// Refuses to drive a device that is not simulated within limits that nobody chose. The defaults of a gate are wide,
/// for any experiment; they protect no motor, no wall and no hand.
///
/// Of the site's gate every limit must differ from its default, and so must the force of the sign probe; of a site with
/// a second actuator the limits of its gate too. Times and what only a force sensor gives a meaning may stay: what a
/// tip sensor states counts at a slave whose `slave_force.source` is the sensor, what a hand's states not at all. A
/// value that equals the default counts as not chosen.
///
/// `senses_force`: the device has a force sensor, which motors of a bus have not.
///
/// Errors: `inconsistent`, naming all such keys below `[control]` and their values. Cold: allocates.
Check refuse_default_limits(const ControlParams& params, SiteRole role, bool senses_force = true);

/// The same of a gate alone, called `name`, before a motor whose site has no force sensor. Its keys are below `name`.
Check refuse_default_limits(const SafetyGate::Params& gate, const std::string& name);

/// Refuses a check whose threshold nothing can reach within the other limits, so that it looks like a protection and is
/// none. `params` are those that the site runs with, its gates within the limits of the device:
///
/// - `encoder.frozen_force_N` above the force limit; `encoder.unbalanced_force_N` and `force_sensor.residual_limit_N`
///   of a slave with a force sensor, too: a sensor that dropped out differs by no more than the motor's force;
/// - `reversal.force_N` above the force limit, where it is not the default that is out of reach on purpose, and with it
///   `reversal.gained_m_per_s` from where the gate latches a velocity on;
/// - `energy`, where `drain_W` is as much as the motor can give at all;
/// - `probe.force_N` above the force limit, which would cut its force.
///
/// A thermal rating above the force limit is not one of these: the force limit then protects the winding. Nothing is
/// asked of a motor that gives no force.
///
/// Errors: `inconsistent`, naming the key, both values and the largest that is useful. Cold: allocates.
Check refuse_unreachable(const ControlParams& params, SiteRole role, bool senses_force = true);
/// The same of a gate alone, called `name`, of a site without a force sensor.
Check refuse_unreachable(const SafetyGate::Params& gate, const std::string& name);

}  // namespace tactus::control
