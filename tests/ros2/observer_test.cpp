// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/station/joined_devices.hpp>
#include <tactus/runtime/ros2/observer.hpp>

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "tests/ros2/fast_dds_peer.hpp"
#include "tests/ros2/test_network.hpp"
#include <examples/own-device/spring_carriage.hpp>
#include <gtest/gtest.h>

namespace tactus::ros2 {
namespace observer_test {

using control::SiteRole;
using control::SiteState;
using runtime::SiteLogRecord;
using runtime::SiteStreams;
using test::eventually;
using test::FastDdsPeer;

constexpr const char* joint_state_type = "sensor_msgs::msg::dds_::JointState_";
constexpr const char* wrench_type = "geometry_msgs::msg::dds_::WrenchStamped_";
constexpr const char* text_type = "std_msgs::msg::dds_::String_";

SiteLogRecord record_of(SiteState state, double position_m) {
  SiteLogRecord record;
  record.state = static_cast<std::int64_t>(state);
  record.position_m = position_m;
  record.read_force_N = 0.5;
  record.motor_force_N = -0.25;
  record.Sent::position_m = 0.75;
  return record;
}

/// An observer of record streams and a program of another vendor.
class ObserverTest : public ::testing::Test {
 protected:
  std::string topic(const char* name) const { return dds_topic(test::private_namespace(), name); }
  Bridge::Params params() const {
    return {.network = test::private_network(), .name_space = test::private_namespace()};
  }
  template <class Streams>
  void start(const Streams& streams, const Bridge::Params& of) {
    auto made = Observer::create(of);
    ASSERT_TRUE(made) << describe(made.error());
    observer = *std::move(made);
    observer->watch(streams);
    ASSERT_FALSE(observer->start());
  }
  /// Each topic is found in its own time, and what was told before is not told again.
  bool heard(const char* name) { return !peer.received(topic(name)).empty(); }
  bool told(const char* name, const char* state) {
    const auto all = peer.received(topic(name));
    return !all.empty() && test::text_of(all.back()).data == state;
  }

