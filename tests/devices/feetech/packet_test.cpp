// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/feetech/packet.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <algorithm>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::devices::feetech::packet_test {

using Bytes = std::vector<std::uint8_t>;

std::vector<Bytes> found(const Bytes& bytes, std::size_t piece) {
  PacketFinder<PacketFormat> finder;
  std::vector<Bytes> packets;
  const auto take = [&](std::span<const std::uint8_t> packet) { packets.emplace_back(packet.begin(), packet.end()); };
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    finder.hear(std::span(bytes).subspan(at, std::min(piece, bytes.size() - at)), take);
  }
  finder.give_up(take);
  return packets;
}

struct Vector {
  Bytes bytes;
  std::uint8_t id, instruction;
  Bytes parameters;
};
/// The protocol page's, typed from it.
const std::vector<Vector>& vectors() {
  static const std::vector<Vector> all{
      {{0xFF, 0xFF, 0x01, 0x02, 0x01, 0xFB}, 1, 0x01, {}},
      {{0xFF, 0xFF, 0x01, 0x04, 0x02, 0x38, 0x0F, 0xB1}, 1, 0x02, {56, 15}},
      {{0xFF, 0xFF, 0xFE, 0x0A, 0x82, 0x38, 0x08, 0x01, 0x02, 0x03, 0x04, 0x05, 0x06, 0x20},
       0xFE,
       0x82,
       {56, 8, 1, 2, 3, 4, 5, 6}},
      {{0xFF, 0xFF, 0xFE, 0x0A, 0x83, 0x2A, 0x02, 0x01, 0x00, 0x08, 0x02, 0x00, 0x04, 0x39},
       0xFE,
       0x83,
       {42, 2, 1, 0, 8, 2, 0, 4}},
      {{0xFF, 0xFF, 0x01, 0x04, 0x03, 0x28, 0x01, 0xCE}, 1, 0x03, {40, 1}},
      {{0xFF, 0xFF, 0x01, 0x06, 0x00, 0x00, 0x08, 0x0A, 0x80, 0x66}, 1, 0x00, {0x00, 0x08, 0x0A, 0x80}}};
  return all;
}

TEST(FeetechPacket, EveryVectorIsWrittenAndFoundAsThePageSays) {
  for (const Vector& vector : vectors()) {
    const auto packet = encode(vector.id, static_cast<Instruction>(vector.instruction), vector.parameters);
    EXPECT_TRUE(std::ranges::equal(packet.bytes(), vector.bytes));
    EXPECT_EQ(found(vector.bytes, 1), std::vector<Bytes>(1, vector.bytes));
    for (std::size_t at = 0; at < vector.bytes.size(); ++at) {
      Bytes damaged = vector.bytes;
      damaged[at] = static_cast<std::uint8_t>(damaged[at] ^ 0x10);
      EXPECT_TRUE(found(damaged, 1).empty());
    }
  }
  // The numbers of the last one: position 2048, velocity -10.
  EXPECT_EQ(from_sign_magnitude(0x0800, 15), 2048);
  EXPECT_EQ(from_sign_magnitude(0x800A, 15), -10);
}

TEST(FeetechPacket, TheChecksumMakesTheSumOfAllButTheHeaderAllOnes) {
  signal::Random random(5);
  for (int i = 0; i < 2000; ++i) {
    Bytes bytes(random.bits() % 60);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random.bits());
    unsigned sum = checksum(bytes);
    for (const std::uint8_t byte : bytes) sum += byte;
    ASSERT_EQ(sum & 0xffU, 0xffU);
  }
}

TEST(FeetechPacket, ANumberWithItsSignBitIsReadAgain) {
  for (const int bit : {10, 11, 15}) {
    for (std::int64_t value = -(1 << bit) + 1; value < 1 << bit; ++value) {
      const std::int64_t raw = to_sign_magnitude(value, bit);
      ASSERT_GE(raw, 0);
      ASSERT_EQ(raw >> bit, value < 0 ? 1 : 0);
      ASSERT_EQ(from_sign_magnitude(raw, bit), value);
    }
  }
}

TEST(FeetechPacket, PacketsAreFoundWholeOrInPiecesBehindWhatIsNone) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    signal::Random random(seed);
    Bytes bytes;
    std::vector<Bytes> sent;
    for (int i = 0; i < 5; ++i) {
      // The beginning of a packet that does not go on. Its sum could be right by chance, so its length leaves no room.
      if (random.bits() % 2 == 0) bytes.insert(bytes.end(), {0xff, 0xff, 0x07, 0xf0});
      for (std::uint64_t n = random.bits() % 4; n > 0; --n) bytes.push_back(0xff);
      Bytes parameters(random.bits() % 20);
      for (auto& byte : parameters) byte = static_cast<std::uint8_t>(random.bits() % 3 == 0 ? 0xff : random.bits());
      const auto packet = encode(static_cast<std::uint8_t>(random.bits() % 254), Instruction::write, parameters);
      sent.emplace_back(packet.bytes().begin(), packet.bytes().end());
      bytes.insert(bytes.end(), sent.back().begin(), sent.back().end());
    }
    for (const std::size_t piece : {std::size_t{1}, 1 + random.bits() % 30, bytes.size()}) {
      ASSERT_EQ(found(bytes, piece), sent) << seed;
    }
  }
}

}  // namespace tactus::devices::feetech::packet_test
