// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/log_reader.hpp>
#include <tactus/data/telemetry/mcap_format.hpp>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "tests/file_size_limit.hpp"
#include "tests/sanitizers.hpp"
#include "tests/scratch_path.hpp"
#include "tests/telemetry/sample.hpp"
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tactus::telemetry {
namespace {

class Log : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::filesystem::path path(const char* name = "log.mcap") const { return folder_ / name; }

  /// A log of chunks of ten messages.
  std::string small_log(std::int64_t messages, const char* name = "log.mcap") const {
    auto log = LogWriter::create(path(name));
    EXPECT_TRUE(log);
    log->add_metadata("tactus", {{"configuration", "[servo]\nrate_Hz = 5000\n"}, {"version", "1"}});
    const auto channel = log->add_channel(sample_channel("/sample"));
    for (std::int64_t k = 0; k < messages; ++k) {
      write_sample(*log, channel, k);
      if (k % 10 == 9) {
        EXPECT_FALSE(log->flush());
      }
    }
    EXPECT_FALSE(log->close());
    return content(path(name));
  }

  static std::string content(const std::filesystem::path& file) {
    std::ostringstream bytes;
    bytes << std::ifstream(file, std::ios::binary).rdbuf();
    return bytes.str();
  }

  /// A new file each time: some file systems wait for the disk when one is emptied and written again.
  void put(std::string_view bytes, const char* name = "cut.mcap") const {
    std::filesystem::remove(path(name));
    std::ofstream(path(name), std::ios::binary) << bytes;
  }

  /// Reads the file after each of many rounds of random damage. False where it gave more messages than can be in it.
  template <class Random>
  bool read_damaged(const std::string& whole, Random&& random) const {
    for (int round = 0; round < 1500; ++round) {
      std::string damaged = whole;
      const auto edits = 1 + random(8);
      for (std::uint64_t edit = 0; edit < edits; ++edit) {
        const std::size_t at = random(damaged.size());
        switch (random(4)) {
          case 0:
            damaged[at] = static_cast<char>(random(256));
            break;
          case 1:  // lengths and counts at their extremes
            damaged.replace(at, std::min<std::size_t>(8, damaged.size() - at), std::string(8, static_cast<char>(0xff)));
            break;
          case 2:
            damaged.erase(at, random(40));
            break;
          default:
            damaged.insert(at, damaged.substr(random(damaged.size()), random(60)));
        }
      }
      put(damaged);
      const auto log = read_log(path("cut.mcap"));
      if (log && log->summary.messages > 300) return false;
    }
    return true;
  }

  /// Ends of the chunks of a sound file.
  static std::vector<std::size_t> chunk_ends(std::string_view bytes) {
    std::vector<std::size_t> ends;
    std::size_t at = mcap::magic.size();
    while (at + mcap::record_head_bytes <= bytes.size() - mcap::magic.size()) {
      mcap::Cursor head(bytes.substr(at, mcap::record_head_bytes));
      const auto opcode = static_cast<mcap::Opcode>(head.take<unsigned char>());
      at += mcap::record_head_bytes + head.take<std::uint64_t>();
      if (opcode == mcap::Opcode::chunk) ends.push_back(at);
    }
    return ends;
  }

 private:
  std::filesystem::path folder_ = scratch_path();
};

/// Runs `body` in a process of its own and gives its exit status.
template <class Body>
int in_a_process(Body&& body) {
  const pid_t child = fork();
  if (child == 0) _exit(body());
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

/// From here on a request for more than 512 MiB fails. Sanitizers need more for themselves.
void limit_memory() {
#if !TACTUS_UNDER_ADDRESS_SANITIZER && !TACTUS_UNDER_THREAD_SANITIZER
  const rlimit limit{.rlim_cur = 512U << 20U, .rlim_max = 512U << 20U};
  setrlimit(RLIMIT_AS, &limit);
#endif
}

/// Whether the messages are samples 0, 1, 2 and so on; how many.
std::size_t count_samples(const LogContent& content) {
  if (content.tables.empty()) return 0;
  const LogTable& table = content.tables.front();
  for (std::size_t k = 0; k < table.times_ns.size(); ++k) {
    const Sample expected = sample(static_cast<std::int64_t>(k));
    EXPECT_EQ(table.times_ns[k], time_of(static_cast<std::int64_t>(k)));
    EXPECT_EQ(table.values[2][k], expected.force_N);
    EXPECT_EQ(table.values[3][k], static_cast<double>(expected.count));
  }
  return table.times_ns.size();
}

TEST_F(Log, ReadsBackAllThatWasWritten) {
  small_log(95);
  const auto log = read_log(path());
  ASSERT_TRUE(log) << describe(log.error());
  EXPECT_EQ(count_samples(*log), 95U);
  EXPECT_TRUE(log->summary.complete);
  EXPECT_EQ(log->summary.damaged_chunks, 0U);
  EXPECT_FALSE(log->summary.damaged_elsewhere);  // both checksums outside the chunks are right
  EXPECT_EQ(log->summary.metadata.at("tactus").at("configuration"), "[servo]\nrate_Hz = 5000\n");
  EXPECT_EQ(log->tables[0].columns, columns_of<Sample>());
  EXPECT_EQ(log->tables[0].missing, 0U);
}

TEST_F(Log, EqualCallsWriteEqualBytes) { EXPECT_EQ(small_log(50, "a.mcap"), small_log(50, "b.mcap")); }

TEST_F(Log, CutAtAnyByteItGivesEveryCompleteChunk) {
  const std::string whole = small_log(60);
  const auto ends = chunk_ends(whole);
  ASSERT_EQ(ends.size(), 6U);
  put(whole);
  for (std::size_t size = whole.size(); size-- > 0;) {
    std::filesystem::resize_file(path("cut.mcap"), size);
    const auto log = read_log(path("cut.mcap"));
    if (size < mcap::magic.size()) {
      EXPECT_FALSE(log);
      continue;
    }
    ASSERT_TRUE(log) << size;
    const auto complete = std::count_if(ends.begin(), ends.end(), [size](std::size_t end) { return end <= size; });
    ASSERT_EQ(count_samples(*log), 10U * static_cast<std::size_t>(complete)) << size;
    ASSERT_FALSE(log->summary.complete) << size;
  }
}

TEST_F(Log, AFlippedBitAnywhereIsNoticedOrChangesNothing) {
  const std::string whole = small_log(30);
  std::size_t unnoticed = 0;
  for (std::size_t at = mcap::magic.size(); at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << (at % 8)));
    put(damaged);
    const auto log = read_log(path("cut.mcap"));
    if (!log) continue;
    const LogSummary& summary = log->summary;
    if (summary.complete && summary.damaged_chunks == 0 && !summary.damaged_elsewhere) ++unnoticed;
  }
  EXPECT_EQ(unnoticed, 0U);
}