  FastDdsPeer peer{test::private_network().domain};
  std::unique_ptr<Observer> observer;
};

TEST_F(ObserverTest, OneSiteTellsOfItsOwnDeviceAndTakesNothing) {
  const SiteStreams streams = SiteStreams::of_one(SiteRole::slave);
  Bridge::Params of = params();
  of.master = false;
  start(streams, of);
  peer.subscribe(topic("slave/measured_js"), joint_state_type);
  peer.subscribe(topic("slave/measured_cf"), wrench_type);
  peer.subscribe(topic("slave/state"), text_type);
  std::uint64_t time_ns = 0;
  const auto shows = [&](SiteState state, const char* word) {
    return eventually([&] {
      streams.of(SiteRole::slave)->push(time_ns += 2'000'000, record_of(state, 0.1));
      return told("slave/state", word) && heard("slave/measured_js") && heard("slave/measured_cf");
    });
  };
  ASSERT_TRUE(shows(SiteState::configure, "DISABLED"));
  ASSERT_TRUE(shows(SiteState::armed, "PAUSED"));
  ASSERT_TRUE(shows(SiteState::active, "ENABLED"));
  ASSERT_TRUE(shows(SiteState::fault, "FAULT"));
  EXPECT_EQ(test::joint_state_of(peer.received(topic("slave/measured_js")).back()).position, std::vector{0.1});
  EXPECT_EQ(test::wrench_of(peer.received(topic("slave/measured_cf")).back()).force_N[0], -0.5);
  for (const auto& [name, announcement] : peer.announced()) {
    EXPECT_NE(name.find("slave/"), std::string::npos) << name;
    EXPECT_TRUE(announcement.writes) << name;
  }
  const auto counts = observer->finish();
  EXPECT_GT(counts.published, 0U);
  EXPECT_TRUE(eventually([&] { return told("slave/state", "DISABLED"); }));
}

TEST_F(ObserverTest, BothSitesAreToldFromOneTickOfEach) {
  const SiteStreams streams = SiteStreams::of_both();
  start(streams, params());
  peer.subscribe(topic("master/measured_js"), joint_state_type);
  peer.subscribe(topic("slave/setpoint_js"), joint_state_type);
  peer.subscribe(topic("state"), text_type);
  std::uint64_t time_ns = 0;
  const auto shows = [&](SiteState at_slave, const char* word) {
    return eventually([&] {
      time_ns += 2'000'000;
      streams.of(SiteRole::master)->push(time_ns, record_of(SiteState::active, 0.1));
      streams.of(SiteRole::slave)->push(time_ns, record_of(at_slave, 0.2));
      return told("state", word) && heard("master/measured_js") && heard("slave/setpoint_js");
    });
  };
  ASSERT_TRUE(shows(SiteState::active, "ENABLED"));
  ASSERT_TRUE(shows(SiteState::hold, "PAUSED"));
  ASSERT_TRUE(shows(SiteState::fault, "FAULT"));
  EXPECT_EQ(test::joint_state_of(peer.received(topic("master/measured_js")).back()).position, std::vector{0.1});
  EXPECT_EQ(test::joint_state_of(peer.received(topic("slave/setpoint_js")).back()).position, std::vector{0.75})
      << "as it left the master";
  EXPECT_EQ(observer->finish().dropped, 0U);
}

/// Two carriages as one device.
std::unique_ptr<station::JoinedDevices> carriages(SiteRole role) {
  std::vector<std::unique_ptr<station::Device>> owned;
  for (int joint = 0; joint < 2; ++joint) {
    owned.push_back(std::make_unique<SpringCarriage>(role == SiteRole::master, 1e-3));
  }
  return station::JoinedDevices::make(std::move(owned)).value();
}

TEST_F(ObserverTest, AllJointsAreToldInOneMessageFromOneTick) {
  const auto leader = carriages(SiteRole::master), follower = carriages(SiteRole::slave);
  auto sites = station::JointLocalTeleoperator::make(Joints<control::ControlParams>(2), {}, Seconds{1e-3},
                                                     Joints<double>(2, 0.0), *leader, *follower);
  ASSERT_TRUE(sites) << describe(sites.error());
  runtime::JointStreams streams(2);
  Bridge::Params of = params();
  of.joints = {"shoulder", "elbow"};
  start(streams, of);
  constexpr std::array topics{"master/measured_js", "master/setpoint_js", "slave/measured_js", "slave/setpoint_js"};
  for (const char* name : topics) peer.subscribe(topic(name), joint_state_type);
  peer.subscribe(topic("state"), text_type);
  station::Tick tick;
  const auto step = [&] {
    ++tick.number;
    tick.deadline_ns += 1'000'000;
    auto done = sites->step(tick, {});
    // Numbers that tell tick, joint and signal apart.
    for (std::size_t joint = 0; joint < 2; ++joint) {
      const double number = static_cast<double>(tick.number) + 0.5 * static_cast<double>(joint);
      done.master.reading[joint] = {.position_m = number, .force_N = 2.0 * number};
      done.master.output.site[joint].motor_force_N = 3.0 * number;
      done.master.output.packet.message[joint].position_m = 4.0 * number;
      done.slave.reading[joint] = {.position_m = 5.0 * number, .force_N = 6.0 * number};
    }
    streams.push(tick, {}, *sites, done);
  };
  ASSERT_TRUE(eventually([&] {
    step();
    return std::ranges::all_of(topics, [&](const char* name) { return !peer.received(topic(name)).empty(); }) &&
           told("state", "DISABLED");
  }));
  using Numbers = std::vector<double>;
  const auto is_of_one_tick = [](const Numbers& numbers, double factor) {
    return numbers.size() == 2 && numbers[1] - numbers[0] == 0.5 * factor;
  };
  const auto last = [&](const char* name) { return test::joint_state_of(peer.received(topic(name)).back()); };
  for (const char* name : topics) EXPECT_EQ(last(name).name, (std::vector<std::string>{"shoulder", "elbow"}));
  EXPECT_EQ(last("slave/measured_js").frame_id, "slave");
  EXPECT_TRUE(is_of_one_tick(last("master/measured_js").position, 1.0));
  EXPECT_TRUE(is_of_one_tick(last("master/measured_js").effort, 2.0));
  EXPECT_TRUE(is_of_one_tick(last("master/setpoint_js").effort, 3.0));
  EXPECT_TRUE(is_of_one_tick(last("slave/setpoint_js").position, 4.0));
  EXPECT_TRUE(is_of_one_tick(last("slave/measured_js").position, 5.0));
  EXPECT_TRUE(is_of_one_tick(last("slave/measured_js").effort, -6.0));
  for (const auto& [name, announcement] : peer.announced()) EXPECT_EQ(name.find("measured_cf"), std::string::npos);
}

}  // namespace observer_test
}  // namespace tactus::ros2
