// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/log_reader.hpp>
#include <tactus/data/telemetry/lz4.hpp>
#include <tactus/data/telemetry/mcap_format.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "tests/scratch_path.hpp"
#include "tests/telemetry/sample.hpp"
#include <gtest/gtest.h>
#include <zstd.h>

namespace tactus::telemetry {
namespace lz4_test {

std::string bytes_of(std::string_view hex) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
    bytes += static_cast<char>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16));
  }
  return bytes;
}

/// What LZ4F_compressFrame of liblz4 1.9.4 makes of `plain`.
const std::string foreign_frame = bytes_of(
    "04224d18604082460000004f74617020040089ff08616e64207468656e20736f6d657468696e6720656c7365180006f0113031323334353637"
    "38393a3b3c3d3e3f404142434445464748494a4b4c4d4e4f00000000");

std::string plain() {
  std::string text;
  for (int i = 0; i < 40; ++i) text += "tap ";
  text += "and then something else and then something else ";
  for (char c = 48; c < 80; ++c) text += c;
  return text;
}

TEST(Lz4, AFrameOfTheReferenceLibraryUnpacksToTheTextThatWentIn) {
  std::string into(plain().size(), '\0');
  ASSERT_TRUE(unpack_lz4(foreign_frame, into));
  EXPECT_EQ(into, plain());
}

TEST(Lz4, DamageAndWrongSizesAreRefusedAndNeverLeaveTheBuffer) {
  for (const std::size_t size : {plain().size() - 1, plain().size() + 1, std::size_t{0}}) {
    std::string into(size, '\0');
    EXPECT_FALSE(unpack_lz4(foreign_frame, into)) << size;
  }
  for (std::size_t length = 1; length < foreign_frame.size(); ++length) {
    std::string into(plain().size(), '\0');
    EXPECT_FALSE(unpack_lz4(foreign_frame.substr(0, length), into)) << length;
  }
  // A letter of the text may become another one, which the checksum of a chunk finds; a length may not.
  std::size_t accepted = 0;
  for (std::size_t at = 0; at < foreign_frame.size(); ++at) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      std::string damaged = foreign_frame;
      damaged[at] = static_cast<char>(static_cast<unsigned char>(damaged[at]) ^ (1U << bit));
      std::string into(plain().size(), '\0');
      if (unpack_lz4(damaged, into)) ++accepted;
    }
  }
  constexpr std::size_t literal_bytes = 60, flags_and_checksum_bytes = 3, offset_bytes = 6;
  EXPECT_LE(accepted, 8 * (literal_bytes + flags_and_checksum_bytes + offset_bytes));
}

/// A frame of one block that is not compressed.
std::string stored(std::string_view content) {
  std::string frame = bytes_of("04224d18604082");
  mcap::append(frame, static_cast<std::uint32_t>(0x80000000U | content.size()));
  frame += content;
  mcap::append(frame, std::uint32_t{0});
  return frame;
}

class RecompressedLog : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  /// Our own log of 30 messages, its chunks compressed anew.
  std::filesystem::path log_with(std::string_view compression) const {
    auto log = LogWriter::create(folder_ / "own.mcap");
    const auto channel = log->add_channel(sample_channel("/sample"));
    for (std::int64_t k = 0; k < 30; ++k) write_sample(*log, channel, k);
    EXPECT_FALSE(log->close());
    std::ostringstream own;
    own << std::ifstream(folder_ / "own.mcap", std::ios::binary).rdbuf();
    const std::string whole = own.str();
    std::string bytes(mcap::magic);
    mcap::Cursor cursor(std::string_view(whole).substr(mcap::magic.size()));
    while (cursor.rest().size() > mcap::magic.size()) {
      const auto opcode = static_cast<mcap::Opcode>(cursor.take<unsigned char>());
      const std::string_view content = cursor.take_bytes(cursor.take<std::uint64_t>());
      if (opcode == mcap::Opcode::data_end) break;  // as if the rest were cut off
      mcap::append_record(bytes, opcode, opcode == mcap::Opcode::chunk ? anew(content, compression) : content);
    }
    std::ofstream(folder_ / "anew.mcap", std::ios::binary) << bytes;
    return folder_ / "anew.mcap";
  }

 private:
  static std::string anew(std::string_view chunk, std::string_view compression) {
    mcap::Cursor cursor(chunk);
    std::string made(cursor.take_bytes(16));
    const auto size = cursor.take<std::uint64_t>();
    const auto crc = cursor.take<std::uint32_t>();
    EXPECT_EQ(cursor.take_text(), "zstd");
    const std::string_view packed = cursor.take_bytes(cursor.take<std::uint64_t>());
    std::string plain(size, '\0');
    EXPECT_EQ(ZSTD_decompress(plain.data(), plain.size(), packed.data(), packed.size()), size);
    const std::string frame = stored(plain);
    mcap::append(made, size);
    mcap::append(made, crc);
    mcap::append_text(made, compression);
    mcap::append(made, static_cast<std::uint64_t>(frame.size()));
    return made + frame;
  }

  std::filesystem::path folder_ = scratch_path();
};

TEST_F(RecompressedLog, ChunksOfLz4AreRead) {
  const auto log = read_log(log_with("lz4"));
  ASSERT_TRUE(log) << describe(log.error());
  EXPECT_EQ(log->summary.damaged_chunks, 0U);
  ASSERT_EQ(log->tables.size(), 1U);
  EXPECT_EQ(log->tables[0].times_ns.size(), 30U);
  EXPECT_EQ(log->tables[0].values[2][29], sample(29).force_N);
}

TEST_F(RecompressedLog, AnUnknownCompressionIsAnErrorAndNoEmptyLog) {
  const auto log = read_log(log_with("brotli"));
  ASSERT_FALSE(log);
  EXPECT_NE(log.error().message.find("compressed as 'brotli'"), std::string::npos) << log.error().message;
}

}  // namespace lz4_test
}  // namespace tactus::telemetry
