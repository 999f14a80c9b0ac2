// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/plugin/driver_registry.hpp>
#include <tactus/kernel/core/joints.hpp>

#include <cstddef>
#include <cstdint>

/// A shared object that adds drivers to the `tactus` command: `tactus --plugin FILE.so run ...`.
///
///     tactus::Check add_my_drivers() { return tactus::devices::register_driver<MyArm>("my-arm", "an arm of ours"); }
///     TACTUS_PLUGIN(add_my_drivers)
///
/// It is compiled against the headers of the same version of tactus, by the same compiler, and linked with no library
/// of tactus: the command provides them.
namespace tactus::devices {

/// Differs where the types that cross the boundary have changed.
constexpr std::uint64_t plugin_layout() {
  std::uint64_t layout = 1;
  for (const std::size_t size : {sizeof(MotorCommand), sizeof(MotorReading), sizeof(MotorAbility), sizeof(DriverKind),
                                 sizeof(DriverRequest), sizeof(Binding), sizeof(Error), most_joints}) {
    layout = layout * 1'000'003 + size;
  }
  return layout;
}

/// What a plug-in exports as `tactus_plugin`.
struct Plugin {
  std::uint64_t layout;
  Check (*add)();
};

}  // namespace tactus::devices

#define TACTUS_PLUGIN(function)                                                                  \
  extern "C" __attribute__((visibility("default"))) const tactus::devices::Plugin tactus_plugin; \
  const tactus::devices::Plugin tactus_plugin{tactus::devices::plugin_layout(), function};