TEST_F(Log, RandomDamageNeverCrashesOrAsksForHugeMemory) {
  const std::string whole = small_log(30);
  std::uint64_t state = 88172645463325252U;  // Marsaglia's xorshift
  const auto random = [&state](std::uint64_t below) {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return state % below;
  };
  const int status = in_a_process([&] {
    limit_memory();
    return read_damaged(whole, random) ? 0 : 1;
  });
  EXPECT_EQ(status, 0);
}

TEST_F(Log, AFileWhoseOnlyChunkPromisesMoreThanItHoldsIsNoEmptyLog) {
  std::string bytes(mcap::magic);
  std::string chunk;
  mcap::append(chunk, std::uint64_t{0});
  mcap::append(chunk, std::uint64_t{0});
  mcap::append(chunk, std::uint64_t{1} << 60);  // uncompressed size
  mcap::append(chunk, std::uint32_t{0});
  mcap::append_text(chunk, "zstd");
  mcap::append(chunk, std::uint64_t{4});
  chunk += "none";
  mcap::append_record(bytes, mcap::Opcode::chunk, chunk);
  put(bytes);
  const auto log = read_log(path("cut.mcap"));
  ASSERT_FALSE(log);
  EXPECT_NE(log.error().message.find("not one of its 1 chunks can be read"), std::string::npos) << log.error().message;
}

TEST_F(Log, WhatIsNoLogIsAnErrorWithARemedy) {
  put("time,force\n0,1\n");
  for (const auto& file : {path("cut.mcap"), path("absent.mcap")}) {
    const auto log = read_log(file);
    ASSERT_FALSE(log);
    EXPECT_NE(describe(log.error()).find(": name a log"), std::string::npos) << describe(log.error());
  }
}

TEST_F(Log, SequenceNumbersTellHowManyMessagesAreMissing) {
  auto log = LogWriter::create(path());
  const auto channel = log->add_channel(sample_channel("/sample"));
  for (const std::int64_t k : {0, 1, 2, 7, 8, 10}) write_sample(*log, channel, k);
  ASSERT_FALSE(log->close());
  EXPECT_EQ(read_log(path())->tables[0].missing, 5U);
}

