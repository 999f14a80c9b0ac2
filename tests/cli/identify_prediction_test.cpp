// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <vector>

#include "tests/cli/command.hpp"
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace tactus::cli {
namespace {

using IdentifyPrediction = Command;
using Json = nlohmann::json;

const std::string chirp = std::string(TACTUS_EXPERIMENT_FOLDER) + "/inverse-model-chirp.toml";

TEST_F(IdentifyPrediction, closed_form_limit_and_slow_data_agree_and_share_the_lead_among_the_blocks) {
  const Outcome outcome = tactus({"identify", "prediction", chirp, "--blocks", "2", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json found = Json::parse(outcome.out);
  // Two delays and two lags of 2 ms each and the derivative's filter of 0.5 ms, for two blocks.
  EXPECT_NEAR(found["closed_form_s"].get<double>(), (4 * 0.002 + 0.0005) / 2, 1e-12);
  EXPECT_NEAR(found["limit_s"].get<double>(), found["closed_form_s"].get<double>(), 1e-3 * 0.00425);
  EXPECT_NEAR(found["from_data_s"].get<double>(), found["closed_form_s"].get<double>(), 0.05 * 0.00425);
}

TEST_F(IdentifyPrediction, its_report_says_the_three_ways_and_how_to_repeat_it) {
  const Outcome outcome = tactus({"identify", "prediction", chirp, "--blocks", "3", "--out", "found"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(files(), (std::vector<std::string>{"found", "found/report.html", "found/results.json"}));
  EXPECT_EQ(Json::parse(content("found/results.json"))["blocks"], 3);
  const std::string page = content("found/report.html");
  for (const char* part : {"closed form", "numeric limit", "N RMS", "identify prediction", "[estimator]"}) {
    EXPECT_NE(page.find(part), std::string::npos) << part;
  }
}

TEST_F(IdentifyPrediction, what_cannot_be_is_refused_by_name) {
  const Outcome blocks = tactus({"identify", "prediction", chirp, "--blocks", "9"});
  EXPECT_EQ(blocks.status, 2);
  EXPECT_NE(blocks.err.find("blocks"), std::string::npos) << blocks.err;

  const Outcome recording = tactus({"identify", "prediction", chirp, "--recording", "none.csv"});
  EXPECT_EQ(recording.status, 2);
  EXPECT_NE(recording.err.find("none.csv"), std::string::npos) << recording.err;

  const Outcome unstable = tactus({"identify", "prediction", chirp, "--set", "slave.controller_gain_N_per_m=1000"});
  EXPECT_EQ(unstable.status, 2);
  EXPECT_NE(unstable.err.find("unstable"), std::string::npos) << unstable.err;
}

}  // namespace
}  // namespace tactus::cli
