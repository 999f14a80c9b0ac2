// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "tests/cli/command.hpp"
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace tactus::cli {
namespace {

using Json = nlohmann::json;
using Words = std::vector<std::string>;

const std::string quick_map = std::string(TACTUS_QUICK_MAP);

class StabilityMap : public Command {
 protected:
  /// A map of few points without cancellation, with more words behind.
  [[nodiscard]] Outcome map(const Words& more) const {
    Words words{
        "stability", "map", quick_map, "--set", "control.cancellation=off", "--vary", "control.force_gain=0.5:30:12"};
    words.insert(words.end(), more.begin(), more.end());
    return tactus(words);
  }
  [[nodiscard]] bool left(const std::string& file) const {
    const auto all = files();
    return std::find(all.begin(), all.end(), file) != all.end();
  }
};

TEST_F(StabilityMap, LeavesTableHdf5PictureReportAndResults) {
  const Outcome outcome =
      map({"--vary", "environment.stiffness_N_per_m=1e3:5e4:10[log]", "--out", "results", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const std::string file : {"map.csv", "map.h5", "map.svg", "report.html", "results.json"}) {
    EXPECT_TRUE(left("results/" + file)) << file;
  }
  EXPECT_FALSE(left("results/tasks.partial"));
  const Json told = Json::parse(outcome.out);
  EXPECT_EQ(told, Json::parse(content("results/results.json")));
  EXPECT_EQ(told["points"], 120);
  EXPECT_EQ(told["axes"][1]["unit"], "N/m");
  EXPECT_EQ(told["axes"][1]["values"].size(), 10U);
  EXPECT_EQ(told["settled_limit"].size(), 10U);
  const Json& plane = told["planes"][0];
  EXPECT_EQ(plane["settled"].get<int>() + plane["ringing"].get<int>() + plane["limit-cycle"].get<int>() +
                plane["diverged"].get<int>(),
            120);
  const std::string table = content("results/map.csv");
  EXPECT_TRUE(table.starts_with(
      "control.force_gain,environment.stiffness_N_per_m (N/m),verdict,settling_time_s,settling_time_s_censored,"))
      << table.substr(0, 200);
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 121);
  std::istringstream lines(table);
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    const bool came_to_rest =
        line.find(",settled,") != std::string::npos || line.find(",ringing,") != std::string::npos;
    EXPECT_NE(line.find(came_to_rest ? ",false," : ",true,"), std::string::npos) << line;
  }
}

TEST_F(StabilityMap, TheReportNamesAxesWithUnitsAndHowItWasMade) {
  ASSERT_EQ(map({"--vary", "environment.stiffness_N_per_m=1e3:5e4:10[log]", "--out", "results"}).status, 0);
  const std::string page = content("results/report.html");
  for (const std::string words : {"stability map", "environment stiffness", "N/m", "force gain", "limit cycle",
                                  "tactus stability map", "observation_s = 0.25"}) {
    EXPECT_NE(page.find(words), std::string::npos) << words;
  }
}

TEST_F(StabilityMap, OneAxisGivesALimitAndNoPicture) {
  const Outcome outcome = map({"--out", "results", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(Json::parse(outcome.out)["settled_limit"].size(), 1U);
  EXPECT_FALSE(left("results/map.svg"));
  EXPECT_TRUE(left("results/report.html"));
}

TEST_F(StabilityMap, AMapInFloatSaysHowManyPointsItRanAgain) {
  const Outcome outcome =
      map({"--vary", "environment.stiffness_N_per_m=1e3:5e4:10[log]", "--precision", "float", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json told = Json::parse(outcome.out);
  EXPECT_GT(told["redone_in_double"].get<int>(), 0);
  EXPECT_LT(told["redone_in_double"].get<int>(), 120);
}

TEST_F(StabilityMap, AWrongRequestIsRefusedAtItsPlaceAndLeavesNothing) {
  const auto expect_refusal = [this](const Words& more, const std::string& told) {
    Words words = more;
    words.insert(words.end(), {"--out", "results"});
    const Outcome outcome = map(words);
    EXPECT_EQ(outcome.status, 2) << told;
    EXPECT_NE(outcome.err.find(told), std::string::npos) << outcome.err;
    EXPECT_EQ(files(), Words{});
  };
  expect_refusal({"--vary", "servo.rate_Hz=1000,2000"}, "--vary servo.rate_Hz=1000,2000");
  expect_refusal({"--vary", "environment.stiffness_N_per_m=1e3:1e9:10"}, "environment.stiffness_N_per_m");
  expect_refusal({"--vary", "control.force_gain=1,2"}, "varied twice");
  expect_refusal({"--set", "control.architecture=four-channel"}, "control.architecture");
  expect_refusal({"--set", "slave.force_sensor.noise_rms_N=0.1"}, "write 0");
  EXPECT_EQ(map({"--out", ""}).status, 2);
  EXPECT_EQ(tactus({"stability", "map", quick_map}).status, 2);
}

}  // namespace
}  // namespace tactus::cli
