#pragma once

#include <tactus/control/architecture.hpp>

#include <string>

namespace tactus::control {

/// Refuses to drive a device that is not simulated within limits that nobody chose. The defaults of a gate are wide,
/// for any experiment; they protect no motor, no wall and no hand.
///
/// Of the site's gate every limit must differ from its default, and so must the force of the sign probe; of a site with
/// a second actuator the limits of its gate too. Times and what only a force sensor gives a meaning may stay: what a
/// tip sensor says counts at a slave whose `slave_force.source` is the sensor, what a hand's says not at all. A value
/// that equals the default counts as not chosen.
///
/// Errors: `inconsistent`, naming all such keys below `[control]` and their values. Cold: allocates.
Check refuse_default_limits(const ControlParams& params, SiteRole role);

/// The same of a gate alone, called `name`, before a motor whose site has no force sensor. Its keys stand below `name`.
Check refuse_default_limits(const SafetyGate::Params& gate, const std::string& name);

}  // namespace tactus::control
