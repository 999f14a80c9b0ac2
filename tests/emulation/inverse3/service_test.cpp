// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/emulation/inverse3/inverse3_server.hpp>
#include <tactus/hardware/emulation/inverse3/inverse3_service.hpp>

#include <cmath>
#include <cstdint>
#include <string>

#include <boost/asio.hpp>
#include <boost/beast.hpp>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace tactus::emulation::inverse3::service_test {

using nlohmann::json;
constexpr std::int64_t ms = 1'000'000;

const std::string push_new =
    R"({"inverse3":[{"device_id":"049D","commands":{"set_cursor_force":{"vector":{"x":1.0,"y":0.0,"z":-0.5}}}}]})";
const std::string push_old =
    R"({"inverse3":[{"device_id":"049D","commands":{"set_cursor_force":{"values":{"x":1.0,"y":0.0,"z":-0.5}}}}]})";
const std::string probe = R"({"inverse3":[{"device_id":"049D","commands":{"probe_position":{}}}]})";

Inverse3Service service_of(const Inverse3Service::Params& params) { return Inverse3Service::make(params).value(); }
double x_of(const std::string& text) { return json::parse(text)["inverse3"][0]["state"]["cursor_position"]["x"]; }

TEST(Inverse3Service, TheSnapshotHoldsWhatThePageLists) {
  auto service = service_of({.devices = 2});
  const json told = json::parse(service.snapshot(0));
  ASSERT_EQ(told["inverse3"].size(), 2U);
  EXPECT_TRUE(told["session_id"].is_number());
  const json& device = told["inverse3"][0];
  EXPECT_EQ(device["device_id"], "049D");
  EXPECT_EQ(device["config"]["device_info"]["device_type"], "inverse3");
  EXPECT_EQ(device["config"]["handedness"], "right");
  EXPECT_EQ(device["config"]["filters"]["force_gate"]["gain"], 0.3);
  EXPECT_EQ(device["state"]["control_domain"], "idle");
  for (const char* vector : {"cursor_position", "cursor_velocity", "current_cursor_force"}) {
    for (const char* axis : {"x", "y", "z"}) EXPECT_TRUE(device["state"][vector][axis].is_number()) << vector;
  }
  for (const char* axis : {"a0", "a1", "a2"}) EXPECT_TRUE(device["state"]["angular_position"][axis].is_number());
  for (const char* flag : {"calibrated", "in_use", "power_supply", "ready", "started"}) {
    EXPECT_EQ(device["status"][flag], true) << flag;
  }
  // Later ones: state and status only.
  const json later = json::parse(service.answer(probe, ms).text);
  EXPECT_FALSE(later["inverse3"][0].contains("config"));
  EXPECT_TRUE(later["inverse3"][0].contains("state") && later["inverse3"][0].contains("status"));
}

TEST(Inverse3Service, FaultsThatAreInjectedChangeWhatItReportsAndNotWhatItDoes) {
  auto service = service_of({});
  service.answer(push_new, 0);
  for (const char* word : {"mode=impedance@0.01", "calibrated=0@0.01", "power_supply=0@0.01", "ready=0@0.01"}) {
    service.inject(parse_fault(word).value(), 0);
  }
  json told = json::parse(service.answer(push_new, 5 * ms).text)["inverse3"][0];
  EXPECT_EQ(told["state"]["control_mode"], "force");
  EXPECT_EQ(told["status"]["calibrated"], true);
  told = json::parse(service.answer(push_new, 12 * ms).text)["inverse3"][0];
  EXPECT_EQ(told["state"]["control_mode"], "impedance");
  for (const char* flag : {"calibrated", "power_supply", "ready"}) EXPECT_EQ(told["status"][flag], false) << flag;
  EXPECT_TRUE(service.gives_force(0, 12 * ms));
  EXPECT_FALSE(service.gives_force(0, 40 * ms)) << "for want of messages";
  service.inject(parse_fault("mode=").value(), 40 * ms);
  told = json::parse(service.answer(probe, 41 * ms).text)["inverse3"][0];
  EXPECT_FALSE(told["state"].contains("control_mode"));
  service.inject(parse_fault("keeps-force").value(), 41 * ms);
  service.answer(push_new, 42 * ms);
  service.answer(probe, 43 * ms);
  EXPECT_TRUE(service.gives_force(0, 43 * ms));
}

