// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/dynamixel/packet.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::devices::dynamixel::packet_test {

using Bytes = std::vector<std::uint8_t>;

/// The definition, bit by bit, as a long division: independent of the table under test.
std::uint16_t divided(const Bytes& bytes) {
  std::uint32_t remainder = 0;
  const auto shift_in = [&](unsigned bit) {
    remainder = (remainder << 1) | bit;
    if ((remainder & 0x10000U) != 0) remainder ^= 0x18005U;
  };
  for (const std::uint8_t byte : bytes) {
    for (int bit = 7; bit >= 0; --bit) shift_in((byte >> bit) & 1U);
  }
  for (int i = 0; i < 16; ++i) shift_in(0);
  return static_cast<std::uint16_t>(remainder);
}

struct Message {
  std::uint8_t id;
  std::uint8_t instruction;
  Bytes parameters;
  bool operator==(const Message&) const = default;
};

Bytes bytes_of(const Message& message) {
  const auto packet = encode(message.id, static_cast<Instruction>(message.instruction), message.parameters);
  return {packet.bytes().begin(), packet.bytes().end()};
}

/// What is found in `bytes` that come in pieces of `piece`.
std::vector<Message> found(const Bytes& bytes, std::size_t piece) {
  PacketFinder<PacketFormat> finder;
  std::vector<Message> messages;
  const auto take = [&](std::span<const std::uint8_t> packet) {
    Heard heard;
    decode(packet, heard);
    messages.push_back({heard.id,
                        static_cast<std::uint8_t>(heard.instruction),
                        {heard.parameters().begin(), heard.parameters().end()}});
  };
  std::span<const std::uint8_t> rest = bytes;
  while (!rest.empty()) {
    const auto next = rest.first(std::min(piece, rest.size()));
    finder.hear(next, take);
    rest = rest.subspan(next.size());
  }
  finder.give_up(take);
  return messages;
}

struct Vector {
  Bytes bytes;
  Message message;
};

/// The protocol page's, typed from it, and those of the e-Manual's examples.
const std::vector<Vector>& vectors() {
  static const std::vector<Vector> all{
      {{0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x03, 0x00, 0x01, 0x19, 0x4E}, {1, 0x01, {}}},
      {{0xFF, 0xFF, 0xFD, 0x00, 0xFE, 0x03, 0x00, 0x01, 0x31, 0x42}, {254, 0x01, {}}},
      {{0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x07, 0x00, 0x55, 0x00, 0x06, 0x04, 0x26, 0x65, 0x5D},
       {1, 0x55, {0, 0x06, 0x04, 0x26}}},
      {{0xFF, 0xFF, 0xFD, 0x00, 0x02, 0x07, 0x00, 0x55, 0x00, 0x06, 0x04, 0x26, 0x6F, 0x6D},
       {2, 0x55, {0, 0x06, 0x04, 0x26}}},
      {{0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x07, 0x00, 0x02, 0x84, 0x00, 0x04, 0x00, 0x1D, 0x15},
       {1, 0x02, {0x84, 0, 4, 0}}},
      {{0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x06, 0x00, 0x03, 0x40, 0x00, 0x01, 0xDB, 0x66}, {1, 0x03, {0x40, 0, 1}}},
      {{0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x06, 0x00, 0x03, 0x0B, 0x00, 0x00, 0x42, 0xE3}, {1, 0x03, {0x0B, 0, 0}}},
      {{0xFF, 0xFF, 0xFD, 0x00, 0xFE, 0x09, 0x00, 0x82, 0x7E, 0x00, 0x0A, 0x00, 0x01, 0x02, 0x38, 0x92},
       {254, 0x82, {0x7E, 0, 0x0A, 0, 1, 2}}},
      {{0xFF, 0xFF, 0xFD, 0x00, 0xFE, 0x09, 0x00, 0x8A, 0x7E, 0x00, 0x0A, 0x00, 0x01, 0x02, 0xBB, 0x1A},
       {254, 0x8A, {0x7E, 0, 0x0A, 0, 1, 2}}},
      {{0xFF, 0xFF, 0xFD, 0x00, 0xFE, 0x0D, 0x00, 0x83, 0x66, 0x00,
        0x02, 0x00, 0x01, 0x64, 0x00, 0x02, 0x9C, 0xFF, 0xE1, 0xDB},
       {254, 0x83, {0x66, 0, 2, 0, 1, 0x64, 0, 2, 0x9C, 0xFF}}},
      {{0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x0E, 0x00, 0x55, 0x00, 0x05, 0x00,
        0xFD, 0xFF, 0xFF, 0xFF, 0x00, 0x08, 0x00, 0x00, 0x7A, 0xB2},
       {1, 0x55, {0, 5, 0, 0xFD, 0xFF, 0xFF, 0xFF, 0, 8, 0, 0}}},
      {{0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x0A, 0x00, 0x03, 0x74, 0x00, 0xFF, 0xFF, 0xFD, 0xFD, 0xFF, 0x23, 0xE5},
       {1, 0x03, {0x74, 0, 0xFF, 0xFF, 0xFD, 0xFF}}}};
  return all;
}

TEST(DynamixelPacket, EveryVectorIsWrittenAndReadAsItsSourceSays) {
  for (const auto& [bytes, message] : vectors()) {
    EXPECT_EQ(bytes_of(message), bytes);
    EXPECT_EQ(found(bytes, bytes.size()), std::vector{message});
  }
}

