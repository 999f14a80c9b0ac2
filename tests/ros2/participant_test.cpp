// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/ros2/participant.hpp>

#include <numbers>
#include <optional>

#include "tests/ros2/fast_dds_peer.hpp"
#include "tests/ros2/test_network.hpp"
#include <gtest/gtest.h>

namespace tactus::ros2 {
namespace {

using test::eventually;

/// Sends until something has come: what a volatile writer sends before it is matched is gone.
template <class Message>
std::optional<Message> through(Participant& participant, const char* topic, const Message& message) {
  const std::string name = dds_topic(test::private_namespace(), topic);
  auto writer = participant.writer<Message>(name).value();
  auto reader = participant.reader<Message>(name).value();
  if (!eventually([&] { return writer.readers() == 1 && reader.writers() == 1; })) return std::nullopt;
  if (const auto error = writer.write(message)) return std::nullopt;
  reader.wait(Seconds{5.0});
  const std::vector<Message> messages = reader.take();
  return messages.size() == 1 ? std::optional(messages.front()) : std::nullopt;
}

TEST(Participant, EveryTypeOfMessageArrivesAsItWasSent) {
  Participant participant = Participant::create(test::private_network()).value();
  const JointState joints{.stamp_ns = 1'700'000'000'987'654'321,
                          .frame_id = "master",
                          .name = {"first", "second"},
                          .position = {0.001, -std::numbers::pi},
                          .velocity = {},
                          .effort = {1e-300, 0.0}};
  EXPECT_EQ(through(participant, "joints", joints), joints);
  const WrenchStamped wrench{
      .stamp_ns = 1, .frame_id = "", .force_N = {1.0, 2.0, 3.0}, .torque_Nm = {-1.0, -2.0, -3.0}};
  EXPECT_EQ(through(participant, "wrench", wrench), wrench);
  const Text text{.data = "ENABLED"};
  EXPECT_EQ(through(participant, "text", text), text);
}

TEST(Participant, TheLastTenMessagesAreKept) {
  Participant participant = Participant::create(test::private_network()).value();
  const std::string topic = dds_topic(test::private_namespace(), "text");
  auto writer = participant.writer<Text>(topic).value();
  auto reader = participant.reader<Text>(topic).value();
  ASSERT_TRUE(eventually([&] { return writer.readers() == 1; }));
  for (int i = 0; i < 25; ++i) ASSERT_FALSE(writer.write({std::to_string(i)}));
  const std::vector<Text> messages = reader.take();
  ASSERT_EQ(messages.size(), 10U);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(messages[i].data, std::to_string(15 + i));
  EXPECT_TRUE(reader.take().empty());
}

TEST(Participant, ADomainIsJoinedOnceAndCanBeJoinedAgain) {
  {
    const auto first = Participant::create(test::private_network());
    ASSERT_TRUE(first) << describe(first.error());
    const auto second = Participant::create(test::private_network());
    ASSERT_FALSE(second);
    EXPECT_NE(describe(second.error()).find("takes part in it already"), std::string::npos);
  }
  EXPECT_TRUE(Participant::create(test::private_network()));
}

TEST(Participant, AConfigurationThatDoesNotWorkIsAnErrorThatSaysSo) {
  Network network = test::private_network();
  network.loopback_only = false;
  network.configuration = "<General><Interfaces><NetworkInterface name='nowhere0'/></></>";
  const auto participant = Participant::create(network);
  ASSERT_FALSE(participant);
  EXPECT_EQ(participant.error().code, ErrorCode::failed);
  EXPECT_NE(participant.error().message.find("nowhere0"), std::string::npos) << participant.error().message;
  EXPECT_NE(participant.error().message.find("CYCLONEDDS_URI"), std::string::npos);
}

TEST(Participant, ATopicThatDdsDoesNotTakeIsAnError) {
  Participant participant = Participant::create(test::private_network()).value();
  const auto writer = participant.writer<Text>("no topic: at all*");
  ASSERT_FALSE(writer);
  EXPECT_NE(writer.error().message.find("no topic"), std::string::npos);
}

}  // namespace
}  // namespace tactus::ros2