TEST(Inverse3Service, AFaultIsReadFromAWord) {
  const auto mode = parse_fault("mode=a=b@0.5");
  ASSERT_TRUE(mode);
  EXPECT_EQ(mode->mode, "a=b");
  EXPECT_EQ(mode->from_ns, 500 * ms);
  for (const char* wrong :
       {"", "mode", "ready", "ready=", "ready=2", "keeps-force=1", "ready=0@x", "ready=0@-1", "readiness=0"}) {
    const auto refused = parse_fault(wrong);
    ASSERT_FALSE(refused) << wrong;
    EXPECT_NE(refused.error().message.find("KIND[=VALUE][@SECONDS]"), std::string::npos) << wrong;
  }
}

TEST(Inverse3Service, AForceMovesTheMassAsNewtonSays) {
  auto service = service_of({});
  for (int tick = 0; tick < 100; ++tick) service.answer(push_new, tick * ms);
  const json told = json::parse(service.answer(push_new, 100 * ms).text)["inverse3"][0]["state"];
  // 1 N on 0.25 kg with 1 N s/m: v = 1 - exp(-4 t), x = t - (1 - exp(-4 t)) / 4.
  const double v = 1.0 - std::exp(-0.4);
  EXPECT_NEAR(told["cursor_velocity"]["x"].get<double>(), v, 1e-3);
  EXPECT_NEAR(told["cursor_position"]["x"].get<double>(), 0.1 - v / 4.0, 1e-4);
  EXPECT_NEAR(told["cursor_velocity"]["z"].get<double>(), -0.5 * v, 1e-3);
  EXPECT_EQ(told["current_cursor_force"]["x"], 1.0);
  EXPECT_EQ(told["control_mode"], "force");
}

TEST(Inverse3Service, EachDialectTakesTheKeysOfItsTime) {
  const auto force_after = [](Dialect dialect, const std::string& message) {
    auto service = service_of({.dialect = dialect});
    service.answer(message, 0);
    return service.force_N(0)[0];
  };
  EXPECT_EQ(force_after(Dialect::v3_5, push_new), 1.0);
  EXPECT_EQ(force_after(Dialect::v3_5, push_old), 1.0);  // still accepted
  EXPECT_EQ(force_after(Dialect::v3_1, push_old), 1.0);
  EXPECT_EQ(force_after(Dialect::v3_1, push_new), 0.0);
  auto old = service_of({.dialect = Dialect::v3_1});
  const json told = json::parse(old.snapshot(0))["inverse3"][0];
  EXPECT_TRUE(told["config"]["device_info"].contains("model"));
  EXPECT_EQ(told["state"]["mode"], "idle");
  EXPECT_EQ(json::parse(old.http("GET", "/version", "").body)["data"]["version"], "3.1.0");
}

TEST(Inverse3Service, AForceLastsForItsTickAndNoLongerThanTheSilence) {
  auto service = service_of({.silence_ns = 20 * ms});
  service.answer(push_new, 0);
  EXPECT_EQ(service.force_N(0)[0], 1.0);
  service.answer(probe, ms);
  EXPECT_EQ(service.force_N(0)[0], 0.0);
  service.answer(push_new, 2 * ms);
  service.answer("{}", 21 * ms);
  service.answer(push_new, 30 * ms);
  const json late = json::parse(service.answer(probe, 530 * ms).text);
  // Pushed for 20 of these 500 ms, then it coasts and drag stops it.
  EXPECT_EQ(service.force_N(0)[0], 0.0);
  EXPECT_LT(std::abs(late["inverse3"][0]["state"]["cursor_velocity"]["x"].get<double>()), 0.05);
}

TEST(Inverse3Service, AStateIsFreshOnlyWhereSomethingWasAsked) {
  auto service = service_of({});
  service.answer(push_new, 0);
  service.answer(push_new, 10 * ms);
  EXPECT_EQ(x_of(service.answer("{}", 15 * ms).text), x_of(service.answer("{}", 400 * ms).text));
  EXPECT_GT(x_of(service.answer(probe, 400 * ms).text), x_of(service.answer("{}", 400 * ms).text) - 1e-12);
  const double fresh = x_of(service.answer(probe, 401 * ms).text);
  EXPECT_NEAR(fresh, service.position_m(0)[0], 1e-12);
}

TEST(Inverse3Service, WithoutCalibrationThereIsNoForce) {
  auto service = service_of({.calibrated = false});
  EXPECT_EQ(json::parse(service.snapshot(0))["inverse3"][0]["status"]["calibrated"], false);
  service.answer(push_new, 0);
  EXPECT_EQ(service.force_N(0)[0], 0.0);
  service.calibrate();
  service.answer(push_new, ms);
  EXPECT_EQ(service.force_N(0)[0], 1.0);
}

