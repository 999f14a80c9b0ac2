// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>

#include "tests/cli/command.hpp"
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace tactus::cli {
namespace {

using Stability = Command;
using Json = nlohmann::json;

const std::string tapping = std::string(TACTUS_EXPERIMENT_FOLDER) + "/tapping.toml";

TEST_F(Stability, the_gain_margin_times_the_gain_is_the_gain_limit_and_a_report_is_left) {
  const Outcome outcome = tactus({"stability", "margins", tapping, "--set", "control.cancellation=off", "--set",
                                  "control.force_gain=0.2", "--json", "--out", "results"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json found = Json::parse(outcome.out);
  EXPECT_NEAR(found["gain_margin"].get<double>() * 0.2, found["gain_limit"].get<double>(), 1e-9);
  EXPECT_EQ(found["stable"], 1.0);
  EXPECT_EQ(found["unstable_poles"], 0.0);
  const auto left = files();
  EXPECT_NE(std::find(left.begin(), left.end(), "results/report.html"), left.end());
}

TEST_F(Stability, a_gain_beyond_the_limit_has_two_unstable_poles) {
  const Outcome outcome = tactus({"stability", "margins", tapping, "--set", "control.cancellation=off", "--set",
                                  "control.force_gain=0.5", "--json"});
  const Json found = Json::parse(outcome.out);
  EXPECT_LT(found["gain_limit"].get<double>(), 0.5);
  EXPECT_EQ(found["unstable_poles"], 2.0);
  EXPECT_EQ(found["stable"], 0.0);
  EXPECT_TRUE(found["phase_margin_rad"].is_null()) << "an unstable loop has no margins";
}

TEST_F(Stability, a_model_of_another_master_is_named) {
  const std::string hint = "describe your device under [master] too";
  EXPECT_EQ(tactus({"stability", "margins", tapping}).out.find(hint), std::string::npos);
  const Outcome other = tactus({"stability", "margins", tapping, "--set", "control.model.motor.mass_kg=0.075"});
  ASSERT_EQ(other.status, 0) << other.err;
  EXPECT_NE(other.out.find("The model moves 0.0997 kg and [master] "), std::string::npos) << other.out;
  EXPECT_NE(other.out.find(hint), std::string::npos);
}

TEST_F(Stability, the_limit_in_time_of_the_bonded_rig_stands_beside_the_linear_one) {
  const Outcome outcome =
      tactus({"stability", "limit", tapping, "--set", "control.cancellation=off", "--set", "task.taps=1", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json limits = Json::parse(outcome.out)["limits"];
  ASSERT_GE(limits.size(), 8U);
  const double linear = limits[0]["force_gain"], bonded = limits[1]["force_gain"];
  EXPECT_NEAR(bonded, linear, 0.02 * linear);
  EXPECT_EQ(limits.back()["of"], "noise");
  const auto friction =
      std::find_if(limits.begin(), limits.end(), [](const Json& rung) { return rung["of"] == "friction"; });
  ASSERT_NE(friction, limits.end());
  EXPECT_TRUE(friction->contains("file_without"));
}

TEST_F(Stability, the_two_port_over_frequency_stands_in_the_document_and_a_report_is_left) {
  const Outcome outcome = tactus({"stability", "two-port", tapping, "--set", "control.force_gain=0.2", "--set",
                                  "control.cancellation=off", "--json", "--out", "results"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json found = Json::parse(outcome.out);
  const std::size_t points = found["frequency_Hz"].size();
  EXPECT_GT(points, 100U);
  for (const char* key : {"h11_N_s_per_m", "h12", "h21", "h22_m_per_N_s", "transparency"}) {
    EXPECT_EQ(found[key]["re"].size(), points) << key;
  }
  EXPECT_EQ(found["llewellyn_index"].size(), points);
  EXPECT_EQ(found["passivity_index"].size(), points);
  const auto left = files();
  EXPECT_NE(std::find(left.begin(), left.end(), "results/report.html"), left.end());
}

TEST_F(Stability, a_scorecard_says_what_changes_the_limit) {
  const Outcome outcome = tactus({"stability", "scorecard", tapping, "--set", "control.cancellation=off", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json card = Json::parse(outcome.out);
  // Scaling the command by 1.1 takes the limit down by as much, exactly.
  EXPECT_NEAR(card["sensitivities"]["control.position_scale"].get<double>(), 1.0 / 1.1 - 1.0, 1e-9);
  EXPECT_GT(card["force_bandwidth_Hz"].get<double>(), 20.0);
}

const std::string arms = std::string(TACTUS_EXPERIMENT_FOLDER) + "/arm-tapping.toml";
const std::string light_grip = std::string(TACTUS_EXPERIMENT_FOLDER) + "/arms/light-grip.toml";
const std::string bare_arms = std::string(TACTUS_EXPERIMENT_FOLDER) + "/arms/bare.toml";

TEST_F(Stability, two_arms_have_margins_too_and_a_report_is_left) {
  const Outcome outcome = tactus({"stability", "margins", arms, "--with", bare_arms, "--set", "task.direction=along-x",
                                  "--json", "--out", "results"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json found = Json::parse(outcome.out);
  EXPECT_TRUE(found["stable"]);
  EXPECT_EQ(found["drawn_models"], 0) << "position-force has no model";
  EXPECT_NEAR(found["gain_margin"].get<double>(), found["gain_limit"].get<double>(), 1e-9) << "at a gain of 1";
  EXPECT_LE(found["disk_gain_factor"].get<double>(), 1.01 * found["gain_margin"].get<double>());
  EXPECT_NEAR(found["at_limit"]["frequency_Hz"].get<double>(), 10.0, 5.0);
  const auto left = files();
  EXPECT_NE(std::find(left.begin(), left.end(), "results/report.html"), left.end());
}

TEST_F(Stability, two_arms_are_mapped_over_pose_and_hand) {
  const Outcome outcome =
      tactus({"stability", "map", arms, "--with", bare_arms, "--hand", light_grip, "--vary", "task.pose=0,1", "--vary",
              "control.method=position-force,cancellation", "--friction-speed", "0.1", "--json", "--out", "results"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json points = Json::parse(outcome.out)["points"];
  ASSERT_EQ(points.size(), 8U);
  EXPECT_EQ(points[0]["hand"], "own");
  EXPECT_EQ(points[7]["hand"], "light-grip");
  EXPECT_EQ(points[7]["set"]["task.pose"], 1);
  for (std::size_t i = 0; i < points.size(); i += 2) {
    // What docs/theory/arms.md says: without damping, do not cancel with a model that errs.
    EXPECT_LT(points[i + 1]["drawn_limit"].get<double>(), points[i]["drawn_limit"].get<double>()) << i;
    EXPECT_LE(points[i + 1]["drawn_limit"].get<double>(), 1.01 * points[i + 1]["gain_limit"].get<double>()) << i;
  }
  const auto left = files();
  for (const char* file : {"results/report.html", "results/map.csv", "results/map.svg"}) {
    EXPECT_NE(std::find(left.begin(), left.end(), file), left.end()) << file;
  }
}

TEST_F(Stability, of_two_arms_what_has_no_linear_loop_or_no_use_is_refused_by_name) {
  for (const char* method : {"position-position", "factr", "feedback-avoidance", "four-channel"}) {
    for (const char* verb : {"margins", "map"}) {
      const Outcome outcome = tactus({"stability", verb, arms, "--set", std::string("control.method=") + method,
                                      verb == std::string("map") ? "--vary=task.pose=0,1" : "--friction-speed=0"});
      EXPECT_EQ(outcome.status, 2) << method;
      EXPECT_NE(outcome.err.find(method), std::string::npos) << outcome.err;
    }
  }
  for (const char* option : {"--uncertainty=0.1", "--preload=2", "--linkage-amplitude=0.001"}) {
    const Outcome outcome = tactus({"stability", "margins", arms, option});
    EXPECT_EQ(outcome.status, 2) << option;
    EXPECT_NE(outcome.err.find(std::string(option).substr(0, 9)), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(tactus({"stability", "map", arms, "--precision", "float"}).status, 2);
  EXPECT_EQ(tactus({"stability", "map", tapping, "--hand", light_grip}).status, 2);
}

TEST_F(Stability, what_cannot_be_judged_is_refused_at_its_place) {
  const std::string file =
      write("wave.toml", "[task]\nkind = \"tapping\"\n[control]\narchitecture = \"wave-variables\"\n");
  for (const std::string verb : {"margins", "limit", "scorecard", "two-port"}) {
    const Outcome outcome = tactus({"stability", verb, file, "--out", "results"});
    EXPECT_EQ(outcome.status, 2) << verb;
    EXPECT_NE(outcome.err.find("wave.toml:4"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("control.architecture"), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(files(), std::vector<std::string>{"wave.toml"});
  EXPECT_EQ(tactus({"stability"}).status, 2);
  EXPECT_EQ(tactus({"stability", "margins", tapping, "--uncertainty", "2"}).status, 2);
}

}  // namespace
}  // namespace tactus::cli
