// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/link/key.hpp>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <tests/scratch_path.hpp>
#include <unistd.h>

namespace tactus::link {
namespace {

class KeyFile : public ::testing::Test {
 protected:
  ~KeyFile() override { std::filesystem::remove(file); }
  void write(const std::string& text) const {
    std::ofstream(file) << text;
    chmod(file.c_str(), 0600);
  }
  const std::filesystem::path file = scratch_path();
  const std::string good = "9a4f06c2d17be835f0621c8d3eb7594ac86f12e0a5d93b7401fe682c5b90d747\n";
};

TEST_F(KeyFile, IsReadAsItWasMadeAndOnlyItsOwnerMayTouchIt) {
  ASSERT_EQ(make_key_file(file), std::nullopt);
  struct stat status {};
  ASSERT_EQ(stat(file.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777U, 0600U);
  const auto key = read_key_file(file);
  ASSERT_TRUE(key) << describe(key.error());
  EXPECT_NE(key->secret, Key().secret);
}

TEST_F(KeyFile, TwoKeysDiffer) {
  const std::filesystem::path other = file.string() + "_other";
  ASSERT_EQ(make_key_file(file), std::nullopt);
  ASSERT_EQ(make_key_file(other), std::nullopt);
  EXPECT_NE(read_key_file(file).value().secret, read_key_file(other).value().secret);
  std::filesystem::remove(other);
}

TEST_F(KeyFile, IsNeverOverwritten) {
  write("mine");
  const Check error = make_key_file(file);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code, ErrorCode::unwritable);
  std::string content;
  std::ifstream(file) >> content;
  EXPECT_EQ(content, "mine");
}

TEST_F(KeyFile, DigitsAreTheBytesOfTheSecret) {
  write("00ff" + good.substr(4, 58) + "11\n");
  const auto key = read_key_file(file);
  ASSERT_TRUE(key);
  EXPECT_EQ(key->secret[0], 0x00);
  EXPECT_EQ(key->secret[1], 0xff);
  EXPECT_EQ(key->secret[31], 0x11);
}

TEST_F(KeyFile, ThatOthersMayReadOrWriteIsRefusedWithTheRemedy) {
  write(good);
  for (const mode_t mode : {0640U, 0604U, 0620U, 0602U, 0610U, 0601U, 0644U, 0666U, 0700U}) {
    ASSERT_EQ(chmod(file.c_str(), mode), 0);
    const auto key = read_key_file(file);
    ASSERT_FALSE(key) << mode;
    EXPECT_NE(key.error().message.find("chmod 600 " + file.string()), std::string::npos);
  }
  ASSERT_EQ(chmod(file.c_str(), 0400), 0);
  EXPECT_TRUE(read_key_file(file));
}

TEST_F(KeyFile, OfAnotherOwnerIsRefused) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can give a file away";
  write(good);
  ASSERT_EQ(chown(file.c_str(), 65534, 65534), 0);
  const auto key = read_key_file(file);
  ASSERT_FALSE(key);
  EXPECT_NE(key.error().message.find("another user"), std::string::npos);
}

TEST_F(KeyFile, ThatIsALinkAFolderOrNothingIsRefused) {
  const std::filesystem::path target = file.string() + "_target";
  ASSERT_EQ(make_key_file(target), std::nullopt);
  std::filesystem::create_symlink(target, file);
  EXPECT_EQ(read_key_file(file).error().code, ErrorCode::inconsistent);
  std::filesystem::remove(target);
  std::filesystem::remove(file);
  EXPECT_EQ(read_key_file(file).error().code, ErrorCode::missing);
  std::filesystem::create_directory(file);
  EXPECT_EQ(read_key_file(file).error().code, ErrorCode::inconsistent);
}

TEST_F(KeyFile, WithAnythingElseInItIsRefused) {
  for (const std::string& text :
       {std::string(), std::string("\n"), good.substr(1), good + "\n", std::string("g").append(good, 1),
        std::string("A").append(good, 1), good.substr(0, 64), std::string(100'000, 'a')}) {
    write(text);
    const auto key = read_key_file(file);
    ASSERT_FALSE(key) << text.size();
    EXPECT_EQ(key.error().code, ErrorCode::syntax);
  }
}

TEST_F(KeyFile, ThatWasPlainlyNotDrawnAtRandomIsRefused) {
  const auto repeated = [](const std::string& word) {
    std::string text;
    while (text.size() < 64) text += word;
    return text + "\n";
  };
  std::string counting, falling;
  for (int i = 0; i < 32; ++i) {
    char digits[3];
    std::snprintf(digits, sizeof digits, "%02x", i);
    counting += digits;
    std::snprintf(digits, sizeof digits, "%02x", 255 - 7 * i);
    falling += digits;
  }
  for (const std::string& text : {repeated("0"), repeated("f"), repeated("ab"), repeated("0123456789abcdef"),
                                  repeated(good.substr(0, 32)), counting + "\n", falling + "\n"}) {
    write(text);
    const auto key = read_key_file(file);
    ASSERT_FALSE(key) << text;
    EXPECT_EQ(key.error().code, ErrorCode::inconsistent);
    EXPECT_NE(key.error().message.find("not drawn at random"), std::string::npos);
    EXPECT_EQ(key.error().message.find(text.substr(0, 16)), std::string::npos) << "a secret is never shown";
  }
  for (int i = 0; i < 50; ++i) {
    std::filesystem::remove(file);
    ASSERT_EQ(make_key_file(file), std::nullopt);
    EXPECT_TRUE(read_key_file(file)) << i;
  }
}

}  // namespace
}  // namespace tactus::link