TEST_F(Log, AFullDiskIsReportedAndCounted) {
  auto log = LogWriter::create("/dev/full");
  ASSERT_TRUE(log);
  const auto channel = log->add_channel(sample_channel("/sample"));
  for (std::int64_t k = 0; k < 100; ++k) write_sample(*log, channel, k);
  const Check error = log->flush();
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code, ErrorCode::unwritable);
  EXPECT_NE(error->message.find("100 messages are lost"), std::string::npos) << error->message;
  EXPECT_EQ(log->acknowledged(), 0U);
  EXPECT_EQ(log->lost(), 100U);
  EXPECT_TRUE(log->close());
}

TEST_F(Log, WhereRoomEndsWithinAChunkTheFileKeepsAllBeforeAndGoesOnWhenThereIsRoom) {
  const int status = in_a_process([this] {
    auto log = LogWriter::create(path());
    const auto channel = log->add_channel(sample_channel("/sample"));
    std::int64_t k = 0;
    const auto chunk = [&] {
      for (int i = 0; i < 50; ++i) write_sample(*log, channel, k++);
      return log->flush();
    };
    // A limit on the size of files tears a write as a full disk does. The first two chunks fit, the third does not.
    if (chunk() || chunk()) return 1;
    const rlim_t size = std::filesystem::file_size(path());
    {
      const FileSizeLimit limit(size + 100);
      if (!limit.ok() || !chunk()) return 2;
    }
    if (std::filesystem::file_size(path()) != size) return 3;  // the torn part was cut off
    if (chunk()) return 4;
    if (log->acknowledged() != 150 || log->lost() != 50) return 5;
    return log->close() ? 0 : 6;  // says that something was lost
  });
  ASSERT_EQ(status, 0);
  const auto log = read_log(path());
  ASSERT_TRUE(log);
  EXPECT_TRUE(log->summary.complete);
  EXPECT_EQ(log->summary.damaged_chunks, 0U);
  EXPECT_FALSE(log->summary.damaged_elsewhere);
  EXPECT_EQ(log->tables[0].times_ns.size(), 150U);
  EXPECT_EQ(log->tables[0].missing, 50U);
}

TEST_F(Log, TwoHundredKilledWritersLoseNoAcknowledgedMessage) {
  std::uint64_t total = 0;
  for (int run = 0; run < 200; ++run) {
    std::filesystem::remove(path());
    int pipe_ends[2];
    ASSERT_EQ(pipe(pipe_ends), 0);
    const pid_t child = fork();
    if (child == 0) {
      auto log = LogWriter::create(path());
      const auto channel = log->add_channel(sample_channel("/sample"));
      for (std::int64_t k = 0;; ++k) {
        write_sample(*log, channel, k);
        if (k % 37 != 36) continue;
        if (log->flush()) _exit(1);
        const std::uint64_t acknowledged = log->acknowledged();
        if (::write(pipe_ends[1], &acknowledged, sizeof acknowledged) < 0) _exit(1);
      }
    }
    close(pipe_ends[1]);
    std::uint64_t acknowledged = 0, next = 0;
    // From its first word on the writer is in full swing; the moment of the end differs from run to run.
    ASSERT_EQ(read(pipe_ends[0], &next, sizeof next), static_cast<ssize_t>(sizeof next));
    usleep(static_cast<useconds_t>(100 + 37 * run % 3000));
    kill(child, SIGKILL);
    acknowledged = next;
    while (read(pipe_ends[0], &next, sizeof next) == static_cast<ssize_t>(sizeof next)) acknowledged = next;
    close(pipe_ends[0]);
    waitpid(child, nullptr, 0);

    const auto log = read_log(path());
    ASSERT_TRUE(log);
    ASSERT_GE(count_samples(*log), acknowledged) << "run " << run;
    ASSERT_EQ(log->summary.damaged_chunks, 0U);
    total += acknowledged;
  }
  EXPECT_GT(total, 200U * 37U);
  RecordProperty("acknowledged", std::to_string(total));
}

TEST_F(Log, TheFolderIsOneThatARos2BagToolTakes) {
  auto log = LogWriter::create(path());
  const auto channel = log->add_channel(sample_channel("/sample"));
  for (std::int64_t k = 5; k < 25; ++k) write_sample(*log, channel, k);
  ASSERT_FALSE(log->close());
  ASSERT_FALSE(write_bag_metadata(path(), *log));
  const std::string text = content(path("metadata.yaml"));
  for (const char* line :
       {"  version: 5\n", "  storage_identifier: mcap\n", "    nanoseconds: 19000000\n",
        "    nanoseconds_since_epoch: 5000000\n", "  message_count: 20\n", "        type: tactus_msgs/msg/Sample\n",
        "        serialization_format: cdr\n", "    - log.mcap\n"}) {
    EXPECT_NE(text.find(line), std::string::npos) << line << text;
  }
}

}  // namespace
}  // namespace tactus::telemetry
