// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <future>

#include "tests/cli/command.hpp"
#include "tests/ros2/fast_dds_peer.hpp"
#include "tests/ros2/test_network.hpp"
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace tactus::cli {
namespace {

using ros2::test::eventually;
using ros2::test::FastDdsPeer;
using Words = std::vector<std::string>;

/// The command itself among programs of another vendor.
class RunAmongRos2Nodes : public Command {
 protected:
  void SetUp() override {
    Command::SetUp();
    setenv("ROS_DOMAIN_ID", std::to_string(ros2::test::private_network().domain).c_str(), 1);
    setenv("ROS_LOCALHOST_ONLY", "1", 1);
    quick_experiment();
  }

  void expect_refusal(const Words& more, int status, const std::string& told) const {
    Words words{"run", "quick.toml", "--ros2"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = tactus(words);
    EXPECT_EQ(outcome.status, status) << outcome.err;
    EXPECT_NE(outcome.err.find(told), std::string::npos) << outcome.err;
    EXPECT_TRUE(outcome.out.empty()) << outcome.out;
  }
};

TEST_F(RunAmongRos2Nodes, AnotherVendorDrivesTheHandAndSeesMasterAndSlaveFollow) {
  const std::string name_space = ros2::test::private_namespace();
  const auto topic = [&](const char* name) { return ros2::dds_topic(name_space, name); };
  const char* const type = "sensor_msgs::msg::dds_::JointState_";
  FastDdsPeer peer(ros2::test::private_network().domain);
  peer.subscribe(topic("master/measured_js"), type);
  peer.subscribe(topic("slave/measured_js"), type);
  peer.advertise(topic("operator/servo_jp"), type);

  auto run = std::async(std::launch::async, [&] {
    return tactus(
        {"run", "quick.toml", "--ros2", "--namespace", name_space, "--set", "task.taps=4", "--json", "--out", "out"});
  });
  // Away from the wall, where no tap goes.
  const double requested_m = -0.03;
  const auto near = [&](const char* name) {
    const auto messages = peer.received(topic(name));
    return !messages.empty() &&
           std::fabs(ros2::test::joint_state_of(messages.back()).position.at(0) - requested_m) < 1e-3;
  };
  EXPECT_TRUE(eventually([&] {
    peer.publish(topic("operator/servo_jp"), ros2::test::to_fast_cdr({.position = {requested_m}}));
    return near("master/measured_js") && near("slave/measured_js");
  }));

  const Outcome outcome = run.get();
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto told = nlohmann::json::parse(outcome.out);
  EXPECT_TRUE(told.at("driven"));
  EXPECT_GT(told.at("requests"), 0);
  EXPECT_GT(told.at("published"), 100);
  EXPECT_EQ(told.at("dropped"), 0);
  EXPECT_EQ(told.at("commands_refused"), 0);

  EXPECT_NE(content("out/report.html").find("How time was kept"), std::string::npos);

  // The log has every tick: 5 kHz, a head and a line for each.
  ASSERT_EQ(tactus({"export", "out/log", "--to", "csv"}).status, 0);
  const std::string table = content("out/log/log.csv");
  const auto lines = std::count(table.begin(), table.end(), '\n');
  EXPECT_NEAR(static_cast<double>(lines - 1), 5000.0 * told.at("time_s").get<double>(), 1.0);
}

TEST_F(RunAmongRos2Nodes, WhatCannotBeDoneIsRefusedWithTheRemedy) {
  expect_refusal({"--vary", "control.force_gain=1,2"}, 2, "--set in place of --vary");
  expect_refusal({"--namespace", "1st"}, 2, "is no namespace of ROS 2");
  expect_refusal({"--set", "task.taps=-1"}, 2, "task.taps");
  EXPECT_EQ(tactus({"run", "quick.toml", "--namespace", "lab"}).status, 2);
  const Outcome other = tactus({"run", TACTUS_EXPERIMENT_FOLDER "/force-display.toml", "--ros2"});
  EXPECT_EQ(other.status, 2);
  EXPECT_NE(other.err.find("choose one of kind tapping"), std::string::npos) << other.err;

  setenv("ROS_DOMAIN_ID", "many", 1);
  expect_refusal({"--out", "out"}, 2, "ROS_DOMAIN_ID");
  setenv("ROS_DOMAIN_ID", "0", 1);
  setenv("ROS_LOCALHOST_ONLY", "0", 1);
  setenv("CYCLONEDDS_URI", "<General><Interfaces><NetworkInterface name='nowhere0'/></></>", 1);
  expect_refusal({"--out", "out"}, 1, "nowhere0");
  unsetenv("CYCLONEDDS_URI");
  EXPECT_EQ(files(), Words{"quick.toml"});
}

TEST_F(RunAmongRos2Nodes, WithNobodyThereTheTapsAreTappedInRealTime) {
  const Outcome outcome = tactus({"run", "quick.toml", "--ros2", "--namespace", ros2::test::private_namespace(),
                                  "--set", "task.taps=1", "--set", "task.slowest_m_per_s=0.2", "--set",
                                  "task.fastest_m_per_s=0.2", "--set", "task.observation_s=0.15"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("contacts"), std::string::npos) << outcome.out;
}

}  // namespace
}  // namespace tactus::cli
