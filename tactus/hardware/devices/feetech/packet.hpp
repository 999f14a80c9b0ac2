// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/servo/servo_packet.hpp>

#include <cstddef>
#include <cstdint>
#include <span>

/// Feetech's protocol of the STS, SMS and HLS series. Source: Feetech, memory tables of STS3215 and HLS; public
/// drivers.
namespace tactus::devices::feetech {

enum class Instruction : std::uint8_t { ping = 0x01, read = 0x02, write = 0x03, sync_read = 0x82, sync_write = 0x83 };

/// All servos.
inline constexpr std::uint8_t broadcast = 254;

/// The complement of the sum of what is between the header and it. Real-time safe.
std::uint8_t checksum(std::span<const std::uint8_t> bytes) noexcept;

/// A packet: header, id, length, instruction, parameters, checksum. Real-time safe.
ServoPacket encode(std::uint8_t id, Instruction instruction, std::span<const std::uint8_t> parameters) noexcept;

/// How packets are found among bytes: by header, length and checksum. A status packet has an error where others have an
/// instruction, and nothing else distinguishes them.
struct PacketFormat {
  /// The echo of a command to sixteen servos.
  static constexpr std::size_t most = 64;
  static std::size_t size(std::span<const std::uint8_t> begun) noexcept;
};

/// Numbers are a sign, at the bit of that number, and what is below it. Real-time safe.
constexpr std::int64_t from_sign_magnitude(std::int64_t raw, int sign_bit) noexcept {
  const std::int64_t sign = std::int64_t{1} << sign_bit;
  const std::int64_t magnitude = raw & (sign - 1);
  return (raw & sign) != 0 ? -magnitude : magnitude;
}
constexpr std::int64_t to_sign_magnitude(std::int64_t value, int sign_bit) noexcept {
  return value < 0 ? -value | std::int64_t{1} << sign_bit : value;
}

}  // namespace tactus::devices::feetech
