// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/live/conversation.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <string>
#include <vector>

#include "raw_client.hpp"
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace tactus::live {
namespace {

using Json = nlohmann::json;

/// Two topics and one parameter between 0 and 10.
class Example final : public Application {
 public:
  [[nodiscard]] const std::vector<Topic>& topics() const override { return topics_; }
  [[nodiscard]] std::map<std::string, std::string> metadata() const override { return {{"key", "text"}}; }
  [[nodiscard]] std::vector<Parameter> parameters() const override { return {{"gain", gain}, {"on", true}}; }
  std::vector<Status> set_parameters(const std::vector<Parameter>& wanted) override {
    std::vector<Status> refused;
    for (const Parameter& parameter : wanted) {
      const auto* value = std::get_if<double>(&parameter.value);
      if (parameter.name != "gain" || value == nullptr || *value < 0.0 || *value > 10.0) {
        refused.push_back({StatusLevel::error, parameter.name + " must lie between 0 and 10"});
      } else {
        gain = *value;
      }
    }
    return refused;
  }
  std::optional<Status> receive(ClientId, std::string_view topic, std::string_view, std::string_view bytes) override {
    received.push_back(std::string(topic) + ":" + std::string(bytes));
    return std::nullopt;
  }
  void leave(ClientId) override {}
  void stand_alone() override {}
  void collect(const std::function<bool(std::size_t)>&, const Publish&) override {}

  double gain = 1.0;
  std::vector<std::string> received;

 private:
  std::vector<Topic> topics_{{"/a", "pkg/msg/A", "float64 a\n"}, {"/b", "pkg/msg/B", "float64 b\n"}};
};

/// Takes every frame that waits.
std::vector<Frame> frames(Conversation& conversation) {
  std::vector<Frame> all;
  Outbox& outbox = conversation.outbox();
  while (!outbox.empty()) {
    all.push_back(outbox.begin_sending());
    outbox.sent();
  }
  return all;
}
std::vector<Json> texts(Conversation& conversation) {
  std::vector<Json> all;
  for (const Frame& frame : frames(conversation)) all.push_back(Json::parse(frame.head));
  return all;
}
Payload bytes(const char* text) { return std::make_shared<const std::string>(text); }

TEST(Conversation, BeginsWithTheServerAndItsTopics) {
  Example example;
  Conversation conversation(1, example, {});
  const auto said = texts(conversation);
  ASSERT_EQ(said.size(), 2U);
  EXPECT_EQ(said[0]["op"], "serverInfo");
  EXPECT_EQ(said[0]["capabilities"], Json::parse(R"(["parameters", "parametersSubscribe", "clientPublish"])"));
  EXPECT_EQ(said[0]["supportedEncodings"], Json::parse(R"(["cdr", "json"])"));
  EXPECT_EQ(said[0]["metadata"]["key"], "text");
  EXPECT_EQ(said[1], Json::parse(R"({"op": "advertise", "channels": [
    {"id": 1, "topic": "/a", "encoding": "cdr", "schemaName": "pkg/msg/A", "schema": "float64 a\n",
     "schemaEncoding": "ros2msg"},
    {"id": 2, "topic": "/b", "encoding": "cdr", "schemaName": "pkg/msg/B", "schema": "float64 b\n",
     "schemaEncoding": "ros2msg"}]})"));
}

TEST(Conversation, ASubscriptionGetsItsTopicUntilItEnds) {
  Example example;
  Conversation conversation(1, example, {});
  frames(conversation);
  EXPECT_FALSE(conversation.take_text(R"({"op":"subscribe","subscriptions":[{"id":258,"channelId":2}]})"));
  EXPECT_TRUE(conversation.wants(1));
  EXPECT_FALSE(conversation.wants(0));
  conversation.show(0, 7, bytes("no"));
  conversation.show(1, 0x0102030405060708, bytes("yes"));
  const auto sent = frames(conversation);
  ASSERT_EQ(sent.size(), 1U);
  // Opcode 1, subscription and time as the specification of the protocol writes them.
  EXPECT_EQ(sent[0].head, std::string("\x01\x02\x01\x00\x00\x08\x07\x06\x05\x04\x03\x02\x01", 13));
  EXPECT_EQ(*sent[0].payload, "yes");
  EXPECT_FALSE(conversation.take_text(R"({"op":"unsubscribe","subscriptionIds":[258]})"));
  EXPECT_FALSE(conversation.wants(1));
}

TEST(Conversation, ParametersAreReadSetWithinBoundsAndWatched) {
  Example example;
  Conversation conversation(1, example, {});
  frames(conversation);
  EXPECT_FALSE(conversation.take_text(R"({"op":"getParameters","parameterNames":["gain"],"id":"x"})"));
  auto said = texts(conversation);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0]["id"], "x");
  EXPECT_EQ(said[0]["parameters"], Json::parse(R"([{"name":"gain","value":1.0,"type":"float64"}])"));

  EXPECT_TRUE(conversation.take_text(R"({"op":"setParameters","parameters":[{"name":"gain","value":99}],"id":"y"})"));
  said = texts(conversation);
  ASSERT_EQ(said.size(), 2U);
  EXPECT_EQ(said[0]["op"], "status");
  EXPECT_EQ(said[0]["level"], 2);
  EXPECT_EQ(said[1]["parameters"][0]["value"], 1.0) << "the old value must be told";

  EXPECT_FALSE(conversation.take_text(R"({"op":"subscribeParameterUpdates","parameterNames":["gain"]})"));
  EXPECT_TRUE(conversation.take_text(R"({"op":"setParameters","parameters":[{"name":"gain","value":3}]})"));
  frames(conversation);
  conversation.tell_parameters(example.parameters());
  said = texts(conversation);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0]["parameters"], Json::parse(R"([{"name":"gain","value":3.0,"type":"float64"}])"));
  EXPECT_FALSE(conversation.take_text(R"({"op":"unsubscribeParameterUpdates","parameterNames":["gain"]})"));
  conversation.tell_parameters(example.parameters());
  EXPECT_TRUE(frames(conversation).empty());
}

