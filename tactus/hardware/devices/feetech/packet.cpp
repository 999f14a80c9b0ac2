// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/feetech/packet.hpp>

namespace tactus::devices::feetech {

namespace {

constexpr std::uint8_t begin = 0xff;     // twice
constexpr std::size_t head_bytes = 4;    // up to the length
constexpr std::size_t least_length = 2;  // instruction and checksum

}  // namespace

std::uint8_t checksum(std::span<const std::uint8_t> bytes) noexcept {
  unsigned sum = 0;
  for (const std::uint8_t byte : bytes) sum += byte;
  return static_cast<std::uint8_t>(~sum);
}

ServoPacket encode(std::uint8_t id, Instruction instruction, std::span<const std::uint8_t> parameters) noexcept {
  ServoPacket packet;
  packet.put(begin);
  packet.put(begin);
  packet.put(id);
  packet.put(static_cast<std::uint8_t>(parameters.size() + least_length));
  packet.put(static_cast<std::uint8_t>(instruction));
  packet.put(parameters);
  packet.put(checksum(packet.bytes().subspan(2)));
  return packet;
}

std::size_t PacketFormat::size(std::span<const std::uint8_t> begun) noexcept {
  if (begun[0] != begin || (begun.size() > 1 && begun[1] != begin)) return 0;
  if (begun.size() < head_bytes) return head_bytes;
  const std::size_t size = head_bytes + begun[3];
  if (begun[2] > broadcast || begun[3] < least_length || size > most) return 0;
  if (begun.size() < size) return size;
  return checksum(begun.subspan(2, size - 3)) == begun[size - 1] ? size : 0;
}

}  // namespace tactus::devices::feetech
