// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/inverse3/messages.hpp>
#include <tactus/hardware/emulation/inverse3/inverse3_service.hpp>

#include <limits>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

namespace tactus::devices::inverse3::messages_test {

using emulation::inverse3::Inverse3Service;
constexpr std::int64_t ms = 1'000'000;

// Typed from the vendor's pages.
const std::string snapshot = R"({"session_id":7,"inverse3":[{"device_id":"049D",
  "config":{"handedness":"right","filters":{"force_gate":{"gain":0.3},"damping":{"scalar":0.1}}},
  "state":{"cursor_position":{"x":0.01,"y":-0.12,"z":0.2},"cursor_velocity":{"x":0.5,"y":0,"z":-1},
           "current_cursor_force":{"x":0,"y":0,"z":1.5},"control_domain":"cartesian"},
  "status":{"calibrated":true,"in_use":true,"power_supply":true,"ready":true,"started":true}}]})";

TEST(Inverse3Messages, ACommandHasTheKeysOfItsDialect) {
  EXPECT_EQ(
      force_message("049D", {1.5, 0.0, -2.0}, Dialect::named),
      R"({"inverse3":[{"commands":{"set_cursor_force":{"vector":{"x":1.5,"y":0.0,"z":-2.0}}},"device_id":"049D"}]})");
  EXPECT_EQ(
      force_message("049D", {1.5, 0.0, -2.0}, Dialect::values),
      R"({"inverse3":[{"commands":{"set_cursor_force":{"values":{"x":1.5,"y":0.0,"z":-2.0}}},"device_id":"049D"}]})");
  const std::string probe = R"({"inverse3":[{"commands":{"probe_position":{}},"device_id":"049D"}]})";
  EXPECT_EQ(probe_message("049D"), probe);
  EXPECT_EQ(force_message("049D", {0.0, std::numeric_limits<double>::quiet_NaN(), 0.0}, Dialect::named), probe);
}

TEST(Inverse3Messages, AnIdThatIsNoTextDoesNoHarm) {
  EXPECT_NE(probe_message("\xff\xfe").find("probe_position"), std::string::npos);
}

