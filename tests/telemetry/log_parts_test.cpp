// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/log_reader.hpp>
#include <tactus/data/telemetry/mcap_format.hpp>
#include <tactus/data/telemetry/recorder.hpp>

#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>

#include "tests/scratch_path.hpp"
#include "tests/telemetry/sample.hpp"
#include <gtest/gtest.h>
#include <malloc.h>
#include <zstd.h>

/// Logs that are long: in parts, within a limit, and without taking more memory.
namespace tactus::telemetry {
namespace {

namespace fs = std::filesystem;

class LongLog : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] std::uintmax_t size_of_all() const {
    std::uintmax_t size = 0;
    for (const auto& entry : fs::directory_iterator(folder_)) size += entry.file_size();
    return size;
  }

  /// Writes samples that can hardly be compressed.
  void write_noise(LogWriter& log, std::uint16_t channel, std::int64_t first, std::int64_t count) {
    for (std::int64_t k = first; k < first + count; ++k) {
      Sample noise = sample(k);
      noise.force_N = uniform_(random_);
      noise.count = static_cast<std::int64_t>(random_());
      log.write(channel, static_cast<std::uint32_t>(k), time_of(k), to_cdr(noise));
    }
  }

  fs::path folder_ = scratch_path();

 private:
  std::mt19937_64 random_{11};
  std::uniform_real_distribution<double> uniform_{-1.0, 1.0};
};

constexpr std::uint64_t least_limit = LogWriter::least_limit_bytes;

TEST_F(LongLog, WithALimitItNeverTakesMoreAndKeepsTheNewestInPartsThatAreEachALog) {
  auto log = LogWriter::create(folder_ / "log.mcap", least_limit);
  ASSERT_TRUE(log) << describe(log.error());
  log->add_metadata("tactus", {{"configuration", "[servo]\nrate_Hz = 5000\n"}});
  const auto channel = log->add_channel(sample_channel("/sample"));
  constexpr std::int64_t step = 5000, steps = 160;
  std::uintmax_t largest = 0;
  for (std::int64_t k = 0; k < steps; ++k) {
    write_noise(*log, channel, k * step, step);
    largest = std::max(largest, size_of_all());
  }
  ASSERT_FALSE(log->close());
  ASSERT_FALSE(write_bag_metadata(folder_ / "log.mcap", *log));
  EXPECT_LE(std::max(largest, size_of_all()), least_limit);
  EXPECT_GT(size_of_all(), least_limit / 2) << "what was allowed is made use of";
  EXPECT_EQ(log->acknowledged(), static_cast<std::uint64_t>(step * steps));
  EXPECT_GT(log->removed(), 0U);

  // As one log: the newest, without a hole.
  const auto whole = read_log(folder_);
  ASSERT_TRUE(whole) << describe(whole.error());
  EXPECT_TRUE(whole->summary.complete);
  EXPECT_EQ(whole->summary.messages, log->acknowledged() - log->removed());
  ASSERT_EQ(whole->tables.size(), 1U);
  EXPECT_EQ(whole->tables[0].times_ns.back(), time_of(step * steps - 1));
  EXPECT_EQ(whole->tables[0].times_ns.front(), time_of(static_cast<std::int64_t>(log->removed())));
  EXPECT_EQ(whole->tables[0].missing, 0U);

  // Each part alone.
  std::ostringstream metadata;
  metadata << std::ifstream(folder_ / "metadata.yaml").rdbuf();
  std::uint64_t messages = 0;
  ASSERT_GT(log->parts().size(), 1U);
  for (const LogPartSummary& part : log->parts()) {
    const auto alone = read_log(part.file);
    ASSERT_TRUE(alone) << describe(alone.error());
    EXPECT_TRUE(alone->summary.complete);
    EXPECT_FALSE(alone->summary.damaged_elsewhere);
    EXPECT_EQ(alone->summary.damaged_chunks, 0U);
    EXPECT_EQ(alone->summary.metadata.at("tactus").at("configuration"), "[servo]\nrate_Hz = 5000\n");
    EXPECT_EQ(alone->tables.at(0).columns, columns_of<Sample>());
    EXPECT_EQ(alone->tables[0].times_ns.front(), part.first_time_ns);
    EXPECT_EQ(alone->tables[0].times_ns.back(), part.last_time_ns);
    EXPECT_EQ(alone->summary.messages, part.messages.at(0));
    messages += part.messages.at(0);
    EXPECT_NE(metadata.str().find("    - " + part.file.filename().string() + "\n"), std::string::npos);
  }
  EXPECT_EQ(messages, whole->summary.messages);
  EXPECT_NE(metadata.str().find("  message_count: " + std::to_string(messages) + "\n"), std::string::npos);
}

TEST_F(LongLog, AKilledWriterLeavesTheNewestParts) {
  auto log = LogWriter::create(folder_ / "log.mcap", least_limit);
  const auto channel = log->add_channel(sample_channel("/sample"));
  write_noise(*log, channel, 0, 300000);
  ASSERT_FALSE(log->flush());  // and no end
  const auto read = read_log(folder_);
  ASSERT_TRUE(read) << describe(read.error());
  EXPECT_FALSE(read->summary.complete);
  EXPECT_EQ(read->summary.messages, log->acknowledged() - log->removed());
  EXPECT_EQ(read->tables.at(0).times_ns.back(), time_of(299999));
}

