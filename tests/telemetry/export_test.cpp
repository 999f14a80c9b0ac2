// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/recording.hpp>
#include <tactus/data/telemetry/export.hpp>
#include <tactus/data/telemetry/recorder.hpp>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "tests/file_size_limit.hpp"
#include "tests/scratch_path.hpp"
#include "tests/telemetry/sample.hpp"
#include <gtest/gtest.h>

namespace tactus::telemetry {
namespace {

class Export : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_);
    auto log = LogWriter::create(folder_ / "log.mcap");
    const auto channel = log->add_channel(sample_channel("/run_1/sample"));
    for (std::int64_t k = 0; k < rows; ++k) write_sample(*log, channel, k);
    ASSERT_FALSE(log->close());
    auto read = read_log(folder_);
    ASSERT_TRUE(read);
    content_ = *std::move(read);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  /// Reads a signal with the reader of recordings, which knows nothing of logs, and compares every value.
  void expect_forces(const recording::Source& source, const std::string& unit) const {
    const auto force = recording::read(source);
    ASSERT_TRUE(force) << describe(force.error());
    EXPECT_EQ(force->unit, unit);
    EXPECT_NEAR(force->sample_time_s.value_or(0.0), 0.001, 1e-12);
    ASSERT_EQ(force->values.size(), static_cast<std::size_t>(rows));
    for (std::int64_t k = 0; k < rows; ++k) {
      EXPECT_EQ(force->values[static_cast<std::size_t>(k)], sample(k).force_N);
    }
  }

  [[nodiscard]] Check export_as_named(const std::filesystem::path& file) const {
    if (file.extension() == ".csv") return export_csv(content_, file);
    return file.extension() == ".mat" ? export_mat(content_, file) : export_hdf5(content_, file);
  }

  static constexpr std::int64_t rows = 1000;
  std::filesystem::path folder_ = scratch_path();
  LogContent content_;
};

TEST_F(Export, CsvIsARecordingWithNamesUnitsAndEqualValues) {
  const auto file = folder_ / "log.csv";
  ASSERT_FALSE(export_csv(content_, file));
  expect_forces({.file = file, .variable = "force"}, "N");
}

TEST_F(Export, MatlabFileIsARecordingWithEqualValues) {
  const auto file = folder_ / "log.mat";
  ASSERT_FALSE(export_mat(content_, file));
  expect_forces({.file = file, .variable = "run_1_sample.force_N", .time = "run_1_sample.time_s"}, "");
}

