// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/diagnosis/bag_signals.hpp>
#include <tactus/identification/diagnosis/columns.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include "tests/scratch_path.hpp"
#include "tests/telemetry/small_bag.hpp"
#include <gtest/gtest.h>

namespace tactus::diagnosis {
namespace bag_signals_test {

constexpr double two_pi = 2.0 * std::numbers::pi;

/// Three seconds of two joints at 200 Hz, the follower's stamps 1.2 ms behind the leader's, its second joint shaking at
/// 15 Hz; and a wrench.
std::string two_arms(const std::string& leader_topic, const std::string& follower_topic) {
  telemetry::SmallBag bag;
  const auto leader = bag.add_topic(leader_topic, "sensor_msgs/msg/JointState");
  const auto follower = bag.add_topic(follower_topic, "sensor_msgs/msg/JointState");
  const auto wrench = bag.add_topic("/follower/wrench", "geometry_msgs/msg/WrenchStamped");
  for (int i = 0; i < 600; ++i) {
    const std::int64_t time_ns = 5'000'000'000 + std::int64_t{5'000'000} * i;
    const double t = 0.005 * i, late = t + 0.0012;
    const double shake = 0.02 * std::sin(two_pi * 15.0 * late);
    bag.write(
        leader, time_ns,
        telemetry::joint_state(time_ns, {"j1", "j2"}, {std::sin(t), 0.1 * t}, {std::cos(t), 0.1}, {1.0, -2.0 - t}));
    bag.write(follower, time_ns,
              telemetry::joint_state(time_ns + 1'200'000, {"j2", "j1"}, {0.1 * late + shake, std::sin(late)}, {},
                                     {0.5 + t, 0.25}));
    bag.write(wrench, time_ns, telemetry::wrench_stamped(time_ns, {1, 0, 0, 0, 0, 0}));
  }
  return bag.whole();
}

class BagSignals : public ::testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(file_); }
  SignalRoles roles(const std::string& bytes) const {
    std::ofstream(file_, std::ios::binary) << bytes;
    return {.file = file_};
  }
  const std::filesystem::path file_ = scratch_path().string() + ".mcap";
};

TEST_F(BagSignals, TheRoughestJointOfLeaderAndFollowerIsReadAtCommonSteps) {
  const auto signals = read_signals(roles(two_arms("/leader/joint_states", "/follower/joint_states")));
  ASSERT_TRUE(signals) << describe(signals.error());
  EXPECT_NEAR(signals->sample_time.value, 0.005, 1e-9);
  EXPECT_TRUE(signals->rotary);
  const Channel* slave = signals->find(Role::slave_position);
  ASSERT_NE(slave, nullptr);
  EXPECT_EQ(slave->name, "/follower/joint_states/j2.position");
  const Channel* master = signals->find(Role::master_position);
  ASSERT_NE(master, nullptr);
  // The first time that both have is 1.2 ms after the leader's first.
  for (std::size_t i = 1; i + 2 < master->values.size(); ++i) {
    const double t = 0.0012 + 0.005 * static_cast<double>(i);
    ASSERT_NEAR(master->values[i], 0.1 * t, 1e-9) << i;
    ASSERT_NEAR(slave->values[i], 0.1 * t + 0.02 * std::sin(two_pi * 15.0 * t), 1e-9) << i;
  }
  EXPECT_NEAR(signals->find(Role::displayed_force)->values[100], 2.0 + 0.0012 + 0.5, 1e-9) << "it pushes back";
  EXPECT_NEAR(signals->find(Role::slave_force)->values[100], 0.5 + 0.5, 1e-9);
  std::string notes;
  for (const std::string& note : signals->notes) notes += note + "\n";
  for (const char* words : {"joint 'j2' moves most roughly", "--joint", "/follower/wrench"}) {
    EXPECT_NE(notes.find(words), std::string::npos) << words << " in " << notes;
  }
}

TEST_F(BagSignals, AJointOrSignalsAreNamedAndWhatIsNotThereIsRefusedWithTheList) {
  SignalRoles wanted = roles(two_arms("/leader/joint_states", "/follower/joint_states"));
  wanted.joint = "j1";
  auto signals = read_signals(wanted);
  ASSERT_TRUE(signals) << describe(signals.error());
  EXPECT_EQ(signals->find(Role::slave_position)->name, "/follower/joint_states/j1.position");
  EXPECT_TRUE(signals->master_velocity);

  wanted.joint = "j9";
  signals = read_signals(wanted);
  ASSERT_FALSE(signals);
  EXPECT_NE(signals.error().message.find("'j9': it has j1, j2"), std::string::npos) << signals.error().message;

  wanted = roles(two_arms("/one", "/other"));
  signals = read_signals(wanted);
  ASSERT_FALSE(signals);
  EXPECT_NE(signals.error().message.find("/one/j1.position"), std::string::npos) << signals.error().message;
  wanted.names[index_of(Role::master_position)] = "/one/j1.position";
  wanted.names[index_of(Role::slave_position)] = "other/j1.position";
  signals = read_signals(wanted);
  ASSERT_TRUE(signals) << describe(signals.error());
  EXPECT_EQ(signals->find(Role::displayed_force), nullptr);
}

}  // namespace bag_signals_test
}  // namespace tactus::diagnosis