TEST(Inverse3Messages, TheVersionTellsTheDialect) {
  const auto of = [](const char* version) {
    return dialect_of(std::string(R"({"ok":true,"data":{"version":")") + version + R"("}})").value();
  };
  for (const char* version : {"3.0.1", "3.1.0", "3.4.9"}) EXPECT_EQ(of(version), Dialect::values) << version;
  for (const char* version : {"3.5.0", "3.5.2-rc1", "3.10.0", "4.0"}) EXPECT_EQ(of(version), Dialect::named) << version;
  EXPECT_FALSE(dialect_of("<html>404</html>").ok());
}

TEST(Inverse3Messages, TheFirstTellsAllAndLaterOnesWhatChanged) {
  Devices devices;
  ASSERT_FALSE(devices.take(snapshot));
  ASSERT_EQ(devices.all().size(), 1U);
  const Device& device = devices.all().front();
  EXPECT_EQ(device.id, "049D");
  EXPECT_EQ(device.position_m, (Vector{0.01, -0.12, 0.2}));
  EXPECT_EQ(device.velocity_m_per_s, (Vector{0.5, 0.0, -1.0}));
  EXPECT_EQ(device.force_N, (Vector{0.0, 0.0, 1.5}));
  EXPECT_TRUE(device.calibrated && device.ready);
  EXPECT_EQ(device.force_gate, 0.3);
  EXPECT_EQ(device.damping, 0.1);
  ASSERT_FALSE(devices.take(R"({"inverse3":[{"device_id":"049D","state":{"cursor_position":{"x":1,"y":2,"z":3}}}]})"));
  EXPECT_EQ(devices.all().front().position_m, (Vector{1.0, 2.0, 3.0}));
  EXPECT_EQ(devices.all().front().velocity_m_per_s, (Vector{0.5, 0.0, -1.0}));
  EXPECT_EQ(devices.all().front().force_gate, 0.3);
  ASSERT_FALSE(devices.take(R"({"inverse3":[{"device_id":"04A2"}]})"));
  EXPECT_EQ(devices.all().size(), 2U);
  EXPECT_FALSE(devices.all().back().calibrated);
}

TEST(Inverse3Messages, WhatIsWrongIsNamedAndChangesNothing) {
  Devices devices;
  ASSERT_FALSE(devices.take(snapshot));
  for (
      const char* bad :
      {"", "{", "7", "[]", R"({"inverse3":{}})", R"({"inverse3":[7]})", R"({"inverse3":[{"device_id":7}]})",
       R"({"inverse3":[{"device_id":"049D","state":{"cursor_position":{"x":1,"y":2}}}]})",
       R"({"inverse3":[{"device_id":"049D","state":{"cursor_position":[1,2,3]}}]})",
       R"({"inverse3":[{"device_id":"049D","state":{"cursor_velocity":{"x":1,"y":2,"z":"3"}}}]})",
       R"({"inverse3":[{"device_id":"049D","state":{"cursor_position":{"x":9,"y":9,"z":9}},"status":{"ready":1}}]})"}) {
    EXPECT_TRUE(devices.take(bad)) << bad;
    EXPECT_EQ(devices.all().front().position_m, (Vector{0.01, -0.12, 0.2})) << bad;
  }
  EXPECT_EQ(describe(*devices.take(R"({"inverse3":[{"device_id":"049D","status":{"ready":1}}]})")),
            "049D.ready: the service reports no true or false");
}

TEST(Inverse3Messages, ADeviceIsOffWhereTheLatestMessageSaysSoAndNothingSaysOtherwise) {
  const std::string force = R"("current_cursor_force":{"x":0,"y":0.5,"z":0})";
  const std::string none = R"("current_cursor_force":{"x":0,"y":0,"z":0})";
  for (const auto& [state, off, text] : {std::tuple{R"("control_mode":"idle",)" + none, true, "mode 'idle'"},
                                         {R"("control_mode":"idle")", true, "mode 'idle'"},
                                         {R"("mode":"idle",)" + none, true, "mode 'idle'"},
                                         {none, true, "no mode"},
                                         {R"("control_mode":"idle",)" + force, false, "mode 'idle'"},
                                         {R"("control_mode":"force",)" + none, false, "mode 'force'"},
                                         {R"("control_mode":"something",)" + none, false, "mode 'somethi'"},
                                         {R"("control_mode":"\u001b[2J",)" + none, false, "mode '?[2J'"},
                                         {force, false, "no mode"},
                                         {std::string(R"("cursor_position":{"x":0,"y":0,"z":0})"), false, "no mode"}}) {
    Devices devices;
    // What an earlier message said counts no more.
    ASSERT_FALSE(devices.take(R"({"inverse3":[{"device_id":"049D","state":{"mode":"idle",)" + none + "}}]}"));
    EXPECT_TRUE(reports_off(devices.all().front()));
    ASSERT_FALSE(devices.take(R"({"inverse3":[{"device_id":"049D","state":{)" + state + "}}]}")) << state;
    EXPECT_EQ(reports_off(devices.all().front()), off) << state;
    EXPECT_EQ(status_text(status_of(devices.all().front())), text) << state;
  }
  Devices devices;
  EXPECT_TRUE(devices.take(R"({"inverse3":[{"device_id":"049D","state":{"mode":7}}]})"));
}

TEST(Inverse3Messages, TheEmulatedServiceObeysAndIsUnderstoodInBothDialects) {
  for (const auto spoken : {emulation::inverse3::Dialect::v3_1, emulation::inverse3::Dialect::v3_5}) {
    auto service = Inverse3Service::make({.dialect = spoken, .partial = true}).value();
    const auto dialect = dialect_of(service.http("GET", "/version", "").body);
    ASSERT_TRUE(dialect.ok());
    Devices devices;
    ASSERT_FALSE(devices.take(service.snapshot(0)));
    const std::string id = devices.all().front().id;
    for (int tick = 1; tick <= 50; ++tick) {
      ASSERT_FALSE(devices.take(service.answer(force_message(id, {0.0, 2.0, 0.0}, dialect.value()), tick * ms).text));
    }
    EXPECT_EQ(devices.all().front().force_N, (Vector{0.0, 2.0, 0.0}));
    EXPECT_EQ(devices.all().front().position_m, service.position_m(0));
    EXPECT_GT(devices.all().front().velocity_m_per_s[1], 0.1);
  }
}

}  // namespace tactus::devices::inverse3::messages_test
