// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdlib>
#include <string>

namespace tactus::devices {

/// How many seeds a test of the faults of emulated peers takes: `usual` in the suite, more where
/// `scripts/device-faults` asks for them.
inline std::int64_t seeds(std::int64_t usual) {
  const char* asked = std::getenv("TACTUS_DEVICE_SEEDS");
  return asked == nullptr ? usual : std::stoll(asked);
}

}  // namespace tactus::devices
