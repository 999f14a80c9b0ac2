// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/plugin/driver_registry.hpp>
#include <tactus/hardware/devices/rig/bus_kinds.hpp>

#include <algorithm>

namespace tactus::devices {

namespace {

std::vector<DriverKind>& all() {
  static std::vector<DriverKind> kinds;
  return kinds;
}

}  // namespace

std::span<const DriverKind> driver_kinds() { return all(); }

const DriverKind* find_driver(std::string_view name) {
  const auto found = std::ranges::find(all(), name, &DriverKind::name);
  return found == all().end() ? nullptr : &*found;
}

Check add_driver(DriverKind kind) {
  const auto refused = [&kind](const char* why) {
    return Error{
        .code = ErrorCode::inconsistent, .parameter = "name", .message = "'" + kind.name + "' " + why, .place = {}};
  };
  if (kind.name.empty()) return refused("is empty: a driver needs a name that rig files can state as bus");
  for (const auto& entry : enumerators(BusKind{})) {
    if (kind.name == entry.name) return refused("is the name of a built-in bus: choose another");
  }
  if (!kind.settings) return refused("has no settings: use register_driver");
  const auto found = std::ranges::find(all(), kind.name, &DriverKind::name);
  if (found != all().end()) {
    *found = std::move(kind);
  } else {
    all().push_back(std::move(kind));
  }
  return std::nullopt;
}

}  // namespace tactus::devices
