// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/live/run_view.hpp>
#include <tactus/interfaces/live/server.hpp>

#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <tests/live/raw_client.hpp>

namespace tactus::live {
namespace run_view_test {

using About = std::map<std::string, std::string>;

struct Tick {
  std::int64_t number = 0;
  double force_N = 0.0;
  static constexpr auto signals() {
    return List{observed("number", &Tick::number, units::none, "", "", "", "Which."),
                observed("force_N", &Tick::force_N, units::newton, "master", "hand", "", "Displayed.")};
  }
};

struct Shown {
  std::size_t topic;
  std::uint64_t time_ns;
  std::string bytes;
};

std::vector<Shown> collected(RunView& view, const std::function<bool(std::size_t)>& is_wanted) {
  std::vector<Shown> all;
  view.collect(is_wanted, [&all](std::size_t topic, std::uint64_t time_ns, const Payload& payload) {
    all.push_back({topic, time_ns, *payload});
  });
  return all;
}

TEST(RunView, ShowsEveryRecordAsItsLogHasItToWhoWantsIt) {
  telemetry::RecordStream<Tick> left, right;
  RunView view(About{{"tactus.experiment", "taps"}});
  view.add("/left", "tactus_msgs/msg/Tick", left);
  view.add("/right", "tactus_msgs/msg/Tick", right);
  ASSERT_EQ(view.topics().size(), 2U);
  EXPECT_EQ(view.topics()[1].name, "/right");
  EXPECT_NE(view.topics()[0].definition.find("float64 force_n"), std::string::npos) << view.topics()[0].definition;
  for (std::int64_t k = 0; k < 3; ++k) {
    left.push(static_cast<std::uint64_t>(100 + k), {.number = k, .force_N = 0.1 * static_cast<double>(k)});
    right.push(static_cast<std::uint64_t>(200 + k), {});
  }
  const auto shown = collected(view, [](std::size_t topic) { return topic == 0; });
  ASSERT_EQ(shown.size(), 3U);
  const auto expected = telemetry::to_cdr(Tick{.number = 2, .force_N = 0.1 * 2.0});
  EXPECT_EQ(shown[2].bytes, std::string(expected.begin(), expected.end()));
  EXPECT_EQ(shown[2].time_ns, 102U);
  // Who comes later sees what is new.
  EXPECT_TRUE(collected(view, [](std::size_t) { return true; }).empty());
  right.push(300, {});
  EXPECT_EQ(collected(view, [](std::size_t) { return true; }).size(), 1U);
}

TEST(RunView, CountsWhatWasOverwrittenBeforeAnybodyLooked) {
  telemetry::RecordStream<Tick, 8> stream;
  RunView view(About{});
  view.add("/tick", "tactus_msgs/msg/Tick", stream);
  for (std::int64_t k = 0; k < 20; ++k) stream.push(0, {.number = k});
  EXPECT_EQ(collected(view, [](std::size_t) { return true; }).size(), 8U);
  EXPECT_EQ(view.lost_records(), 12U);
}

TEST(RunView, AViewerChangesAndCommandsNothing) {
  telemetry::RecordStream<Tick> stream;
  RunView view(About{});
  view.add("/tick", "tactus_msgs/msg/Tick", stream);
  ServerOptions options{.port = 0, .conversation = {}};
  const auto server = Server::start(options, {}, view).value();
  RawClient client(server.port());
  ASSERT_TRUE(client.open(server.port()));
  ASSERT_TRUE(client.text_with("\"/tick\""));
  client.say(R"({"op":"setParameters","parameters":[{"name":"force_gain","value":9.0}]})");
  EXPECT_TRUE(client.text_with("no parameters to set"));
  client.say(R"({"op":"advertise","channels":[{"id":1,"topic":"/operator/hand","encoding":"json","schemaName":""}]})");
  client.say_binary(std::string("\x01\x01\x00\x00\x00", 5) + R"({"position_m": 0.01, "engaged": true})");
  EXPECT_TRUE(client.text_with("nobody listens"));
}

TEST(RunView, WhereTheOperatorAllowsItAViewerAsksAndIsAnswered) {
  telemetry::RecordStream<Tick> stream;
  std::vector<std::string> asked;
  double gain = 0.5;
  RunView view(About{}, RunRequests{.ask = [&](const std::string& line) -> Check {
                                      asked.push_back(line);
                                      if (line != "set force_gain 1.2345678901") return std::nullopt;
                                      return Error{.code = ErrorCode::out_of_bounds,
                                                   .parameter = "force_gain",
                                                   .message = "1.23 is refused: it may be 0 to 0.5",
                                                   .place = {}};
                                    },
                                    .force_gain = [&] { return std::optional(gain); }});
  view.add("/tick", "tactus_msgs/msg/Tick", stream);
  ServerOptions options{.port = 0, .conversation = {}};
  const auto server = Server::start(options, {}, view).value();
  RawClient client(server.port());
  ASSERT_TRUE(client.open(server.port()));
  ASSERT_TRUE(client.text_with("\"/tick\""));
  client.say(R"({"op":"setParameters","parameters":[{"name":"force_gain","value":1.2345678901}]})");
  EXPECT_TRUE(client.text_with("0 to 0.5"));
  EXPECT_TRUE(client.text_with("parameterValues"));
  client.say(R"({"op":"setParameters","parameters":[{"name":"damping","value":2.0}]})");
  EXPECT_TRUE(client.text_with("one parameter to set"));
  client.say(R"({"op":"advertise","channels":[{"id":1,"topic":"/request","encoding":"json","schemaName":""}]})");
  client.say_binary(std::string("\x01\x01\x00\x00\x00", 5) + R"({"data": "tare"})");
  EXPECT_TRUE(client.text_with("tare: asked for"));
  for (const char* nonsense : {"tare", "[1]", R"({"data": 2})", "{}", ""}) {
    client.say_binary(std::string("\x01\x01\x00\x00\x00", 5) + nonsense);
    EXPECT_TRUE(client.text_with("a request is JSON")) << nonsense;
  }
  EXPECT_EQ(asked, (std::vector<std::string>{"set force_gain 1.2345678901", "tare"}));
}

}  // namespace run_view_test
}  // namespace tactus::live
