// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "tests/cli/command.hpp"
#include <nlohmann/json.hpp>

namespace tactus::cli {
namespace {

using Words = std::vector<std::string>;
using Json = nlohmann::json;

class Export : public Command {
 protected:
  void SetUp() override {
    Command::SetUp();
    ASSERT_EQ(tactus({"run", quick_experiment(), "--out", "one"}).status, 0);
  }

  void expect_refusal(const Words& arguments, int status, const Words& told) const {
    const Outcome outcome = tactus(arguments);
    EXPECT_EQ(outcome.status, status) << outcome.err;
    for (const std::string& words : told) EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
  }
};

TEST_F(Export, EqualRunsLeaveEqualLogs) {
  ASSERT_EQ(tactus({"run", "quick.toml", "--out", "two"}).status, 0);
  EXPECT_EQ(content("one/log/log.mcap"), content("two/log/log.mcap"));
  EXPECT_EQ(content("one/log/metadata.yaml"), content("two/log/metadata.yaml"));
}

TEST_F(Export, TheTableHasEverySignalWithItsUnitAndOneRowATick) {
  ASSERT_EQ(tactus({"export", "one/log", "--to", "csv"}).status, 0);
  std::istringstream table(content("one/log/log.csv"));
  std::string head, first, second;
  std::getline(table, head);
  std::getline(table, first);
  std::getline(table, second);
  EXPECT_EQ(head,
            "time [s],master_position [m],induced_position [m],command [m],slave_position [m],tip_position [m],"
            "displayed_force [N],handle_force [N],hand_force [N],sent_force [N],contact_force [N],peak_contact_force "
            "[N],touched,"
            "touched_at [s],estimated_grip,estimated_grip_deviation");
  EXPECT_TRUE(first.starts_with("0,")) << first;
  EXPECT_TRUE(second.starts_with("2e-04,")) << second;  // 5 kHz
}

TEST_F(Export, ALogIsARecordingThatTheVerbsForRecordingsRead) {
  ASSERT_EQ(tactus({"export", "one/log", "--to", "csv", "--out", "tap.csv"}).status, 0);
  const Outcome outcome = tactus({"identify", "frf", "tap.csv", "--input", "displayed_force", "--output",
                                  "master_position", "--method", "etfe", "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

TEST_F(Export, AColumnAnswersToItsSignalsNameWithItsUnitAndWithout) {
  ASSERT_EQ(tactus({"export", "one/log", "--to", "csv", "--out", "tap.csv"}).status, 0);
  ASSERT_EQ(tactus({"export", "one/log", "--to", "mat", "--out", "tap.mat"}).status, 0);
  const auto response = [this](const std::string& file, const std::string& input, const std::string& output) {
    const Outcome outcome =
        tactus({"identify", "frf", file, "--input", input, "--output", output, "--method", "etfe", "--json"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return Json::parse(outcome.out, nullptr, false)["response"];
  };
  const Json found = response("tap.csv", "displayed_force", "master_position");
  ASSERT_GT(found.size(), 100U);
  EXPECT_EQ(response("tap.csv", "displayed_force_N", "master_position_m"), found);
  EXPECT_EQ(response("tap.csv", "displayed_force [N]", "master_position [m]"), found);
  EXPECT_EQ(response("tap.mat", "teleoperator.displayed_force_N", "teleoperator.master_position_m"), found);
  EXPECT_EQ(response("tap.mat", "teleoperator.displayed_force", "teleoperator.master_position"), found);
  expect_refusal({"identify", "frf", "tap.csv", "--input", "displayed_force_m", "--output", "master_position"}, 2,
                 {"displayed_force"});
}

TEST_F(Export, EveryFormatSaysWhichConditionARunIs) {
  ASSERT_EQ(tactus({"run", "quick.toml", "--vary", "control.force_gain=1,3", "--out", "both"}).status, 0);
  ASSERT_EQ(tactus({"export", "both/log", "--to", "csv", "--topic", "/run_2/teleoperator"}).status, 0);
  EXPECT_TRUE(content("both/log/log.csv").starts_with("# force gain 3\n# control.force_gain=3\ntime [s],"));
  EXPECT_EQ(tactus({"identify", "frf", "both/log/log.csv", "--input", "displayed_force_N", "--output",
                    "master_position_m", "--method", "etfe"})
                .status,
            0);
  ASSERT_EQ(tactus({"export", "both/log", "--to", "hdf5"}).status, 0);
  for (const char* words : {"force gain 1", "force gain 3", "control.force_gain"}) {
    EXPECT_NE(content("both/log/log.h5").find(words), std::string::npos) << words;
    EXPECT_NE(content("both/log/log.mcap").find(words), std::string::npos) << words;
  }
  ASSERT_EQ(tactus({"export", "both/log", "--to", "mat"}).status, 0);
  const Outcome wrong = tactus({"identify", "frf", "both/log/log.mat", "--input", "run_2_teleoperator.condition.label",
                                "--output", "run_2_teleoperator.master_position_m"});
  EXPECT_NE(wrong.err.find("is of class char"), std::string::npos) << wrong.err;
}

TEST_F(Export, AMatlabFileAndHdf5AreWrittenBesideTheLog) {
  for (const std::string format : {"mat", "hdf5"}) {
    const Outcome outcome = tactus({"export", "one/log/log.mcap", "--to", format, "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const Json json = Json::parse(outcome.out, nullptr, false);
    ASSERT_FALSE(json.is_discarded()) << outcome.out;
    EXPECT_EQ(json["file"], format == "mat" ? "one/log/log.mat" : "one/log/log.h5");
    EXPECT_TRUE(json["complete"]);
    EXPECT_FALSE(json["damaged_elsewhere"]);
    EXPECT_EQ(json["topics"][0]["topic"], "/teleoperator");
    EXPECT_EQ(json["topics"][0]["missing"], 0);
  }
  EXPECT_TRUE(content("one/log/log.mat").starts_with("MATLAB 5.0 MAT-file"));
  EXPECT_TRUE(content("one/log/log.h5").starts_with("\x89HDF\r\n"));
}

TEST_F(Export, OfACutLogTheCompletePartIsExportedAndThePersonIsTold) {
  write("cut.mcap", content("one/log/log.mcap").substr(0, content("one/log/log.mcap").size() - 20));
  const Outcome outcome = tactus({"export", "cut.mcap", "--to", "csv"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("The log has no end"), std::string::npos) << outcome.out;
}

TEST_F(Export, AWrongRequestIsRefusedWithTheRemedy) {
  ASSERT_EQ(tactus({"run", "quick.toml", "--vary", "control.force_gain=1,3", "--out", "both"}).status, 0);
  expect_refusal({"export", "both/log", "--to", "csv"}, 2,
                 {"--topic", "name one of /run_1/teleoperator, /run_2/teleoperator"});
  expect_refusal({"export", "both/log", "--to", "mat", "--topic", "/run_3"}, 2, {"--topic", "/run_3"});
  expect_refusal({"export", "absent.mcap", "--to", "csv"}, 2, {"absent.mcap", "name a log"});
  expect_refusal({"export", "quick.toml", "--to", "csv"}, 2, {"quick.toml", "no MCAP file"});
  expect_refusal({"export", "one", "--to", "csv"}, 2, {"0 .mcap files"});
  expect_refusal({"export", "one/log", "--to", "xls"}, 2, {"--to"});
  expect_refusal({"export", "one/log", "--to", "hdf5", "--out", "absent/log.h5"}, 1, {"absent/log.h5", "folder"});
}

}  // namespace
}  // namespace tactus::cli