TEST(DynamixelPacket, TheFastAnswerOfTheEManualIsReadWithoutStuffing) {
  // Servos 3, 7 and 4 with their present positions 166, 2079 and 1023.
  const Bytes bytes{0xFF, 0xFF, 0xFD, 0x00, 0xFE, 0x19, 0x00, 0x55, 0x00, 0x03, 0xA6, 0x00, 0x00, 0x00, 0x84, 0x08,
                    0x00, 0x07, 0x1F, 0x08, 0x00, 0x00, 0x16, 0xCA, 0x00, 0x04, 0xFF, 0x03, 0x00, 0x00, 0xD1, 0x9E};
  const Message message{254, 0x55, {0x00, 0x03, 0xA6, 0x00, 0x00, 0x00, 0x84, 0x08, 0x00, 0x07, 0x1F,
                                    0x08, 0x00, 0x00, 0x16, 0xCA, 0x00, 0x04, 0xFF, 0x03, 0x00, 0x00}};
  EXPECT_EQ(found(bytes, 1), std::vector{message});
  // Bytes that a stuffed packet could not hold stay as they are.
  Bytes raw{0xFF, 0xFF, 0xFD, 0x00, 0xFE, 0x0B, 0x00, 0x55, 0x00, 0x03, 0xFF, 0xFF, 0xFD, 0xFD, 0x00, 0x00};
  const std::uint16_t crc = divided(raw);
  raw.push_back(static_cast<std::uint8_t>(crc));
  raw.push_back(static_cast<std::uint8_t>(crc >> 8));
  EXPECT_EQ(found(raw, 3), (std::vector{Message{254, 0x55, {0x00, 0x03, 0xFF, 0xFF, 0xFD, 0xFD, 0x00, 0x00}}}));
}

TEST(DynamixelPacket, TheCrcIsTheRemainderOfALongDivision) {
  signal::Random random(7);
  for (int i = 0; i < 2000; ++i) {
    Bytes bytes(random.bits() % 60);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random.bits());
    ASSERT_EQ(crc16(bytes), divided(bytes));
  }
}

/// Parameters rich in what must be stuffed.
Message any_message(signal::Random& random) {
  static constexpr std::array<std::uint8_t, 4> likely{0xff, 0xff, 0xfd, 0x00};
  Message message{static_cast<std::uint8_t>(random.bits() % 253), static_cast<std::uint8_t>(random.bits()), {}};
  message.parameters.resize(random.bits() % 64);
  for (auto& byte : message.parameters) {
    byte = random.bits() % 4 == 0 ? static_cast<std::uint8_t>(random.bits()) : likely[random.bits() % 4];
  }
  return message;
}

TEST(DynamixelPacket, WhateverIsSentIsReadAgainWholeOrInPiecesAfterEchoesAndGarbage) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    signal::Random random(seed);
    Bytes bytes;
    std::vector<Message> sent;
    for (int i = 0; i < 5; ++i) {
      if (random.bits() % 2 == 0) {
        // Garbage, also the beginning of a packet that does not go on.
        for (std::uint64_t n = random.bits() % 20; n > 0; --n)
          bytes.push_back(static_cast<std::uint8_t>(random.bits()));
        Bytes begun = bytes_of(any_message(random));
        begun.resize(random.bits() % begun.size());
        bytes.insert(bytes.end(), begun.begin(), begun.end());
      }
      sent.push_back(any_message(random));
      const Bytes packet = bytes_of(sent.back());
      // A reader that looks for three bytes of a header must not find one within a packet.
      for (std::size_t at = 4; at + 3 < packet.size() - 2; ++at) {
        ASSERT_FALSE(packet[at] == 0xff && packet[at + 1] == 0xff && packet[at + 2] == 0xfd && packet[at + 3] != 0xfd);
      }
      bytes.insert(bytes.end(), packet.begin(), packet.end());
    }
    for (const std::size_t piece : {std::size_t{1}, 1 + random.bits() % 30, bytes.size()}) {
      ASSERT_EQ(found(bytes, piece), sent) << seed;
    }
  }
}

TEST(DynamixelPacket, APacketMaySplitAtEveryByte) {
  for (const auto& vector : vectors()) {
    const Bytes& bytes = vector.bytes;
    for (std::size_t cut = 1; cut < bytes.size(); ++cut) {
      PacketFinder<PacketFormat> finder;
      int packets = 0;
      const auto count = [&](std::span<const std::uint8_t> packet) {
        ++packets;
        EXPECT_TRUE(std::ranges::equal(packet, bytes));
      };
      finder.hear(std::span(bytes).first(cut), count);
      EXPECT_EQ(packets, 0);
      finder.hear(std::span(bytes).subspan(cut), count);
      EXPECT_EQ(packets, 1);
    }
  }
}

TEST(DynamixelPacket, ADamagedPacketIsNotOneWhicheverByteIsDamaged) {
  for (const auto& [bytes, message] : vectors()) {
    for (std::size_t at = 0; at < bytes.size(); ++at) {
      Bytes damaged = bytes;
      damaged[at] = static_cast<std::uint8_t>(damaged[at] ^ 0x10);
      EXPECT_TRUE(found(damaged, 1).empty());
    }
  }
}

}  // namespace tactus::devices::dynamixel::packet_test
