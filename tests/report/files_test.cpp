// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/files.hpp>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "tests/file_size_limit.hpp"
#include <gtest/gtest.h>

namespace tactus::report {
namespace files_test {

namespace fs = std::filesystem;

/// A folder of its own for each test.
class Files : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(testing::TempDir()) / (std::string("tactus_report_") + test->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static std::string content(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
  }
  [[nodiscard]] std::ptrdiff_t entries() const {
    return std::distance(fs::directory_iterator(folder_), fs::directory_iterator());
  }
  static void expect_error(const Check& error, const fs::path& path, const std::string& reason) {
    ASSERT_TRUE(error.has_value());
    EXPECT_EQ(error->code, ErrorCode::unwritable);
    std::ostringstream quoted;
    quoted << '\'' << path.string() << '\'';
    EXPECT_NE(error->message.find(quoted.str()), std::string::npos) << error->message;
    EXPECT_NE(error->message.find(reason), std::string::npos) << error->message;
    EXPECT_NE(error->message.find("; "), std::string::npos) << "no remedy in: " << error->message;
  }

  fs::path folder_;
};

TEST_F(Files, AFileHoldsExactlyTheBytesGivenAndReplacesTheOldOne) {
  const std::string bytes("a\r\n\0b\xff", 6);
  ASSERT_FALSE(write_file(folder_ / "report.html", "a much longer text that was there before").has_value());
  ASSERT_FALSE(write_file(folder_ / "report.html", bytes).has_value());
  EXPECT_EQ(content(folder_ / "report.html"), bytes);
  EXPECT_EQ(entries(), 1);
}

TEST_F(Files, ADiskThatRefusesHalfwayLeavesTheOldFileAndNothingElse) {
  ASSERT_FALSE(write_file(folder_ / "report.html", "old").has_value());
  const Check error = [&] {
    const FileSizeLimit limit(4096);
    EXPECT_TRUE(limit.ok());
    return write_file(folder_ / "report.html", std::string(100'000, 'x'));
  }();
  expect_error(error, folder_ / "report.html", "File too large");
  EXPECT_EQ(content(folder_ / "report.html"), "old");
  EXPECT_EQ(entries(), 1);
}

TEST_F(Files, WhatALibraryWritesByNameReplacesTheFileOnlyIfItCouldWriteAll) {
  const fs::path path = folder_ / "map.h5";
  const auto write = [](const std::string& name, const char* text) {
    EXPECT_TRUE(fs::is_empty(name)) << "it is there for the library to open";
    std::ofstream(name) << text;
  };
  ASSERT_FALSE(replace_file(path, [&](const std::string& name) { return write(name, "whole"), true; }));
  EXPECT_EQ(content(path), "whole");
  const Check error = replace_file(path, [&](const std::string& name) { return write(name, "ha"), false; });
  ASSERT_TRUE(error.has_value());
  EXPECT_EQ(error->code, ErrorCode::unwritable);
  EXPECT_EQ(content(path), "whole");
  EXPECT_EQ(entries(), 1);
}

TEST_F(Files, AMissingFolderIsNamedWithTheRemedy) {
  const fs::path path = folder_ / "missing" / "report.html";
  const Check error = write_file(path, "x");
  expect_error(error, path, "No such file or directory");
  EXPECT_NE(error->message.find("create the folder"), std::string::npos);
  EXPECT_EQ(entries(), 0);
}

TEST_F(Files, AFolderInThePlaceOfTheFileIsRefused) {
  fs::create_directory(folder_ / "report.html");
  expect_error(write_file(folder_ / "report.html", "x"), folder_ / "report.html", "Is a directory");
  EXPECT_EQ(entries(), 1);
}

TEST_F(Files, ALinkIsNeitherFollowedNorReplaced) {
  std::ofstream(folder_ / "precious") << "kept";
  fs::create_symlink("precious", folder_ / "report.html");
  expect_error(write_file(folder_ / "report.html", "x"), folder_ / "report.html", "symbolic link");
  EXPECT_TRUE(fs::is_symlink(folder_ / "report.html"));
  EXPECT_EQ(content(folder_ / "precious"), "kept");
  EXPECT_EQ(entries(), 2);
}

TEST_F(Files, ADeviceIsNeverReplacedByAFile) {
  expect_error(write_file("/dev/null", "x"), "/dev/null", "not a regular file");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(Files, WhatAKilledRunLeftBehindIsNeitherUsedNorTouched) {
  std::ofstream(folder_ / ".report.html.0.partial") << "half";
  ASSERT_FALSE(write_file(folder_ / "report.html", "whole").has_value());
  EXPECT_EQ(content(folder_ / "report.html"), "whole");
  EXPECT_EQ(content(folder_ / ".report.html.0.partial"), "half");
}

TEST_F(Files, AFolderIsMadeWithItsParentsAndLeftEmpty) {
  ASSERT_FALSE(prepare_directory(folder_ / "a" / "b").has_value());
  EXPECT_TRUE(fs::is_directory(folder_ / "a" / "b"));
  EXPECT_TRUE(fs::is_empty(folder_ / "a" / "b"));
  EXPECT_FALSE(prepare_directory(folder_ / "a" / "b").has_value());
}

TEST_F(Files, AFolderBelowAFileIsRefused) {
  std::ofstream(folder_ / "file") << "x";
  expect_error(prepare_directory(folder_ / "file" / "out"), folder_ / "file" / "out", "Not a directory");
  EXPECT_TRUE(prepare_directory(folder_ / "file").has_value());
}

TEST_F(Files, AFolderInWhichNothingCanBeWrittenIsRefusedBeforeTheWork) {
  // Unlike a folder without permission, /proc refuses even the superuser.
  expect_error(prepare_directory("/proc"), "/proc", "");
  expect_error(prepare_directory("/proc/out"), "/proc/out", "");
  EXPECT_TRUE(prepare_directory("").has_value());
}

}  // namespace files_test
}  // namespace tactus::report