TEST_F(LongLog, ALimitThatIsTooSmallIsRefusedWithTheRemedy) {
  const auto log = LogWriter::create(folder_ / "log.mcap", least_limit - 1);
  ASSERT_FALSE(log);
  EXPECT_EQ(log.error().code, ErrorCode::out_of_bounds);
  EXPECT_NE(log.error().message.find("allow it 8 MiB or more"), std::string::npos) << log.error().message;
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(LongLog, FilesOfDifferentLogsInAFolderAreNotReadAsOne) {
  for (const char* name : {"a_0.mcap", "b_1.mcap"}) ASSERT_FALSE(LogWriter::create(folder_ / name)->close());
  const auto read = read_log(folder_);
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().message.find("2 .mcap files"), std::string::npos);
}

TEST_F(LongLog, TenTimesTheChunksTakeNoMoreMemory) {
  auto log = LogWriter::create(folder_ / "log.mcap");
  const auto channel = log->add_channel(sample_channel("/sample"));
  std::int64_t k = 0;
  const auto heap_after = [&](std::int64_t chunks) {
    while (k < chunks) {
      write_sample(*log, channel, k++);
      EXPECT_FALSE(log->flush());
    }
    return mallinfo2().uordblks;
  };
  constexpr std::size_t bound = 300'000;  // of the end's index, of which each chunk makes a hundred bytes
  const std::size_t after_some = heap_after(2'000);
  EXPECT_LT(heap_after(20'000), after_some + bound);
  ASSERT_FALSE(log->close());
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
  const auto read = read_log(folder_);
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->summary.complete);
  EXPECT_FALSE(read->summary.damaged_elsewhere) << "the checksum of the end, its index included";
  EXPECT_EQ(read->summary.messages, 20'000U);
}

TEST_F(LongLog, EveryChunkIsInTheIndexAtTheEnd) {
  auto log = LogWriter::create(folder_ / "log.mcap");
  const auto channel = log->add_channel(sample_channel("/sample"));
  for (std::int64_t k = 0; k < 5'000; ++k) {
    write_sample(*log, channel, k);
    EXPECT_FALSE(log->flush());
  }
  ASSERT_FALSE(log->close());
  std::ostringstream content;
  content << std::ifstream(folder_ / "log.mcap", std::ios::binary).rdbuf();
  const std::string bytes = content.str();
  mcap::Cursor file(bytes);
  file.take_bytes(mcap::magic.size());
  std::vector<std::uint64_t> chunks, indexed;
  while (file.rest().size() > mcap::magic.size()) {
    const std::uint64_t at = bytes.size() - file.rest().size();
    const auto opcode = static_cast<mcap::Opcode>(file.take<unsigned char>());
    mcap::Cursor record(file.take_bytes(file.take<std::uint64_t>()));
    if (opcode == mcap::Opcode::chunk) chunks.push_back(at);
    if (opcode != mcap::Opcode::chunk_index) continue;
    record.take_bytes(16);
    indexed.push_back(record.take<std::uint64_t>());
  }
  EXPECT_EQ(chunks.size(), 5'000U);
  EXPECT_EQ(indexed, chunks);
}

TEST_F(LongLog, ALinkInItsPlaceIsNotFollowed) {
  std::ofstream(folder_ / "precious") << "kept";
  fs::create_symlink("precious", folder_ / "log.mcap");
  const auto log = LogWriter::create(folder_ / "log.mcap");
  ASSERT_FALSE(log);
  EXPECT_EQ(log.error().code, ErrorCode::unwritable);
  EXPECT_NE(log.error().message.find("symbolic link"), std::string::npos) << log.error().message;
  EXPECT_EQ(fs::file_size(folder_ / "precious"), 4U);
}

TEST_F(LongLog, AFewKilobytesThatUnpackToManyGigabytesAreRefused) {
  // Records that nobody knows, each of a mebibyte: what takes long is to unpack them.
  std::string zeros;
  for (int i = 0; i < 64; ++i) {
    mcap::append_record(zeros, mcap::Opcode{0x80},
                        std::string((std::size_t{1} << 20U) - mcap::record_head_bytes, '\0'));
  }
  std::string packed(ZSTD_compressBound(zeros.size()), '\0');
  packed.resize(ZSTD_compress(packed.data(), packed.size(), zeros.data(), zeros.size(), 1));
  std::string chunk;
  mcap::append(chunk, std::uint64_t{0});
  mcap::append(chunk, std::uint64_t{0});
  mcap::append(chunk, std::uint64_t{zeros.size()});
  mcap::append(chunk, std::uint32_t{0});
  mcap::append_text(chunk, "zstd");
  mcap::append(chunk, std::uint64_t{packed.size()});
  chunk += packed;
  std::string bytes(mcap::magic);
  for (int i = 0; i < 1000; ++i) mcap::append_record(bytes, mcap::Opcode::chunk, chunk);
  std::ofstream(folder_ / "log.mcap", std::ios::binary) << bytes;
  const auto read = read_log(folder_ / "log.mcap");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::out_of_bounds);
  EXPECT_NE(read.error().message.find("more than 4 GiB unpacked"), std::string::npos) << read.error().message;
}

}  // namespace
}  // namespace tactus::telemetry
