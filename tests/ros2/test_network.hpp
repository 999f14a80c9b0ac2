// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/runtime/ros2/names.hpp>

#include <string>

#include <unistd.h>

/// Tests run side by side, and other things may run on the machine: each process has a domain and a namespace of its
/// own, on loopback.
namespace tactus::ros2::test {

inline Network private_network() {
  return {.domain = 1 + static_cast<std::uint32_t>(getpid()) % 100, .loopback_only = true};
}

inline std::string private_namespace() { return "test_" + std::to_string(getpid()); }

}  // namespace tactus::ros2::test
