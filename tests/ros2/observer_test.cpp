#include <tactus/ros2/observer.hpp>

#include "tests/ros2/fast_dds_peer.hpp"
#include "tests/ros2/test_network.hpp"
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
  record.Told::position_m = 0.75;
  return record;
}

/// An observer of record streams and a program of another vendor.
class ObserverTest : public ::testing::Test {
 protected:
  std::string topic(const char* name) const { return dds_topic(test::private_namespace(), name); }
  Bridge::Params params() const {
    return {.network = test::private_network(), .name_space = test::private_namespace()};
  }
  void start(const SiteStreams& streams, const Bridge::Params& of) {
    auto made = Observer::create(of);
    ASSERT_TRUE(made) << describe(made.error());
    observer = *std::move(made);
    observer->watch(streams);
    ASSERT_FALSE(observer->start());
  }
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
      return told("slave/state", word);
    });
  };
  EXPECT_TRUE(shows(SiteState::configure, "DISABLED"));
  EXPECT_TRUE(shows(SiteState::armed, "PAUSED"));
  EXPECT_TRUE(shows(SiteState::active, "ENABLED"));
  EXPECT_TRUE(shows(SiteState::fault, "FAULT"));
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
      return told("state", word);
    });
  };
  EXPECT_TRUE(shows(SiteState::active, "ENABLED"));
  EXPECT_TRUE(shows(SiteState::hold, "PAUSED"));
  EXPECT_TRUE(shows(SiteState::fault, "FAULT"));
  EXPECT_EQ(test::joint_state_of(peer.received(topic("master/measured_js")).back()).position, std::vector{0.1});
  EXPECT_EQ(test::joint_state_of(peer.received(topic("slave/setpoint_js")).back()).position, std::vector{0.75})
      << "as it left the master";
  EXPECT_EQ(observer->finish().dropped, 0U);
}

}  // namespace observer_test
}  // namespace tactus::ros2