TEST(Inverse3Service, EveryMessageGetsOneStateWhateverItHolds) {
  auto service = service_of({.partial = true});
  for (const char* message :
       {"", "{", "[]", "7", R"({"inverse3":7})", R"({"inverse3":[7,{}]})", R"({"inverse3":[{"device_id":"049D"}]})",
        R"({"inverse3":[{"device_id":"FFFF","commands":{"probe_position":{}}}]})",
        R"({"inverse3":[{"device_id":"049D","commands":{"set_cursor_force":{"vector":{"x":1}}}}]})",
        R"({"inverse3":[{"device_id":"049D","commands":{"set_cursor_force":{"vector":{"x":1e308,"y":0,"z":0}}}}]})"}) {
    const json told = json::parse(service.answer(message, 0).text);
    EXPECT_EQ(told["inverse3"].size(), 1U) << message;
    EXPECT_FALSE(told["inverse3"][0]["state"].contains("body_orientation"));
    EXPECT_LE(std::abs(service.force_N(0)[0]), 10.0);
  }
}

TEST(Inverse3Service, AnswersMayBeLateCutOffOrTheLast) {
  auto service = service_of({.late_ns = 3 * ms, .garbage = 0.5, .closes_after = 40});
  int broken = 0;
  for (int i = 1; i <= 40; ++i) {
    const auto answer = service.answer(probe, i * ms);
    EXPECT_EQ(answer.after_ns, 3 * ms);
    EXPECT_EQ(answer.closes, i == 40);
    broken += json::parse(answer.text, nullptr, false).is_discarded() ? 1 : 0;
  }
  EXPECT_GT(broken, 5);
  EXPECT_LT(broken, 35);
}

TEST(Inverse3Service, HttpAnswersOkOrWhyNot) {
  auto service = service_of({});
  EXPECT_EQ(json::parse(service.http("GET", "/devices", "").body)["data"]["inverse3"][0]["device_id"], "049D");
  const auto set =
      service.http("POST", "/inverse3/049D/config/gravity_compensation?session=:0", R"({"enabled":false})");
  EXPECT_TRUE(set.ok);
  EXPECT_EQ(json::parse(service.snapshot(0))["inverse3"][0]["config"]["gravity_compensation"]["enabled"], false);
  EXPECT_FALSE(service.http("POST", "/inverse3/0/config/gravity_compensation", "{").ok);
  const auto nowhere = service.http("GET", "/nowhere", "");
  EXPECT_FALSE(nowhere.ok);
  EXPECT_EQ(json::parse(nowhere.body)["ok"], false);
}

TEST(Inverse3Server, SpeaksWebSocketAndHttpToOneClientAfterAnother) {
  namespace asio = boost::asio;
  namespace beast = boost::beast;
  const auto server = Inverse3Server::start({}, 0);
  ASSERT_TRUE(server.ok());
  const asio::ip::tcp::endpoint endpoint(asio::ip::address_v4::loopback(), server.value().port());
  asio::io_context io;
  for (int client = 0; client < 2; ++client) {
    beast::websocket::stream<asio::ip::tcp::socket, false> socket(io);
    socket.next_layer().connect(endpoint);
    socket.handshake("127.0.0.1", "/");
    const auto read = [&socket] {
      beast::flat_buffer buffer;
      socket.read(buffer);
      return json::parse(beast::buffers_to_string(buffer.data()));
    };
    EXPECT_TRUE(read()["inverse3"][0].contains("config"));
    for (int tick = 0; tick < 20; ++tick) {
      socket.write(asio::buffer(push_new));
      const json told = read();
      EXPECT_FALSE(told["inverse3"][0].contains("config"));
      EXPECT_EQ(told["inverse3"][0]["state"]["current_cursor_force"]["x"], 1.0);
    }
  }  // it leaves without a word
  asio::ip::tcp::socket socket(io);
  socket.connect(endpoint);
  asio::write(socket, asio::buffer(std::string("GET /version HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")));
  std::string answer;
  beast::error_code error;
  asio::read(socket, asio::dynamic_buffer(answer), error);
  EXPECT_TRUE(answer.starts_with("HTTP/1.1 200 "));
  EXPECT_TRUE(answer.ends_with(R"({"data":{"version":"3.5.0"},"ok":true})")) << answer;
  // Who comes to a port that is taken is told so.
  const auto second = Inverse3Server::start({}, server.value().port());
  ASSERT_FALSE(second.ok());
  EXPECT_EQ(second.error().code, ErrorCode::unwritable);
}

}  // namespace tactus::emulation::inverse3::service_test
