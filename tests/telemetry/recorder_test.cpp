// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/log_reader.hpp>
#include <tactus/data/telemetry/recorder.hpp>

#include <chrono>
#include <filesystem>
#include <thread>

#include "tests/allocation_counter.hpp"
#include "tests/scratch_path.hpp"
#include "tests/telemetry/sample.hpp"
#include <gtest/gtest.h>

namespace tactus::telemetry {
namespace {

class RecorderTest : public ::testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(file_); }
  std::filesystem::path file_ = scratch_path().concat(".mcap");
};

const LogTable* find(const LogContent& content, const std::string& topic) {
  for (const LogTable& table : content.tables) {
    if (table.topic == topic) return &table;
  }
  return nullptr;
}

TEST_F(RecorderTest, WhatTwoThreadsPushIsInTheLogInOrder) {
  auto recorder = Recorder::create(file_);
  ASSERT_TRUE(recorder);
  auto& master = recorder->add<Sample, 16384>("/master", "tactus_msgs/msg/Sample");
  auto& slave = recorder->add<Sample, 16384>("/slave", "tactus_msgs/msg/Sample");
  recorder->start(Seconds{0.001});
  constexpr std::int64_t count = 10'000;
  const auto produce = [](auto& stream) {
    for (std::int64_t k = 0; k < count; ++k) stream.push(time_of(k), sample(k));
  };
  std::thread other([&] { produce(slave); });
  produce(master);
  other.join();
  ASSERT_FALSE(recorder->stop());
  EXPECT_EQ(recorder->dropped(), (std::vector<std::uint64_t>{0, 0}));
  const auto log = read_log(file_);
  ASSERT_TRUE(log);
  ASSERT_EQ(log->tables.size(), 2U);
  for (const LogTable& table : log->tables) {
    ASSERT_EQ(table.times_ns.size(), static_cast<std::size_t>(count));
    EXPECT_EQ(table.missing, 0U);
    EXPECT_EQ(table.values[3].back(), static_cast<double>(-(count - 1)));
  }
}

TEST_F(RecorderTest, WhatIsOverwrittenBeforeItIsWrittenDownIsInTheLogAsANumber) {
  auto recorder = Recorder::create(file_);
  ASSERT_TRUE(recorder);
  auto& stream = recorder->add<Sample, 8>("/sample", "tactus_msgs/msg/Sample");
  for (std::int64_t k = 0; k < 20; ++k) stream.push(time_of(k), sample(k));  // nobody drains yet: 12 are overwritten
  recorder->start(Seconds{0.001});
  ASSERT_FALSE(recorder->stop());
  EXPECT_EQ(recorder->dropped(), (std::vector<std::uint64_t>{12}));

  const auto log = read_log(file_);
  ASSERT_TRUE(log);
  const LogTable* samples = find(*log, "/sample");
  const LogTable* gaps = find(*log, "/tactus/gaps");
  ASSERT_TRUE(samples != nullptr && gaps != nullptr);
  ASSERT_EQ(samples->times_ns.size(), 8U);
  EXPECT_EQ(samples->times_ns.front(), time_of(12)) << "the newest are kept";
  EXPECT_EQ(gaps->values[0].back(), 0.0);
  EXPECT_EQ(gaps->values[1].back(), 12.0);
}

TEST_F(RecorderTest, OneCopyIsForTheLogAndForWhoeverElseLooksOn) {
  auto recorder = Recorder::create(file_);
  ASSERT_TRUE(recorder);
  RecordStream<Sample> stream;
  recorder->add("/sample", "tactus_msgs/msg/Sample", stream);
  auto observer = stream.watch();
  for (std::int64_t k = 0; k < 20; ++k) stream.push(time_of(k), sample(k));
  recorder->start(Seconds{0.001});
  ASSERT_FALSE(recorder->stop());
  EXPECT_EQ(read_log(file_).value().tables.front().times_ns.size(), 20U);
  RecordStream<Sample>::Entry entry;
  for (std::uint64_t k = 0; k < 20; ++k) {
    ASSERT_TRUE(observer.next(entry));
    EXPECT_EQ(entry.number, k);
    EXPECT_EQ(entry.time_ns, time_of(static_cast<std::int64_t>(k)));
  }
  EXPECT_FALSE(observer.next(entry));
}

TEST_F(RecorderTest, AFullDiskLeavesThePushingThreadAloneAndIsReportedAtTheEnd) {
  auto recorder = Recorder::create("/dev/full");
  ASSERT_TRUE(recorder);
  auto& stream = recorder->add<Sample>("/sample", "tactus_msgs/msg/Sample");
  recorder->start(Seconds{0.001});
  for (std::int64_t k = 0; k < 200; ++k) {
    stream.push(time_of(k), sample(k));
    if (k % 20 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const Check error = recorder->stop();
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code, ErrorCode::unwritable);
  EXPECT_EQ(recorder->dropped()[0], 0U);
  EXPECT_EQ(recorder->log().counts()[0].lost, 200U);
  EXPECT_EQ(recorder->log().acknowledged(), 0U);
}

TEST_F(RecorderTest, APushDoesNotAllocate) {
  auto recorder = Recorder::create(file_);
  auto& stream = recorder->add<Sample>("/sample", "tactus_msgs/msg/Sample");
  const auto before = laws::allocation_count();
  for (std::int64_t k = 0; k < 5000; ++k) stream.push(time_of(k), sample(k));  // the last overwrite the first
  EXPECT_EQ(laws::allocation_count(), before);
}

}  // namespace
}  // namespace tactus::telemetry
