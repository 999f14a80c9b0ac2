// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/servo/servo_packet.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

/// Dynamixel's Protocol 2.0. Source: ROBOTIS e-Manual, "DYNAMIXEL Protocol 2.0".
namespace tactus::devices::dynamixel {

enum class Instruction : std::uint8_t {
  ping = 0x01,
  read = 0x02,
  write = 0x03,
  status = 0x55,
  sync_read = 0x82,
  sync_write = 0x83,
  fast_sync_read = 0x8a
};

/// All servos; and who answers a fast sync read.
inline constexpr std::uint8_t broadcast = 254;

/// CRC-16 of polynomial 0x8005, start 0, most significant bit first, nothing inverted. Real-time safe.
std::uint16_t crc16(std::span<const std::uint8_t> bytes) noexcept;

/// A packet: header, id, length, instruction, stuffed parameters, CRC. Real-time safe.
ServoPacket encode(std::uint8_t id, Instruction instruction, std::span<const std::uint8_t> parameters) noexcept;

/// How packets are found among bytes: by header, length and CRC.
struct PacketFormat {
  /// The answer of sixteen servos to a fast sync read of 14 bytes.
  static constexpr std::size_t most = 8 + 16 * (14 + 4);
  static std::size_t size(std::span<const std::uint8_t> begun) noexcept;
};

/// A packet as it was received. The echo of an own packet is one too, with its own instruction.
struct Heard {
  std::uint8_t id = 0;
  Instruction instruction = Instruction::status;  ///< or any other byte
  std::array<std::uint8_t, PacketFormat::most> room{};
  std::size_t size = 0;

  /// Without stuffing; of a status packet the error byte first.
  [[nodiscard]] std::span<const std::uint8_t> parameters() const noexcept { return {room.data(), size}; }
};

/// Reads a whole packet, as `PacketFinder` gives it. The answer to a fast sync read (a status from `broadcast`) is not
/// stuffed. Real-time safe.
void decode(std::span<const std::uint8_t> packet, Heard& heard) noexcept;

}  // namespace tactus::devices::dynamixel
