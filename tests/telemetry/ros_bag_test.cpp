// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/ros_bag.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/scratch_path.hpp"
#include "tests/telemetry/small_bag.hpp"
#include <gtest/gtest.h>

namespace tactus::telemetry {
namespace ros_bag_test {

class RosBag : public ::testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(file_); }
  Result<Bag> read(const std::string& bytes) const {
    std::ofstream(file_, std::ios::binary) << bytes;
    return read_bag(file_);
  }
  static const BagSignal* find(const Bag& bag, const std::string& name) {
    const auto found =
        std::find_if(bag.signals.begin(), bag.signals.end(), [&](const BagSignal& s) { return s.name() == name; });
    return found == bag.signals.end() ? nullptr : &*found;
  }
  const std::filesystem::path file_ = scratch_path().string() + ".mcap";
};

TEST_F(RosBag, JointsAreToldApartByNameAndStampsCount) {
  SmallBag bag;
  const auto joints = bag.add_topic("/joint_states", "sensor_msgs/msg/JointState");
  const auto force = bag.add_topic("/wrench", "geometry_msgs/msg/WrenchStamped");
  const auto other = bag.add_topic("/camera", "sensor_msgs/msg/Image");
  bag.write(other, 5, "anything");
  bag.write(joints, 99, joint_state(2'000'000'000, {"a", "bb"}, {1.0, 2.0}, {}, {3.0, 4.0}));
  bag.write(joints, 99, joint_state(2'010'000'000, {"bb", "a"}, {2.5, 1.5}, {}, {4.5, 3.5}));
  bag.write(force, 99, wrench_stamped(2'005'000'000, {1, 2, 3, 4, 5, 6}));
  const auto read_back = read(bag.whole());
  ASSERT_TRUE(read_back) << describe(read_back.error());
  const BagSignal* a = find(*read_back, "/joint_states/a.position");
  ASSERT_NE(a, nullptr);
  EXPECT_EQ(a->values, (std::vector<double>{1.0, 1.5}));
  EXPECT_EQ(a->unit, "rad");
  ASSERT_EQ(a->time_s.size(), 2U);
  EXPECT_DOUBLE_EQ(a->time_s[1] - a->time_s[0], 0.01);
  EXPECT_EQ(find(*read_back, "/joint_states/bb.effort")->values, (std::vector<double>{4.0, 4.5}));
  EXPECT_EQ(find(*read_back, "/joint_states/a.velocity"), nullptr) << "its messages had none";
  ASSERT_NE(find(*read_back, "/wrench/torque.y"), nullptr);
  EXPECT_EQ(find(*read_back, "/wrench/torque.y")->values.front(), 5.0);
  EXPECT_DOUBLE_EQ(find(*read_back, "/wrench/force.x")->time_s.front(), 0.005);
  EXPECT_EQ(read_back->ignored, std::vector<std::string>{"/camera (sensor_msgs/msg/Image, 1 messages)"});
  EXPECT_TRUE(read_back->complete);
}

TEST_F(RosBag, WithoutAStampTheTimeOfReceptionCounts) {
  SmallBag bag;
  const auto joints = bag.add_topic("/joint_states", "sensor_msgs/msg/JointState");
  bag.write(joints, 1'000'000, joint_state(0, {"a"}, {1.0}, {}, {}));
  bag.write(joints, 3'000'000, joint_state(0, {"a"}, {1.0}, {}, {}));
  const auto read_back = read(bag.whole());
  ASSERT_TRUE(read_back) << describe(read_back.error());
  EXPECT_DOUBLE_EQ(read_back->signals.front().time_s[1], 0.002);
}

TEST_F(RosBag, DamagedMessagesAndBagsWithoutArmsAreRefusedByName) {
  SmallBag bag;
  const auto joints = bag.add_topic("/joint_states", "sensor_msgs/msg/JointState");
  const std::string whole = joint_state(1, {"a", "bb"}, {1.0, 2.0}, {0.1, 0.2}, {});
  for (std::size_t length = 0; length < whole.size(); ++length) {
    SmallBag cut;
    const auto topic = cut.add_topic("/joint_states", "sensor_msgs/msg/JointState");
    cut.write(topic, 1, std::string_view(whole).substr(0, length));
    const auto refused = read(cut.whole());
    ASSERT_FALSE(refused) << length;
    EXPECT_NE(refused.error().message.find("message 1 of /joint_states"), std::string::npos) << refused.error().message;
  }
  bag.write(joints, 1, whole);
  EXPECT_TRUE(read(bag.whole()));
  SmallBag camera;
  camera.write(camera.add_topic("/camera", "sensor_msgs/msg/Image"), 1, "anything");
  const auto refused = read(camera.whole());
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("/camera (sensor_msgs/msg/Image"), std::string::npos)
      << refused.error().message;
}

}  // namespace ros_bag_test
}  // namespace tactus::telemetry