TEST(Conversation, AClientPublishesOnWhatItAdvertised) {
  Example example;
  Conversation conversation(1, example, {});
  conversation.take_binary(std::string("\x01\x05\x00\x00\x00{}", 7));
  EXPECT_TRUE(example.received.empty());
  EXPECT_FALSE(conversation.take_text(
      R"({"op":"advertise","channels":[{"id":5,"topic":"/hand","encoding":"json","schemaName":""}]})"));
  conversation.take_binary(std::string("\x01\x05\x00\x00\x00{}", 7));
  EXPECT_EQ(example.received, std::vector<std::string>{"/hand:{}"});
  EXPECT_FALSE(conversation.take_text(R"({"op":"unadvertise","channelIds":[5]})"));
  conversation.take_binary(std::string("\x01\x05\x00\x00\x00{}", 7));
  EXPECT_EQ(example.received.size(), 1U);
}

TEST(Conversation, ASlowClientLosesTheOldestSamplesAndIsToldHowMany) {
  Example example;
  Conversation conversation(1, example, {.outbox = {.frames = 10, .bytes = 100000}});
  frames(conversation);
  EXPECT_FALSE(conversation.take_text(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1}]})"));
  for (char c = 'a'; c <= 'z'; ++c) conversation.show(0, 0, std::make_shared<const std::string>(1, c));
  EXPECT_EQ(conversation.outbox().dropped(), 16U);
  conversation.tell_losses();
  const auto sent = frames(conversation);
  ASSERT_EQ(sent.size(), 10U);
  EXPECT_EQ(*sent[0].payload, "r") << "one more went to make room for the status";
  EXPECT_EQ(*sent[8].payload, "z");
  EXPECT_NE(sent[9].head.find("16 messages"), std::string::npos);
  EXPECT_FALSE(conversation.is_hopeless());
}

TEST(Conversation, AFrameThatIsBeingSentIsNeverTheOneToGo) {
  Outbox outbox({.frames = 2, .bytes = 100});
  const auto frame = [](const char* text) { return Frame{.may_be_dropped = true, .head = text}; };
  ASSERT_TRUE(outbox.push(frame("1")));
  EXPECT_EQ(outbox.begin_sending().head, "1");
  for (const char* text : {"2", "3", "4"}) ASSERT_TRUE(outbox.push(frame(text)));
  outbox.sent();
  EXPECT_EQ(outbox.begin_sending().head, "4");
  EXPECT_EQ(outbox.dropped(), 2U);
  EXPECT_EQ(outbox.bytes(), 1U);
}

TEST(Conversation, BytesThatAreBeingSentStayWhereTheyAreWhileOthersAreDropped) {
  Outbox outbox({.frames = 40, .bytes = 10000});
  const auto push = [&outbox](int i) { return outbox.push({.may_be_dropped = true, .head = std::to_string(i)}); };
  for (int i = 0; i < 40; ++i) ASSERT_TRUE(push(i));
  const Frame& frame = outbox.begin_sending();
  const char* const bytes = frame.head.data();  // short enough to lie inside the string: a socket reads them here
  for (int i = 40; i < 200; ++i) {
    ASSERT_TRUE(push(i));
    ASSERT_EQ(frame.head, "0") << "after " << i;
    ASSERT_EQ(static_cast<const void*>(frame.head.data()), bytes);
  }
  outbox.sent();
  EXPECT_EQ(outbox.dropped(), 160U);
  EXPECT_EQ(outbox.begin_sending().head, "161");
}

TEST(Conversation, WhoAsksAndNeverReadsIsGivenUpAndNotGrownInto) {
  Example example;
  Conversation conversation(1, example, {.outbox = {.frames = 50, .bytes = 100000}});
  for (int i = 0; i < 1000; ++i) EXPECT_FALSE(conversation.take_text(R"({"op":"getParameters","parameterNames":[]})"));
  EXPECT_TRUE(conversation.is_hopeless());
}

