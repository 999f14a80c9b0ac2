// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <string>
#include <vector>

#include "tests/cli/command.hpp"
#include <nlohmann/json.hpp>

namespace tactus::cli {
namespace {

using RealTime = Command;
using Words = std::vector<std::string>;
using Json = nlohmann::json;

/// Two taps, well under a second each.
const Words short_taps{"--realtime", "--set", "task.taps=2", "--set", "task.observation_s=0.15", "--priority", "10"};

Words run(const std::string& file, const Words& more) {
  Words all{"run", file};
  all.insert(all.end(), more.begin(), more.end());
  all.insert(all.end(), short_taps.begin(), short_taps.end());
  return all;
}

TEST_F(RealTime, TheTappingExperimentGivesItsTableAndHowTimeWasKept) {
  const Outcome outcome = tactus(run(quick_experiment(), {}));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  for (const char* word : {"verdict", "lateness, from deadline to begin", "duration of the step", "late control cycles",
                           "ours", "the machine's", "stalled"}) {
    EXPECT_NE(outcome.out.find(word), std::string::npos) << word;
  }
  EXPECT_EQ(files(), Words{"quick.toml"}) << "nothing is left behind without --out";
}

TEST_F(RealTime, EveryTickOfEveryTapIsInTheLogWhichOtherVerbsRead) {
  const Outcome outcome = tactus(run(quick_experiment(), {"--out", "results", "--json"}));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json document = Json::parse(outcome.out);
  EXPECT_EQ(document["clock"], "real");
  const Json& servo = document["runs"][0]["servo"];
  EXPECT_EQ(document["runs"][0]["metrics"]["taps"], 2);
  const Outcome log = tactus({"export", "results/log", "--to", "mat", "--json"});
  ASSERT_EQ(log.status, 0) << log.err;
  const Json told = Json::parse(log.out);
  for (const Json& topic : told["topics"]) {
    EXPECT_EQ(topic["missing"], 0);
    if (topic["topic"] == "/servo") {
      EXPECT_EQ(topic["messages"].get<int>(), servo["ticks"].get<int>() - 2) << "the last step of a tap has no record";
    }
  }
  EXPECT_NE(content("results/report.html").find("How time was kept"), std::string::npos);
}

TEST_F(RealTime, OnlyTappingAndOnlyAShortOneRunsInRealTime) {
  const std::string contest = std::string(TACTUS_EXPERIMENT_FOLDER) + "/contest.toml";
  const Outcome other = tactus({"run", contest, "--realtime"});
  EXPECT_EQ(other.status, 2);
  EXPECT_NE(other.err.find("task.kind"), std::string::npos) << other.err;
  const Outcome endless =
      tactus({"run", quick_experiment(), "--realtime", "--set", "task.taps=1001", "--out", "results"});
  EXPECT_EQ(endless.status, 2);
  EXPECT_NE(endless.err.find("task.taps"), std::string::npos) << endless.err;
  EXPECT_EQ(files(), Words{"quick.toml"});
}

TEST_F(RealTime, TwoArmsTapAtTheRealClockAndLeaveBothSitesAndBothToolsInTheLog) {
  const std::string arms = std::string(TACTUS_EXPERIMENT_FOLDER) + "/arm-tapping.toml";
  const Outcome outcome = tactus({"run", arms, "--realtime", "--set", "task.taps=2", "--out", "results", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json document = Json::parse(outcome.out);
  EXPECT_EQ(document["clock"], "real");
  EXPECT_EQ(document["runs"][0]["metrics"]["taps"], 2);
  const int ticks = document["runs"][0]["servo"]["ticks"].get<int>();
  EXPECT_GT(ticks, 1000);
  EXPECT_NE(content("results/report.html").find("How time was kept"), std::string::npos);
  const Outcome log = tactus({"export", "results/log", "--to", "mat", "--json"});
  ASSERT_EQ(log.status, 0) << log.err;
  const Json told = Json::parse(log.out);
  int topics = 0;
  int recorded = 0;
  for (const Json& topic : told["topics"]) {
    EXPECT_EQ(topic["missing"], 0) << topic;
    const std::string name = topic["topic"];
    if (name != "/tools") {
      const int messages = topic["messages"].get<int>();
      if (recorded == 0) recorded = messages;
      EXPECT_EQ(messages, recorded) << name;
    }
    ++topics;
  }
  EXPECT_LE(recorded, ticks);
  EXPECT_GE(recorded, ticks - 2) << "a tap may end in missed ticks: the sites then have nothing to do in its last";
  EXPECT_EQ(topics, 2 * (1 + 7) + 2) << "of each site one and one for each joint, /servo and /tools";
  const Outcome replayed = tactus({"replay", "results/log", "--check"});
  EXPECT_EQ(replayed.status, 0) << replayed.out << replayed.err;
  EXPECT_NE(replayed.out.find("every output is the recorded one"), std::string::npos) << replayed.out;
}

TEST_F(RealTime, WhatArmsDoNotTakeInRealTimeIsRefusedWithWhatToWriteInstead) {
  const std::string arms = std::string(TACTUS_EXPERIMENT_FOLDER) + "/arm-tapping.toml";
  const auto refusal = [&](const Words& more) {
    Words all{"run", arms, "--realtime", "--out", "results"};
    all.insert(all.end(), more.begin(), more.end());
    const Outcome outcome = tactus(all);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_FALSE(std::filesystem::exists(folder() / "results"));
    return outcome.err;
  };
  EXPECT_NE(refusal({"--plant", "bench"}).find("--plant: a plant has devices of one axis"), std::string::npos);
  EXPECT_NE(refusal({"--vary", "control.force_gain=1,2"}).find("--vary: arms in real time run one combination"),
            std::string::npos);
  EXPECT_NE(refusal({"--set", "task.taps=1001"}).find("task.taps: 1001 taps in real time are more than 1000"),
            std::string::npos);
  EXPECT_NE(refusal({"--with", std::string(TACTUS_EXPERIMENT_FOLDER) + "/arms/inverse3-arm.toml"})
                .find("control.follower.coupling: tool: run --realtime knows arms alone"),
            std::string::npos);
  EXPECT_NE(refusal({"--set", "servo.rate_Hz=9"}).find("servo.rate_Hz"), std::string::npos);
}

TEST_F(RealTime, ALogReplaysBitForBit) {
  ASSERT_EQ(tactus(run(quick_experiment(), {"--out", "results"})).status, 0);
  const Outcome replayed = tactus({"replay", "results/log", "--check", "--json"});
  EXPECT_EQ(replayed.status, 0) << replayed.out << replayed.err;
  EXPECT_EQ(Json::parse(replayed.out)["equal"], true);
  EXPECT_EQ(Json::parse(replayed.out)["taps"], 2);
  ASSERT_EQ(tactus({"run", quick_experiment(), "--out", "virtual"}).status, 0);
  const Outcome other = tactus({"replay", "virtual/log", "--check"});
  EXPECT_EQ(other.status, 2);
  EXPECT_NE(other.err.find("/sites"), std::string::npos) << other.err;
}

TEST_F(RealTime, FaultsRunAtTheRealClockAfterVirtualTime) {
  const Outcome outcome = tactus({"faults", "--realtime", "--seeds", "1", "--only", "stall", "--set",
                                  "task.real_time_seeds=6", "--priority", "10", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json document = Json::parse(outcome.out);
  const Json& rows = document["real_time"]["rows"];
  ASSERT_EQ(rows.size(), 1U);
  for (const Json& row : rows) {
    EXPECT_EQ(row["tried"], 6);
    EXPECT_GT(row["peak_force_N"], 0.1) << row["fault"];
    for (const char* never : {"not_finite_outputs", "stale_applied", "steps_above_rate_limit"}) {
      EXPECT_EQ(row[never], 0) << row["fault"] << " " << never;
    }
  }
  EXPECT_GT(document["real_time"]["servo"]["ticks"], 10000);
}

TEST_F(RealTime, AFaultThatIsNotSurvivedSaysWhetherMissedTicksLostIt) {
  // Nothing sees the frozen encoder, so runs are lost whether the clock is kept or not.
  const Outcome outcome = tactus({"faults", "--realtime", "--seeds", "1", "--only", "encoder-freeze", "--set",
                                  "task.real_time_seeds=6", "--set", "control.gate.encoder.frozen_after_s=1", "--set",
                                  "control.slave_gate.encoder.frozen_after_s=1", "--priority", "10", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json document = Json::parse(outcome.out)["real_time"];
  const Json& lost = document["lost"];
  const int survived = document["rows"][0]["survived"];
  EXPECT_EQ(static_cast<int>(lost.size()), 6 - survived);
  int lost_on_time = 0;
  for (const Json& run : lost) {
    EXPECT_EQ(run["id"], "encoder-freeze");
    EXPECT_GE(run["missed_ticks"], run["longest_gap_ticks"]);
    if (run["survives_on_time"] == true) {
      EXPECT_GT(run["missed_ticks"], 0) << run;
    } else {
      ++lost_on_time;
    }
  }
  EXPECT_GT(lost_on_time, 0);
}

TEST_F(RealTime, HowToKeepTimeIsNoQuestionInVirtualTime) {
  EXPECT_EQ(tactus({"run", quick_experiment(), "--core", "0"}).status, 2);
  const Outcome spin = tactus(run(quick_experiment(), {"--spin-s", "0.0004"}));
  EXPECT_EQ(spin.status, 2);
  EXPECT_NE(spin.err.find("spin_s"), std::string::npos) << spin.err;
}

}  // namespace
}  // namespace tactus::cli
