// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/architecture.hpp>
#include <tactus/kernel/station/device_guard.hpp>

#include <cstddef>
#include <memory>

/// What must be so before a site drives a device.
namespace tactus::station {

/// What must be in front of a device that is not simulated; null for one that is. `control` is of as many joints.
/// Errors: those of `check_limits`, under `master` or `slave`; those of `refuse_default_limits` and
/// `refuse_unreachable`, under `control`; `inconsistent` for another number of joints.
template <class Reading>
Result<std::unique_ptr<GuardedDeviceOf<Reading>>> make_device_guard(
    DeviceOf<Reading>& device, const Each<Reading, control::ControlParams>& control, control::SiteRole role);

/// The same before sites that were made elsewhere, of so many joints: whoever made them answers for their gates
/// (`refuse_default_limits` of a gate).
template <class Reading>
Result<std::unique_ptr<GuardedDeviceOf<Reading>>> make_device_guard(DeviceOf<Reading>& device, std::size_t joints,
                                                                    control::SiteRole role);

/// The gate within what its device allows. For a device that reports its own velocity it also gets the step of that, an
/// `encoder.frozen_force_N` of 1.5 times the joint's force limit where it has the default, and an `energy.drain_W` of
/// at most half of what the joint can give.
control::SafetyGate::Params tightened(const control::SafetyGate::Params& gate, const DeviceLimits& device);
/// The parameters with the gates of a site within what its device allows, so that they act before the guard does and
/// what the site assumes to be applied is.
control::ControlParams tightened(const control::ControlParams& control, control::SiteRole role,
                                 const DeviceLimits& device);
Joints<control::ControlParams> tightened(const Joints<control::ControlParams>& control, control::SiteRole role,
                                         const Joints<DeviceLimits>& device);

}  // namespace tactus::station