TEST(Conversation, LimitsHoldForSubscriptionsAdvertisementsAndNames) {
  Example example;
  Conversation conversation(1, example, {.subscriptions = 3, .advertisements = 3, .names = 3, .outbox = {}});
  frames(conversation);
  for (int i = 0; i < 5; ++i) {
    const std::string id = std::to_string(i);
    EXPECT_FALSE(conversation.take_text(R"({"op":"subscribe","subscriptions":[{"id":)" + id + R"(,"channelId":1}]})"));
    EXPECT_FALSE(conversation.take_text(R"({"op":"advertise","channels":[{"id":)" + id +
                                        R"(,"topic":"/x","encoding":"json"}]})"));
  }
  EXPECT_EQ(texts(conversation).size(), 4U) << "two of each are refused";
  conversation.show(0, 0, bytes("x"));
  EXPECT_EQ(frames(conversation).size(), 3U);
}

TEST(Conversation, ATurnHasRoomForItsShareAndWhatIsBeyondIsLostAndCounted) {
  Example example;
  Conversation conversation(1, example, {});
  frames(conversation);
  EXPECT_FALSE(conversation.take_text(
      R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1},{"id":2,"channelId":1},{"id":3,"channelId":1}]})"));
  conversation.begin_turn(4 * (Conversation::frame_cost + 6));
  for (int i = 0; i < 10; ++i) conversation.show(0, 0, bytes("sample"));
  EXPECT_EQ(frames(conversation).size(), 4U);
  EXPECT_EQ(conversation.outbox().dropped(), 26U);
  conversation.begin_turn(4 * (Conversation::frame_cost + 6));
  conversation.show(0, 0, bytes("sample"));
  EXPECT_EQ(frames(conversation).size(), 3U) << "the next turn has room again";
}

TEST(Conversation, ASubscriptionBeyondTheLimitIsRefusedWithItsNumberAndWhatToDo) {
  Example example;
  Conversation conversation(1, example, {});
  frames(conversation);
  EXPECT_FALSE(conversation.take_text(subscribe_often("1", 256)));
  const auto said = texts(conversation);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0]["op"], "status");
  EXPECT_EQ(said[0]["level"], 2);
  const std::string message = said[0]["message"];
  EXPECT_NE(message.find("subscription 33"), std::string::npos) << message;
  EXPECT_NE(message.find("no more than 32"), std::string::npos) << message;
  conversation.show(0, 0, bytes("x"));
  EXPECT_EQ(frames(conversation).size(), 32U);
}

TEST(Conversation, AnswersThatNobodyReadsAreFewWhateverElseWaits) {
  Outbox outbox({.frames = 1000, .bytes = 100000, .answers = 3});
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(outbox.push({.head = "answer"}));
  for (int i = 0; i < 2000; ++i) ASSERT_TRUE(outbox.push({.may_be_dropped = true, .head = "sample"}));
  EXPECT_FALSE(outbox.push({.head = "answer"}));
  (void)outbox.begin_sending();
  outbox.sent();
  EXPECT_TRUE(outbox.push({.head = "answer"})) << "one was read";
}

/// Requests as a client would write them, cut, doubled, and with bytes changed: nothing but answers and statuses may
/// come of it.
TEST(Conversation, SurvivesAnyInput) {
  const std::vector<std::string> seeds{
      R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1},{"id":2,"channelId":2}]})",
      R"({"op":"unsubscribe","subscriptionIds":[1,2,3]})",
      R"({"op":"advertise","channels":[{"id":5,"topic":"/hand","encoding":"json","schemaName":""}]})",
      R"({"op":"unadvertise","channelIds":[5]})",
      R"({"op":"getParameters","parameterNames":["gain"],"id":"x"})",
      R"({"op":"setParameters","parameters":[{"name":"gain","value":99},{"name":"on","value":[1,2]}]})",
      R"({"op":"subscribeParameterUpdates","parameterNames":["gain",7]})",
      R"({"op":7})",
      "[1e999]",
      std::string(60000, '['),
      R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":4294967296},{"id":1.5},7,null]})"};
  signal::Random random(20261121);
  const auto below = [&random](std::size_t end) { return static_cast<std::size_t>(random.bits() % end); };
  Example example;
  std::size_t answered = 0;
  for (int round = 0; round < 40; ++round) {
    Conversation conversation(1, example, {});
    for (int i = 0; i < 100; ++i) {
      std::string text = seeds[below(seeds.size())];
      for (std::size_t changes = below(6); changes > 0; --changes) {
        const std::size_t at = below(text.size());
        switch (below(4)) {
          case 0:
            text[at] = static_cast<char>(below(256));
            break;
          case 1:
            text.erase(at, below(8));
            break;
          case 2:
            text.insert(at, text.substr(at, below(8)));
            break;
          default:
            text.resize(at);
        }
        if (text.empty()) text.assign(1, '{');
      }
      static_cast<void>(conversation.take_text(text));
      conversation.take_binary(text);
      for (const Frame& frame : frames(conversation)) {
        if (!frame.binary) answered += Json::parse(frame.head).contains("op") ? 1U : 0U;
      }
      ASSERT_FALSE(conversation.is_hopeless());
    }
  }
  EXPECT_GT(answered, 4000U) << "every binary message alone was nonsense";
}

}  // namespace
}  // namespace tactus::live
