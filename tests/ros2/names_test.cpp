// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/ros2/names.hpp>

#include <string>

#include <gtest/gtest.h>

namespace tactus::ros2 {
namespace {

TEST(Names, ATopicIsMangledAsRos2DoesIt) {
  EXPECT_EQ(dds_topic("tactus", "master/measured_js"), "rt/tactus/master/measured_js");
  EXPECT_EQ(dds_topic("lab/left", "state"), "rt/lab/left/state");
}

TEST(Names, ANamespaceOfRos2IsTakenAndAnythingElseRefused) {
  for (const char* good : {"tactus", "lab/left", "_hidden", "a1/b_2", "A"}) EXPECT_FALSE(check_namespace(good)) << good;
  const std::string longest(128, 'a');
  EXPECT_FALSE(check_namespace(longest));
  for (const std::string& bad :
       {std::string(), std::string("/tactus"), std::string("tactus/"), std::string("a//b"), std::string("1st"),
        std::string("a/2nd"), std::string("a__b"), std::string("a b"), std::string("a-b"), std::string("~"),
        std::string("t\xc3\xa4"), std::string("a\0b", 3), longest + "a"}) {
    const auto error = check_namespace(bad);
    ASSERT_TRUE(error) << bad;
    EXPECT_EQ(error->code, ErrorCode::syntax);
    EXPECT_LT(error->message.size(), 300U);
  }
}

TEST(Names, TheDomainIsThatOfTheEnvironment) {
  EXPECT_EQ(network_of({}).value().domain, 0U);
  EXPECT_EQ(network_of({.domain_id = ""}).value().domain, 0U);
  EXPECT_EQ(network_of({.domain_id = "42"}).value().domain, 42U);
  EXPECT_EQ(network_of({.domain_id = "232"}).value().domain, 232U);
  for (const char* bad :
       {"233", "-1", "4294967296", "99999999999999999999", "1.5", "forty", " 1", "1 ", "0x10", "+1"}) {
    const auto network = network_of({.domain_id = bad});
    ASSERT_FALSE(network) << bad;
    EXPECT_EQ(network.error().place, "ROS_DOMAIN_ID");
    EXPECT_NE(network.error().message.find("0 to 232"), std::string::npos) << network.error().message;
  }
}

TEST(Names, EitherVariableOfRos2KeepsToThisMachine) {
  EXPECT_FALSE(network_of({}).value().loopback_only);
  EXPECT_FALSE(network_of({.localhost_only = "0", .discovery_range = "SUBNET"}).value().loopback_only);
  EXPECT_TRUE(network_of({.localhost_only = "1"}).value().loopback_only);
  EXPECT_TRUE(network_of({.discovery_range = "LOCALHOST"}).value().loopback_only);
  EXPECT_TRUE(network_of({.localhost_only = "1", .discovery_range = "SUBNET"}).value().loopback_only);
  EXPECT_EQ(network_of({.localhost_only = "yes"}).error().place, "ROS_LOCALHOST_ONLY");
  EXPECT_EQ(network_of({.discovery_range = "OFF"}).error().place, "ROS_AUTOMATIC_DISCOVERY_RANGE");
}

}  // namespace
}  // namespace tactus::ros2
