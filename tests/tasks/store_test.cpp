// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/core/version.hpp>
#include <tactus/simulation/tasks/build.hpp>
#include <tactus/simulation/tasks/store.hpp>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>
#include <tests/file_size_limit.hpp>
#include <tests/scratch_path.hpp>

namespace tactus::tasks {
namespace {

class Store : public ::testing::Test {
 protected:
  ~Store() override { std::filesystem::remove(file_); }

  [[nodiscard]] std::string content() const {
    std::ifstream file(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  void leave(const std::string& bytes) const { std::ofstream(file_, std::ios::binary) << bytes; }
  /// A file with two tasks.
  void leave_two() const {
    auto store = TaskStore::open(file_, "job");
    ASSERT_TRUE(store) << describe(store.error());
    ASSERT_FALSE(store->append("one", "first"));
    ASSERT_FALSE(store->append("two", std::string("second\0", 7)));
  }
  [[nodiscard]] std::string found(const std::string& key, const std::string& job = "job") const {
    const auto store = TaskStore::open(file_, job);
    if (!store) return describe(store.error());
    const auto value = store->find(key);
    if (!value) return describe(value.error());
    return value->value_or("none");
  }

  std::filesystem::path file_ = scratch_path();
};

TEST_F(Store, FindsAfterAnewStartWhatWasAppended) {
  leave_two();
  EXPECT_EQ(found("one"), "first");
  EXPECT_EQ(found("two"), std::string("second\0", 7));
  EXPECT_EQ(found("three"), "none");
  EXPECT_EQ(found("on"), "none");
  EXPECT_EQ(TaskStore::open(file_, "job")->size(), 2U);
}

TEST_F(Store, EveryTornEndIsTruncatedAndTheTasksBeforeItStay) {
  leave_two();
  const std::string whole = content();
  const std::size_t second = 4 + 4 + 3 + 7 + 4;  // lengths, key, value, checksum
  for (std::size_t torn = 1; torn < second; ++torn) {
    leave(whole.substr(0, whole.size() - torn));
    EXPECT_EQ(found("one"), "first") << torn;
    EXPECT_EQ(found("two"), "none") << torn;
    EXPECT_EQ(content(), whole.substr(0, whole.size() - second)) << torn;
  }
  const auto store = [this] {
    auto opened = TaskStore::open(file_, "job");
    EXPECT_FALSE(opened->append("two", std::string("second\0", 7)));
  };
  store();
  EXPECT_EQ(content(), whole);
}

TEST_F(Store, ATornStartOfTheFileIsWrittenAgain) {
  leave_two();
  const std::string whole = content();
  const std::size_t head = whole.size() - 22 - (4 + 4 + 3 + 5 + 4);
  for (std::size_t length = 0; length < head; ++length) {
    leave(whole.substr(0, length));
    EXPECT_EQ(found("one"), "none") << length;
    EXPECT_EQ(content(), whole.substr(0, head)) << length;
  }
}

TEST_F(Store, ADamagedRecordEndsWhatIsRead) {
  leave_two();
  std::string bytes = content();
  bytes[bytes.find("first")] ^= 1;
  leave(bytes);
  EXPECT_EQ(found("one"), "none");
  EXPECT_EQ(found("two"), "none");
}

TEST_F(Store, AFileOfAnotherJobIsRefusedAndStaysAsItIs) {
  leave_two();
  const std::string whole = content();
  EXPECT_NE(found("one", "another job").find("has finished tasks of another job"), std::string::npos);
  EXPECT_NE(found("one", "").find("another job"), std::string::npos);
  EXPECT_EQ(content(), whole);
}

TEST_F(Store, AFileOfAnotherVersionIsRefusedWithBothVersions) {
  leave_two();
  const std::string whole = content();
  std::string other = whole;
  other.replace(other.find("tasks 1"), 7, "tasks 2");
  leave(other);
  EXPECT_NE(found("one").find("in the format of another version"), std::string::npos);
  EXPECT_EQ(content(), other);
  leave("tactus tasks 1\n" + other.substr(0, 3));
  EXPECT_EQ(found("one"), "none") << "a torn first record has no version";

  // A first record of another version, with a right checksum: "9.9.9", "job" and their CRC-32 from another program.
  leave(std::string("tactus tasks 1\n") + std::string("\5\0\0\0\3\0\0\0"
                                                      "9.9.9job"
                                                      "\xe5\x07\x42\x30",
                                                      20));
  const std::string refusal = found("one");
  EXPECT_NE(refusal.find("of tactus 9.9.9, and this is " + version_and_build()), std::string::npos) << refusal;
}

TEST_F(Store, AFileOfAnotherBuildIsOneOfAnotherVersion) {
  const std::string build = version_and_build();
  ASSERT_TRUE(build.starts_with(std::string(version()) + ", build ")) << build;
  EXPECT_GE(build.size(), version().size() + 8 + 16) << build;
  EXPECT_EQ(build.find_first_not_of("0123456789abcdef", version().size() + 8), std::string::npos) << build;
  std::ifstream program("/proc/self/exe", std::ios::binary);
  const std::string content{std::istreambuf_iterator<char>(program), {}};
  std::string bytes;
  for (std::size_t i = version().size() + 8; i < build.size(); i += 2) {
    bytes += static_cast<char>(std::stoi(build.substr(i, 2), nullptr, 16));
  }
  EXPECT_NE(content.find(std::string("GNU\0", 4) + bytes), std::string::npos) << "as the linker wrote it";
}

TEST_F(Store, AnyOtherFileIsRefusedAndStaysAsItIs) {
  leave("time,position\n0,1\n");
  EXPECT_NE(found("one").find("is not a file of finished tasks"), std::string::npos);
  EXPECT_EQ(content(), "time,position\n0,1\n");
  leave("tac");
  EXPECT_EQ(found("one"), "none") << "the torn start of a file";
}

TEST_F(Store, ASecondProcessThatOpensTheFileIsRefused) {
  const auto store = TaskStore::open(file_, "job");
  ASSERT_TRUE(store);
  EXPECT_NE(found("one").find("another process is working on this job"), std::string::npos);
}

TEST_F(Store, APlaceWithoutRoomIsAnError) {
  EXPECT_EQ(TaskStore::open("/nowhere/tasks.partial", "job").error().code, ErrorCode::unwritable);
  auto store = TaskStore::open(file_, "job");
  ASSERT_TRUE(store);
  const FileSizeLimit limit(200);
  const auto error = store->append("one", std::string(1000, 'x'));
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code, ErrorCode::unwritable);
  EXPECT_NE(error->message.find("--out"), std::string::npos);
}

}  // namespace
}  // namespace tactus::tasks
