#pragma once

#include <tactus/control/architecture.hpp>
#include <tactus/station/device_guard.hpp>

#include <memory>

/// What must be so before a site drives a device.
namespace tactus::station {

/// What must stand before a device that is not simulated; null for one that is. Errors: those of `check_limits`, under
/// `master` or `slave`; those of `refuse_default_limits`, under `control`.
Result<std::unique_ptr<GuardedDevice>> wall_before(Device& device, const control::ControlParams& control,
                                                   control::SiteRole role);

/// The parameters with the gates of a site within what its device allows, so that they act before the wall does and
/// what the site believes to be applied is.
control::ControlParams tightened(const control::ControlParams& control, control::SiteRole role,
                                 const DeviceLimits& device);

}  // namespace tactus::station
