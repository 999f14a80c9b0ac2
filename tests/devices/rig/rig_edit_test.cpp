// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/rig/rig_edit.hpp>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <tests/devices/rig/rig_files.hpp>
#include <tests/scratch_path.hpp>
#include <unistd.h>

namespace tactus::devices {
namespace rig_edit_test {

using rig_test::damiao_side;
using rig_test::joint;

std::string edited(const std::string& text, const std::string& path, double offset_rad) {
  const auto changed = with_offset(text, "rig.toml", {.joint = path, .offset_rad = offset_rad});
  return changed ? *changed : describe(changed.error());
}

TEST(RigEdit, AnOffsetTakesThePlaceOfTheOldOneAndAllElseStays) {
  const std::string before = "# mine\n" + damiao_side("arm.leader", "/dev/a") + joint("arm.leader.elbow", 1, "DM4310") +
                             "offset_rad =\t-1.25e-1   # measured on Monday\r\n\n" +
                             joint("arm.leader.wrist", 2, "DM4310", "offset_rad = 0.5");
  std::string after = before;
  after.replace(after.find("-1.25e-1"), 8, "0.321457");
  EXPECT_EQ(edited(before, "arm.leader.elbow", 0.3214567), after);
  after = before;
  after.replace(after.rfind("0.5"), 3, "-3.0");
  EXPECT_EQ(edited(before, "arm.leader.wrist", -3.0), after);
}

TEST(RigEdit, WhereNoneWasWrittenItStandsBelowTheMotor) {
  const std::string before = damiao_side("arm.leader", "/dev/a") + joint("arm.leader.elbow", 1, "DM4310");
  std::string after = before;
  after.insert(after.find("model"), "offset_rad = -0.25\n");
  EXPECT_EQ(edited(before, "arm.leader.elbow", -0.25), after);
  // With the line ends and the indentation of the file.
  std::string windows = before;
  windows.replace(windows.find("motor = 1\n"), 10, "  motor = 1  # the lower one\r\n");
  after = windows;
  after.insert(after.find("model"), "  offset_rad = -0.25\r\n");
  EXPECT_EQ(edited(windows, "arm.leader.elbow", -0.25), after);
}

TEST(RigEdit, ALayoutThatItDoesNotKnowIsLeftToItsOwner) {
  const std::string inline_table =
      damiao_side("arm.leader", "/dev/a") +
      "elbow = { motor = 1, model = \"DM4310\", lower_rad = -1, upper_rad = 1, velocity_limit_rad_per_s = 3, "
      "torque_limit_Nm = 1, torque_rate_limit_Nm_per_s = 50 }\n";
  EXPECT_EQ(edited(inline_table, "arm.leader.elbow", 0.1),
            "rig.toml:4:1: arm.leader.elbow.offset_rad: this layout is not changed by a program: write offset_rad = "
            "0.1 yourself");
}

TEST(RigEdit, AFileIsReplacedWholeAndALinkIsNotFollowed) {
  const auto folder = scratch_path();
  std::filesystem::create_directories(folder);
  const auto file = folder / "rig.toml", link = folder / "link.toml";
  const std::string text = damiao_side("arm.leader", "/dev/a") + joint("arm.leader.elbow", 1, "DM4310");
  std::ofstream(file) << text;
  std::filesystem::create_symlink(file, link);
  EXPECT_FALSE(write_offsets(file, {{"arm.leader.elbow", 0.5}}));
  std::ostringstream content;
  content << std::ifstream(file).rdbuf();
  EXPECT_NE(content.str().find("motor = 1\noffset_rad = 0.5\n"), std::string::npos);
  const Check refused = write_offsets(link, {{"arm.leader.elbow", 0.75}});
  ASSERT_TRUE(refused);
  EXPECT_NE(refused->message.find("symbolic link"), std::string::npos);
  std::ostringstream untouched;
  untouched << std::ifstream(file).rdbuf();
  EXPECT_EQ(untouched.str(), content.str());
  std::filesystem::remove_all(folder);
}

TEST(RigEdit, AFileKeepsItsModeAndItsOwner) {
  const auto folder = scratch_path();
  std::filesystem::create_directories(folder);
  const auto file = folder / "rig.toml";
  std::ofstream(file) << damiao_side("arm.leader", "/dev/a") + joint("arm.leader.elbow", 1, "DM4310");
  // Who is not the superuser can give a file to nobody else.
  constexpr uid_t other = 12345;
  const bool gives = geteuid() == 0;
  for (const mode_t mode : {0600U, 0640U, 0444U}) {
    if (gives) {
      ASSERT_EQ(chown(file.c_str(), other, other), 0);
    }
    ASSERT_EQ(chmod(file.c_str(), mode), 0);
    const Check wrong = write_offsets(file, {{"arm.leader.elbow", 0.5}});
    ASSERT_FALSE(wrong) << describe(*wrong);
    struct stat status {};
    ASSERT_EQ(stat(file.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 07777U, mode);
    EXPECT_EQ(status.st_uid, gives ? other : geteuid());
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1) << "no temporary file is left";
  std::filesystem::remove_all(folder);
}

}  // namespace rig_edit_test
}  // namespace tactus::devices
