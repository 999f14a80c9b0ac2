// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/dynamixel/packet.hpp>

#include <algorithm>

namespace tactus::devices::dynamixel {

namespace {

constexpr std::array<std::uint8_t, 4> header{0xff, 0xff, 0xfd, 0x00};
constexpr std::uint8_t stuffing = 0xfd;
constexpr std::size_t head_bytes = 7;  // up to the length
constexpr std::size_t crc_bytes = 2;

constexpr std::array<std::uint16_t, 256> crc_table = [] {
  std::array<std::uint16_t, 256> remainders{};
  for (std::size_t i = 0; i < remainders.size(); ++i) {
    auto crc = static_cast<std::uint16_t>(i << 8);
    for (int bit = 0; bit < 8; ++bit) {
      crc = static_cast<std::uint16_t>((crc & 0x8000) != 0 ? (crc << 1) ^ 0x8005 : crc << 1);
    }
    remainders[i] = crc;
  }
  return remainders;
}();

/// Whether the last three of `bytes` are those after which a byte is stuffed.
bool needs_stuffing(std::span<const std::uint8_t> bytes) noexcept {
  return bytes.size() >= 3 && std::ranges::equal(bytes.last(3), std::span(header).first(3));
}

}  // namespace

std::uint16_t crc16(std::span<const std::uint8_t> bytes) noexcept {
  std::uint16_t crc = 0;
  for (const std::uint8_t byte : bytes) {
    crc = static_cast<std::uint16_t>((crc << 8) ^ crc_table[(crc >> 8) ^ byte]);
  }
  return crc;
}

ServoPacket encode(std::uint8_t id, Instruction instruction, std::span<const std::uint8_t> parameters) noexcept {
  ServoPacket content;
  content.put(static_cast<std::uint8_t>(instruction));
  for (const std::uint8_t byte : parameters) {
    content.put(byte);
    if (needs_stuffing(content.bytes())) content.put(stuffing);
  }
  ServoPacket packet;
  packet.put(header);
  packet.put(id);
  packet.put(static_cast<std::int64_t>(content.size() + crc_bytes), 2);
  packet.put(content.bytes());
  packet.put(crc16(packet.bytes()), crc_bytes);
  return packet;
}

std::size_t PacketFormat::size(std::span<const std::uint8_t> begun) noexcept {
  const std::size_t seen = std::min(begun.size(), header.size());
  if (!std::ranges::equal(begun.first(seen), std::span(header).first(seen))) return 0;
  if (begun.size() < head_bytes) return head_bytes;
  const std::uint8_t id = begun[4];
  const auto size = head_bytes + static_cast<std::size_t>(little_endian(begun.subspan(5, 2)));
  if (id == 253 || id == 255 || size < head_bytes + 1 + crc_bytes || size > most) return 0;
  if (begun.size() < size) return size;
  const bool right = crc16(begun.first(size - crc_bytes)) == little_endian(begun.subspan(size - crc_bytes, crc_bytes));
  return right ? size : 0;
}

void decode(std::span<const std::uint8_t> packet, Heard& heard) noexcept {
  heard.id = packet[4];
  heard.instruction = static_cast<Instruction>(packet[head_bytes]);
  heard.size = 0;
  const bool stuffed = !(heard.id == broadcast && heard.instruction == Instruction::status);
  const auto content = packet.subspan(head_bytes, packet.size() - head_bytes - crc_bytes);
  for (std::size_t i = 1; i < content.size(); ++i) {
    if (stuffed && content[i] == stuffing && needs_stuffing(content.first(i))) continue;
    heard.room[heard.size++] = content[i];
  }
}

}  // namespace tactus::devices::dynamixel
