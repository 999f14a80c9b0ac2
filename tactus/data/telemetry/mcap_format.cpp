// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/mcap_format.hpp>

#include <zlib.h>

namespace tactus::telemetry::mcap {

std::uint32_t crc32_of(std::string_view bytes, std::uint32_t before) {
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());  // NOLINT: what zlib calls bytes
  return static_cast<std::uint32_t>(crc32_z(before, data, bytes.size()));
}

}  // namespace tactus::telemetry::mcap
