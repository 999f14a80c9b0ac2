// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/site_supervisor.hpp>
#include <tactus/kernel/station/device.hpp>

#include <memory>
#include <span>
#include <string_view>

namespace tactus::station {

/// A kind of device by its name on the command line: where a user's own hardware plugs in.
struct DeviceKind {
  std::string_view name;
  std::string_view summary;
  /// Opens the device of a site whose servo thread steps once a `tick`. Cold: may allocate, block and fail.
  Result<std::unique_ptr<Device>> (*open)(control::SiteRole role, Seconds tick);
};

/// Every kind that was registered.
std::span<const DeviceKind> device_kinds();

/// Adds a kind. Call it before the command runs, from one thread; `name` and `summary` must outlive the program's use
/// of it. A second one of the same name takes the place of the first.
void register_device(const DeviceKind& kind);

/// Opens a device by the name of its kind. Errors: `out_of_bounds` for a name that nobody registered, with those that
/// there are; what `open` refuses.
Result<std::unique_ptr<Device>> open_device(std::string_view name, control::SiteRole role, Seconds tick);

}  // namespace tactus::station