TEST_F(Export, APlaceThatCannotBeWrittenIsAnErrorAndLeavesNothing) {
  for (const char* name : {"absent/log.csv", "absent/log.mat", "absent/log.h5"}) {
    const Check error = export_as_named(folder_ / name);
    ASSERT_TRUE(error) << name;
    EXPECT_EQ(error->code, ErrorCode::unwritable);
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

TEST_F(Export, ADiskThatFillsHalfwayIsAnErrorAndLeavesNothing) {
  for (const char* name : {"log.csv", "log.mat", "log.h5"}) {
    const Check error = [&] {
      const FileSizeLimit limit(4096);
      EXPECT_TRUE(limit.ok());
      return export_as_named(folder_ / name);
    }();
    ASSERT_TRUE(error) << name;
    EXPECT_EQ(error->code, ErrorCode::unwritable);
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

TEST_F(Export, ARecordWithoutATimeGetsThatOfItsMessages) {
  auto log = LogWriter::create(folder_ / "log.mcap");
  const auto channel = log->add_channel({.topic = "/gaps", .type_name = "t/msg/Gap", .columns = columns_of<Gap>()});
  for (std::uint32_t k = 0; k < 5; ++k) {
    log->write(channel, k, 2'000'000 * std::uint64_t{k}, to_cdr(Gap{.channel = 1, .dropped = k, .lost = 0}));
  }
  ASSERT_FALSE(log->close());
  ASSERT_FALSE(export_csv(*read_log(folder_), folder_ / "gaps.csv"));
  const auto dropped = recording::read({.file = folder_ / "gaps.csv", .variable = "dropped"});
  ASSERT_TRUE(dropped) << describe(dropped.error());
  EXPECT_EQ(dropped->values, (std::vector<double>{0, 1, 2, 3, 4}));
  EXPECT_NEAR(dropped->sample_time_s.value_or(0.0), 0.002, 1e-12);
}

/// A topic and a signal that no library of others stands: long, not letters, twice the same once they are cut.
LogTable hostile_table(const std::string& topic, double value) {
  LogTable table{.topic = topic, .type_name = "t", .columns = {}, .values = {}, .times_ns = {0, 1'000'000}};
  const std::string long_name(3000, 'a');
  for (const std::string& name :
       {long_name, long_name + "b", std::string("=cmd|' /C calc'!A0"), std::string("a/b/../c"), std::string("a.b"),
        std::string("units"), std::string(), std::string("7,\"\n8")}) {
    table.columns.push_back({.name = name, .unit = std::string("x\033[2J,\"\n").append(500, 'u')});
    table.values.push_back({value, value + 1.0});
    value += 10.0;
  }
  return table;
}

TEST_F(Export, NamesThatNoLibraryStandsAreCutAndMadeUniqueInEveryFormat) {
  const std::string long_topic = "/" + std::string(2041, 't');
  LogContent content;
  content.summary.metadata["tactus"] = {
      {std::string(5000, 'k'), "text"}, {std::string(5001, 'k'), "other"}, {"1=", ""}};
  double value = 0.0;
  for (const std::string& topic :
       {long_topic, long_topic + "x", std::string("/about"), std::string("//../=x\033[2J")}) {
    content.tables.push_back(hostile_table(topic, value += 1000.0));
  }
  ASSERT_FALSE(export_mat(content, folder_ / "hostile.mat"));
  ASSERT_FALSE(export_hdf5(content, folder_ / "hostile.h5"));
  const auto entries = recording::contents(folder_ / "hostile.mat");
  ASSERT_TRUE(entries) << describe(entries.error());
  std::set<std::string> names;
  std::size_t signals = 0;
  for (const auto& entry : *entries) {
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
    EXPECT_LE(entry.name.size(), 3U * 64U);
    if (!entry.readable) continue;
    const auto read = recording::read({.file = folder_ / "hostile.mat", .variable = entry.name});
    ASSERT_TRUE(read) << describe(read.error());
    const std::size_t column = signals % 9;  // the times and eight signals
    const double expected = 1000.0 * static_cast<double>(1 + signals / 9) + 10.0 * static_cast<double>(column) - 10.0;
    EXPECT_EQ(read->values.front(), column == 0 ? 0.0 : expected) << entry.name;
    ++signals;
  }
  EXPECT_EQ(signals, 4U * 9U);
  const std::string cut(63, 't'), second = std::string(61, 't') + "_2";
  for (const std::string& name : {cut, second, std::string("about_2"), std::string("x__2J")}) {
    EXPECT_TRUE(names.contains(name + ".units_2")) << name;
    EXPECT_TRUE(names.contains(name + ".signal_")) << name;
    EXPECT_TRUE(names.contains(name + "." + std::string(63, 'a'))) << name;
    EXPECT_TRUE(names.contains(name + "." + std::string(61, 'a') + "_2")) << name;
  }

  ASSERT_FALSE(export_csv(content, folder_ / "hostile.csv"));
  std::ifstream file(folder_ / "hostile.csv");
  std::string head, first, second_row, more;
  std::getline(file, head);
  std::getline(file, first);
  std::getline(file, second_row);
  EXPECT_FALSE(std::getline(file, more)) << "no name made a line of its own";
  EXPECT_EQ(head.find('\033'), std::string::npos);
  EXPECT_EQ(head.find(",="), std::string::npos);
  const auto columns = recording::contents(folder_ / "hostile.csv");
  ASSERT_TRUE(columns) << describe(columns.error());
  EXPECT_EQ(columns->size(), 9U);
  const auto last = recording::read({.file = folder_ / "hostile.csv", .variable = "signal_7___8"});
  ASSERT_TRUE(last) << describe(last.error());
  EXPECT_EQ(last->values.back(), 1071.0);
}

TEST(ExportNames, ATopicBecomesAnIdentifier) {
  EXPECT_EQ(identifier_of("/run_1/teleoperator"), "run_1_teleoperator");
  EXPECT_EQ(identifier_of("/7th-axis"), "topic_7th_axis");
  EXPECT_EQ(identifier_of("/"), "topic_");
}

}  // namespace
}  // namespace tactus::telemetry
