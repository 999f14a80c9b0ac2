// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/station/device_registry.hpp>

#include <algorithm>
#include <string>
#include <vector>

namespace tactus::station {

namespace {

std::vector<DeviceKind>& registry() {
  static std::vector<DeviceKind> kinds;
  return kinds;
}

Error unknown(std::string_view name) {
  std::string message = "'";
  message += name;
  message += "' is no device: ";
  if (registry().empty()) {
    message +=
        "this program has only the simulated one: register yours in a program of your own, as "
        "examples/own-device does";
  } else {
    std::string_view between = "write one of ";
    for (const DeviceKind& kind : registry()) {
      message += between;
      message += kind.name;
      between = ", ";
    }
  }
  return {.code = ErrorCode::out_of_bounds, .parameter = {}, .message = message, .place = "--device"};
}

}  // namespace

std::span<const DeviceKind> device_kinds() { return registry(); }

void register_device(const DeviceKind& kind) {
  auto& all = registry();
  const auto same = std::find_if(all.begin(), all.end(), [&](const auto& other) { return other.name == kind.name; });
  if (same != all.end()) {
    *same = kind;
  } else {
    all.push_back(kind);
  }
}

Result<std::unique_ptr<Device>> open_device(std::string_view name, control::SiteRole role, Seconds tick) {
  const auto& all = registry();
  const auto kind = std::find_if(all.begin(), all.end(), [&](const auto& other) { return other.name == name; });
  if (kind == all.end()) return unknown(name);
  return kind->open(role, tick);
}

}  // namespace tactus::station
