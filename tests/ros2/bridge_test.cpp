// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/ros2/bridge.hpp>

#include <limits>
#include <mutex>

#include "tests/ros2/fast_dds_peer.hpp"
#include "tests/ros2/test_network.hpp"
#include <gtest/gtest.h>

namespace tactus::ros2 {
namespace {

using test::eventually;
using test::FastDdsPeer;

constexpr const char* joint_state_type = "sensor_msgs::msg::dds_::JointState_";
constexpr const char* wrench_type = "geometry_msgs::msg::dds_::WrenchStamped_";
constexpr const char* text_type = "std_msgs::msg::dds_::String_";

/// A bridge and a program of another vendor that have met.
class BridgeTest : public ::testing::Test {
 protected:
  std::string topic(const char* name) const { return dds_topic(test::private_namespace(), name); }

  Bridge::Params params{.network = test::private_network(), .name_space = test::private_namespace(), .rate_Hz = 1000.0};
  FastDdsPeer peer{test::private_network().domain};
};

TEST_F(BridgeTest, AnotherVendorReceivesWhatTheTeleoperatorDoes) {
  const char* const joint_topics[] = {"master/measured_js", "master/setpoint_js", "slave/measured_js",
                                      "slave/setpoint_js", "operator/estimated_grip"};
  for (const char* name : joint_topics) peer.subscribe(topic(name), joint_state_type);
  for (const char* name : {"master/measured_cf", "slave/measured_cf"}) peer.subscribe(topic(name), wrench_type);
  peer.subscribe(topic("state"), text_type);
  Bridge bridge = Bridge::create(params).value();

  // Numbers that have no short binary form, so that equal means equal to the last bit.
  Snapshot at{.stamp_ns = 1'800'000'000'000'000'000};
  at.joints[0] = {.master_position_m = 0.1 / 3,
                  .master_force_N = -0.7 / 3,
                  .hand_force_N = 0.5 / 3,
                  .slave_position_m = 0.2 / 3,
                  .slave_command_m = 0.4 / 3,
                  .environment_force_N = 0.8 / 3,
                  .estimated_grip = 0.5 / 3,
                  .estimated_grip_deviation = 0.1 / 3};
  const auto last_of = [&](const char* name) { return peer.received(topic(name)).back(); };
  const auto all_have_come = [&] {
    at.stamp_ns += 1'000'000;
    bridge.publish(at);
    for (const char* name : joint_topics) {
      if (peer.received(topic(name)).empty()) return false;
    }
    return !peer.received(topic("master/measured_cf")).empty() && !peer.received(topic("slave/measured_cf")).empty() &&
           !peer.received(topic("state")).empty();
  };
  ASSERT_TRUE(eventually(all_have_come));

  JointState measured = test::joint_state_of(last_of("master/measured_js"));
  EXPECT_GT(measured.stamp_ns, 1'800'000'000'000'000'000);
  EXPECT_LE(measured.stamp_ns, at.stamp_ns);
  measured.stamp_ns = 0;
  EXPECT_EQ(measured, (JointState{.frame_id = "master", .name = {"master"}, .position = {0.1 / 3}}));
  EXPECT_EQ(test::joint_state_of(last_of("master/setpoint_js")).effort, std::vector{-0.7 / 3});
  EXPECT_TRUE(test::joint_state_of(last_of("master/setpoint_js")).position.empty());
  EXPECT_EQ(test::joint_state_of(last_of("slave/measured_js")).position, std::vector{0.2 / 3});
  EXPECT_EQ(test::joint_state_of(last_of("slave/setpoint_js")).position, std::vector{0.4 / 3});
  EXPECT_EQ(test::joint_state_of(last_of("slave/setpoint_js")).name, std::vector<std::string>{"slave"});
  EXPECT_EQ(test::wrench_of(last_of("master/measured_cf")).force_N, (std::array{0.5 / 3, 0.0, 0.0}));
  EXPECT_EQ(test::wrench_of(last_of("slave/measured_cf")).force_N, (std::array{-0.8 / 3, 0.0, 0.0}));
  EXPECT_EQ(test::wrench_of(last_of("slave/measured_cf")).frame_id, "slave");
  JointState grip = test::joint_state_of(last_of("operator/estimated_grip"));
  grip.stamp_ns = 0;
  EXPECT_EQ(grip,
            (JointState{.frame_id = "operator", .name = {"grip", "grip_deviation"}, .position = {0.5 / 3, 0.1 / 3}}));
  EXPECT_EQ(test::text_of(last_of("state")).data, "ENABLED");

  at.state = OperatingState::fault;
  ASSERT_TRUE(eventually([&] {
    at.stamp_ns += 1'000'000;
    bridge.publish(at);
    return test::text_of(last_of("state")).data == "FAULT";
  }));
  EXPECT_EQ(bridge.counts().dropped, 0U);
  EXPECT_EQ(bridge.counts().lost, 0U);
}

TEST_F(BridgeTest, TypesNamesQualitiesAndHashesAreThoseOfRos2) {
  const Bridge bridge = Bridge::create(params).value();
  const std::map<std::string, std::pair<std::string, std::string>> expected{
      {topic("master/measured_js"), {joint_state_type, JointState::type_hash}},
      {topic("master/setpoint_js"), {joint_state_type, JointState::type_hash}},
      {topic("master/measured_cf"), {wrench_type, WrenchStamped::type_hash}},
      {topic("slave/measured_js"), {joint_state_type, JointState::type_hash}},
      {topic("slave/setpoint_js"), {joint_state_type, JointState::type_hash}},
      {topic("slave/measured_cf"), {wrench_type, WrenchStamped::type_hash}},
      {topic("state"), {text_type, Text::type_hash}},
      {topic("operator/estimated_grip"), {joint_state_type, JointState::type_hash}},
      {topic("operator/servo_jp"), {joint_state_type, JointState::type_hash}}};
  ASSERT_TRUE(eventually([&] { return peer.announced().size() == expected.size(); }));
  for (const auto& [name, announcement] : peer.announced()) {
    SCOPED_TRACE(name);
    ASSERT_TRUE(expected.contains(name));
    EXPECT_EQ(announcement.type, expected.at(name).first);
    EXPECT_EQ(announcement.user_data, "typehash=" + expected.at(name).second + ";");
    EXPECT_TRUE(announcement.is_volatile);
    EXPECT_EQ(announcement.writes, !name.ends_with("servo_jp"));
    EXPECT_EQ(announcement.reliable, announcement.writes);
  }
}

TEST_F(BridgeTest, AnotherVendorTellsWhereTheHandIsMeantToBe) {
  peer.advertise(topic("operator/servo_jp"), joint_state_type);
  Bridge bridge = Bridge::create(params).value();
  ASSERT_TRUE(eventually([&] { return peer.readers(topic("operator/servo_jp")) == 1; }));
  EXPECT_EQ(bridge.take_request(), std::nullopt);
  const auto wish = [&](const JointState& command) {
    peer.publish(topic("operator/servo_jp"), test::to_fast_cdr(command));
  };

  // The bridge may learn of the other program later than the other way round, and then misses what is sent until then.
  std::optional<double> taken;
  ASSERT_TRUE(eventually([&] {
    wish({.name = {"operator"}, .position = {0.1 / 3}});
    return (taken = bridge.take_request()).has_value();
  }));
  EXPECT_EQ(taken, 0.1 / 3);
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  bridge.take_request();
  const std::uint64_t requests = bridge.counts().requests;

  // Of several the newest; what is no single finite position is refused.
  wish({.position = {0.01}});
  wish({.position = {0.02}});
  wish({.position = {}});
  wish({.position = {0.03, 0.04}});
  wish({.position = {std::numeric_limits<double>::quiet_NaN()}});
  wish({.position = {std::numeric_limits<double>::infinity()}});
  ASSERT_TRUE(eventually([&] { return bridge.counts().refused == 4; }));
  EXPECT_EQ(bridge.take_request(), 0.02);
  EXPECT_EQ(bridge.counts().requests, requests + 2);
}

/// `std_msgs/msg/String` in little-endian CDR.
test::Bytes cdr_of(const std::string& text) {
  const std::size_t length = text.size() + 1;
  test::Bytes bytes{0x00, 0x01, 0x00, 0x00};
  for (std::size_t i = 0; i < 4; ++i) bytes.push_back(static_cast<unsigned char>(length >> (8 * i)));
  bytes.insert(bytes.end(), text.begin(), text.end());
  bytes.push_back(0);
  return bytes;
}

TEST_F(BridgeTest, AnotherVendorAsksAndIsAnswered) {
  std::string asked;
  std::mutex mutex;
  params.takes_requests = false;
  params.ask = [&](const std::string& line) {
    const std::scoped_lock lock(mutex);
    asked = line;
    return "heard " + line;
  };
  peer.advertise(topic("request"), text_type);
  peer.subscribe(topic("answer"), text_type);
  const Bridge bridge = Bridge::create(params).value();
  ASSERT_TRUE(eventually([&] { return peer.readers(topic("request")) == 1; }));
  ASSERT_TRUE(eventually([&] {
    peer.publish(topic("request"), cdr_of("set force_gain 0.25"));
    const auto answers = peer.received(topic("answer"));
    return !answers.empty() && test::text_of(answers.back()).data == "heard set force_gain 0.25";
  }));
  const std::scoped_lock lock(mutex);
  EXPECT_EQ(asked, "set force_gain 0.25");
}

TEST_F(BridgeTest, MalformedMessagesAreDroppedAndTheNextGoodOneArrives) {
  const std::string name = topic("operator/servo_jp");
  peer.advertise(name, joint_state_type);
  Bridge bridge = Bridge::create(params).value();
  ASSERT_TRUE(eventually([&] { return peer.readers(name) == 1; }));

  const test::Bytes last = test::to_fast_cdr({.position = {0.125}});
  const auto arrives = [&](const test::Bytes& message, double position) {
    return eventually([&] {
      peer.publish(name, message);
      return bridge.take_request() == position;
    });
  };
  ASSERT_TRUE(arrives(last, 0.125));
  const test::Bytes good = test::to_fast_cdr({.frame_id = "hand", .name = {"operator"}, .position = {0.5}});
  // Cut anywhere: every byte belongs to the message. (Below four bytes Fast DDS itself sends nothing.)
  for (std::size_t length = 4; length < good.size(); ++length) {
    peer.publish(name, test::Bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(length)));
  }
  // Lengths that promise far more than there is, in the place of every length and every other word.
  for (std::size_t at = 4; at + 4 <= good.size(); at += 4) {
    for (const unsigned char length : {std::uint8_t{0x7f}, std::uint8_t{0xff}}) {
      test::Bytes bytes = good;
      for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = length;
      peer.publish(name, bytes);
    }
  }
  // A header of an encoding that this is not, and a message without end.
  for (unsigned char encoding = 2; encoding < 32; ++encoding) {
    test::Bytes bytes = good;
    bytes[1] = encoding;
    peer.publish(name, bytes);
  }
  peer.publish(name, test::to_fast_cdr({.position = std::vector<double>(16'000, 0.25)}));

  EXPECT_TRUE(arrives(last, 0.125));
  // Of the wrong words, those within stamp, texts and numbers leave a message that is well formed.
  EXPECT_LE(bridge.counts().requests, 1 + 2 * good.size() / 4);
}

TEST_F(BridgeTest, TheMeasuredSignalsComeAtTheRateThatWasAskedFor) {
  params.rate_Hz = 100.0;
  Bridge bridge = Bridge::create(params).value();
  // One second of a servo at 5 kHz, and then a clock that is set back by a minute.
  for (const std::int64_t start_s : {1000, 940}) {
    for (int tick = 0; tick < 5000; ++tick) {
      bridge.publish({.stamp_ns = start_s * 1'000'000'000 + tick * 200'000});
      if (tick % 1000 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  bridge.close();
  EXPECT_EQ(bridge.counts().published, 200U);
  EXPECT_EQ(bridge.counts().dropped, 0U);
}

TEST_F(BridgeTest, WhatIsTooMuchForTheBridgeIsDroppedAndCounted) {
  params.rate_Hz = 10'000.0;
  Bridge bridge = Bridge::create(params).value();
  for (std::int64_t tick = 0; tick < 100'000; ++tick) bridge.publish({.stamp_ns = (1 + tick) * 200'000});
  bridge.close();
  EXPECT_GT(bridge.counts().dropped, 0U);
  EXPECT_EQ(bridge.counts().published + bridge.counts().dropped, 100'000U);
}

TEST(Bridge, ABadNamespaceAndABadRateAreRefusedBeforeAnythingIsOpened) {
  Bridge::Params params;
  params.name_space = "no good";
  EXPECT_EQ(Bridge::create(params).error().code, ErrorCode::syntax);
  for (const double rate_Hz : {0.0, -1.0, 10'001.0, std::numeric_limits<double>::quiet_NaN()}) {
    Bridge::Params wrong;
    wrong.rate_Hz = rate_Hz;
    EXPECT_EQ(Bridge::create(wrong).error().parameter, "rate_Hz");
  }
}

}  // namespace
}  // namespace tactus::ros2
