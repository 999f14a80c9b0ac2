// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "tests/cli/command.hpp"
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace tactus::cli {
namespace {

using Diagnose = Command;
using Json = nlohmann::json;

const std::string shipped = TACTUS_EXAMPLE_FOLDER "/recordings/shaking-contact.csv";

/// Four seconds at 1 kHz of a slave that shakes by itself at 25 Hz from 1 s on.
std::string shaking_slave(const std::string& header) {
  std::string text = header + "\n";
  for (int i = 0; i < 4000; ++i) {
    const double t = 1e-3 * i;
    const double shake = t > 1.0 ? 2e-3 * std::sin(2.0 * std::numbers::pi * 25.0 * t) : 0.0;
    char line[96];
    std::snprintf(line, sizeof line, "%.3f,%.5f,%.5f\n", t, 0.01, 0.01 + shake);
    text += line;
  }
  return text;
}

TEST_F(Diagnose, the_recording_that_ships_is_named_as_it_was_made) {
  const Outcome outcome = tactus({"diagnose", shipped, "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json json = Json::parse(outcome.out);
  ASSERT_EQ(json["oscillations"].size(), 1U) << outcome.out;
  const Json& one = json["oscillations"][0];
  EXPECT_EQ(one["mechanism"], "induced-motion");
  EXPECT_NEAR(one["frequency_Hz"].get<double>(), 67.6, 1.0);
  EXPECT_GT(one["loop_gain"].get<double>(), 1.2);
  EXPECT_LE(one["loop_gain_interval_95"][0], one["loop_gain"]);
  EXPECT_FALSE(one["evidence"].empty());
  EXPECT_EQ(json["signals"]["tip_force"], "tip_force");
  EXPECT_TRUE(json["signals"]["hand_force"].is_null());
}

TEST_F(Diagnose, the_verdict_comes_first_and_the_report_holds_spectrogram_and_loop) {
  const Outcome outcome = tactus({"diagnose", shipped, "--out", "results"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.out.rfind("It shakes at ", 0), 0U) << outcome.out;
  const std::string page = content("results/report.html");
  EXPECT_NE(page.find("Spectrogram of the"), std::string::npos);
  EXPECT_NE(page.find("displayed force"), std::string::npos);
  EXPECT_NE(page.find("here"), std::string::npos);
  EXPECT_FALSE(Json::parse(content("results/results.json"), nullptr, false).is_discarded());
  EXPECT_EQ(tactus({"diagnose", shipped, "--out", "results"}).status, 2);
  EXPECT_EQ(tactus({"diagnose", shipped, "--out", "results", "--overwrite"}).status, 0);
}

TEST_F(Diagnose, columns_are_found_by_leader_and_follower_or_named) {
  write("arms.csv", shaking_slave("time [s],leader_position [rad],follower_position [rad]"));
  const Outcome found = tactus({"diagnose", "arms.csv", "--json"});
  ASSERT_EQ(found.status, 0) << found.err;
  EXPECT_EQ(Json::parse(found.out)["oscillations"][0]["mechanism"], "slave-servo");

  write("named.csv", shaking_slave("time [s],a,b"));
  const Outcome unnamed = tactus({"diagnose", "named.csv"});
  EXPECT_EQ(unnamed.status, 2);
  EXPECT_NE(unnamed.err.find("--slave-position"), std::string::npos) << unnamed.err;
  EXPECT_NE(unnamed.err.find("'b'"), std::string::npos) << unnamed.err;
  const Outcome named = tactus({"diagnose", "named.csv", "--master-position", "a", "--slave-position", "b", "--json"});
  ASSERT_EQ(named.status, 0) << named.err;
  EXPECT_NEAR(Json::parse(named.out)["oscillations"][0]["frequency_Hz"].get<double>(), 25.0, 0.2);
}

TEST_F(Diagnose, with_the_slave_alone_it_says_what_to_record) {
  write("slave.csv", shaking_slave("time [s],a,slave_position [m]"));
  const Outcome outcome = tactus({"diagnose", "slave.csv", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json json = Json::parse(outcome.out);
  EXPECT_EQ(json["oscillations"][0]["mechanism"], "unknown");
  EXPECT_EQ(json["oscillations"][0]["confidence"], 0.0);
  ASSERT_FALSE(json["record_next"].empty());
  EXPECT_NE(json["record_next"].dump().find("master position"), std::string::npos);
}

TEST_F(Diagnose, what_cannot_be_read_is_refused_with_place_and_remedy) {
  const auto refused = [this](const std::string& name, const std::string& text, const std::string& reason) {
    write(name, text);
    const Outcome outcome = tactus({"diagnose", name});
    EXPECT_EQ(outcome.status, 2) << name << outcome.out;
    EXPECT_NE(outcome.err.find(reason), std::string::npos) << name << ": " << outcome.err;
    EXPECT_NE(outcome.err.find(name), std::string::npos) << outcome.err;
  };
  const std::string header = "time_s,master_position_m,slave_position_m\n";
  refused("short.csv", header + "0,0,0\n0.001,0,0.1\n", "too few");
  refused("nan.csv", header + "0,0,0\n0.001,0,nan\n", "nan.csv:3:9");
  refused("irregular.csv", header + "0,0,0\n0.001,0,1\n0.005,0,2\n", "not uniform");
  refused("kilograms.csv", "time_s,slave_position [kg]\n0,0\n0.001,1\n", "--slave-position");
  refused("recording.json", "{}", "must end in");
  // What no instrument measures, whose squares are no numbers.
  std::string huge = header;
  for (int i = 0; i < 1000; ++i) {
    huge += std::to_string(1e-3 * i) + (i % 7 < 4 ? ",1e308,1e308\n" : ",-1e308,-9e307\n");
  }
  refused("huge.csv", huge, "huge.csv:2:10");
  refused("huge.csv", huge, "is beyond 1e30");
  std::string still = header;
  for (int i = 0; i < 1000; ++i) still += std::to_string(1e-3 * i) + ",0.5,0.5\n";
  refused("still.csv", still, "no position changes");
  std::string turned = "time_s,master_position_m,displayed_force_N,tip_force_N\n";
  for (int i = 0; i < 1000; ++i) {
    const double f = std::sin(0.02 * i);
    turned += std::to_string(1e-3 * i) + "," + std::to_string(0.01 * f) + "," + std::to_string(-f) + "," +
              std::to_string(f) + "\n";
  }
  refused("turned.csv", turned, "--displayed-force-sign -1");
}

TEST_F(Diagnose, tells_a_wrong_range_of_velocity_and_an_old_reading_of_two_arms_apart) {
  const std::string arms = std::string(TACTUS_EXPERIMENT_FOLDER) + "/arm-vibration.toml";
  const auto told = [&](const std::string& folder, const std::vector<std::string>& settings) {
    std::vector<std::string> command{"run", arms, "--out", folder};
    for (const std::string& setting : settings) command.insert(command.end(), {"--set", setting});
    EXPECT_EQ(tactus(command).status, 0);
    return Json::parse(tactus({"diagnose", folder + "/recording.csv", "--json"}).out);
  };
  const Json sound = told("sound", {});
  EXPECT_TRUE(sound["oscillations"].empty()) << sound["verdict"];
  EXPECT_NEAR(sound["reported_velocity_scale"]["master"].get<double>(), 1.0, 0.02);
  EXPECT_EQ(sound["verdict"].get<std::string>().find("VMAX"), std::string::npos);

  const Json scaled = told("scaled", {"cause.velocity_scale=3"});
  EXPECT_NEAR(scaled["reported_velocity_scale"]["master"].get<double>(), 3.0, 0.05);
  EXPECT_NEAR(scaled["reported_velocity_scale"]["slave"].get<double>(), 1.0, 0.02);
  EXPECT_EQ(scaled["verdict"].get<std::string>().rfind("The velocity leader_velocity is reported as 3.0 times", 0), 0U)
      << scaled["verdict"];

  const Json old = told("old", {"host.answer_ticks=29", "task.joint=5"});
  ASSERT_EQ(old["oscillations"].size(), 1U) << old["verdict"];
  EXPECT_EQ(old["oscillations"][0]["mechanism"], "delay");
  EXPECT_EQ(old["verdict"].get<std::string>().find("VMAX"), std::string::npos);
}

}  // namespace
}  // namespace tactus::cli
