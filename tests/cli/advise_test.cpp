// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <vector>

#include "tests/cli/command.hpp"
#include "tests/cli/schema_validator.hpp"
#include <nlohmann/json.hpp>

namespace tactus::cli {
namespace {

using AdviseCommand = Command;
using Json = nlohmann::json;
using Words = std::vector<std::string>;

/// A quick experiment with next to nothing to choose from.
Words narrow(const std::string& file) {
  Words words{"advise", file};
  for (const char* given : {"control.command_filter.kind=none", "control.force_filter.kind=none",
                            "control.damping.damping_N_s_per_m=0", "control.hand_compensation_Hz=0"}) {
    words.insert(words.end(), {"--set", given});
  }
  return words;
}

Words operator+(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

TEST_F(AdviseCommand, TheAdviceIsASentenceFirstAndAFileThatRunLoads) {
  const Outcome outcome = tactus(narrow(quick_experiment()) + Words{"--json", "--out", "advice"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json found = Json::parse(outcome.out);
  EXPECT_EQ(SchemaValidator(Json::parse(tactus({"schema", "--results", "advise"}).out)).faults(found), "");
  Words members;
  for (const auto& [key, value] : found.items()) members.push_back(key);
  for (const char* key :
       {"advice", "set", "force_gain", "first_gain", "expected", "limited_by", "next_measurement", "alternatives"}) {
    EXPECT_TRUE(found.contains(key)) << key;
  }
  EXPECT_TRUE(found["limited_by"].contains("parameter"));
  EXPECT_TRUE(found["limited_by"].contains("unit"));
  EXPECT_EQ(found["set"]["control.force_gain"], found["force_gain"]);
  EXPECT_EQ(found["set"]["control.hand_compensation_Hz"], 0) << "what was given stays";
  for (const Json& other : found["alternatives"]) EXPECT_TRUE(other.contains("set") && other.contains("force_gain"));
  EXPECT_EQ(content("advice/results.json"), outcome.out);
  EXPECT_NE(content("advice/report.html").find(found["advice"].get<std::string>().substr(0, 20)), std::string::npos);

  const Outcome run = tactus({"run", "quick.toml", "--with", "advice/advice.toml", "--json"});
  ASSERT_EQ(run.status, 0) << run.err;
  Words set{"run", "quick.toml", "--json"};
  for (const auto& [key, value] : found["set"].items()) {
    set.insert(set.end(), {"--set", key + "=" + (value.is_string() ? value.get<std::string>() : value.dump())});
  }
  Json by_file = Json::parse(run.out), by_set = Json::parse(tactus(set).out);
  by_file.erase("command");
  by_set.erase("command");
  EXPECT_EQ(by_set, by_file) << "the file says what `set` says";

  const Outcome text = tactus(narrow("quick.toml"));
  EXPECT_TRUE(text.out.starts_with(found["advice"].get<std::string>() + "\n")) << text.out;
  EXPECT_EQ(text.err, "");
  const Outcome again = tactus(narrow("quick.toml") + Words{"--out", "advice"});
  EXPECT_EQ(again.status, 2);
  EXPECT_NE(again.err.find("--overwrite"), std::string::npos) << again.err;
}

TEST_F(AdviseCommand, OnTwoArmsItHasTheSameShape) {
  const std::string arms = std::string(TACTUS_EXPERIMENT_FOLDER) + "/arm-tapping.toml";
  // One hand, pose, direction and nothing to choose but damping in the drives, in short taps and coarse steps.
  const Words pair{arms,
                   "--with",
                   std::string(TACTUS_EXPERIMENT_FOLDER) + "/arms/bare.toml",
                   "--set",
                   "task.pose=0",
                   "--set",
                   "task.direction=down",
                   "--set",
                   "operator.hand.lever_m=0.05",
                   "--set",
                   "task.observation_s=0.25",
                   "--set",
                   "servo.plant_step_s=5e-4",
                   "--set",
                   "control.method=position-force",
                   "--set",
                   "control.force_low_pass_Hz=0",
                   "--set",
                   "control.command_low_pass_Hz=0",
                   "--set",
                   "control.damping_N_s_per_m=0",
                   "--set",
                   "control.drive_damping_limit_N_s_per_m=0",
                   "--set",
                   "control.follower.stiffness_share=1",
                   "--set",
                   "control.follower.tool_stiffness_limit_N_per_m=0",
                   "--set",
                   "control.follower.observer.dead_band_share=0"};
  const Outcome outcome = tactus(Words{"advise"} + pair + Words{"--json", "--out", "advice"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json found = Json::parse(outcome.out);
  EXPECT_EQ(SchemaValidator(Json::parse(tactus({"schema", "--results", "advise"}).out)).faults(found), "");
  EXPECT_EQ(found["set"]["control.force_gain"], found["force_gain"]);
  EXPECT_GE(found["expected"]["settled_fraction"].get<double>(), 0.95);
  EXPECT_EQ(found["expected"]["hands"].size(), 1U);
  bool file = false;
  for (const Json& other : found["alternatives"]) file = file || other["words"] == "what the file has";
  EXPECT_TRUE(file);
  EXPECT_NE(content("advice/report.html").find(found["advice"].get<std::string>().substr(0, 20)), std::string::npos);

  const Outcome run =
      tactus(Words{"run"} + pair + Words{"--set", "task.taps=4", "--with", "advice/advice.toml", "--json"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(Json::parse(run.out)["configuration"]["control"]["force_gain"], found["force_gain"]);
}

TEST_F(AdviseCommand, AWrongRequestIsAnsweredAtOnceAndLeavesNothing) {
  const std::string file = quick_experiment();
  const std::string arms = std::string(TACTUS_EXPERIMENT_FOLDER) + "/arm-tapping.toml";
  write("contest.toml", "[task]\nkind = \"contest\"\n");
  write("model.toml", "[control.model.linkage]\nstiffness_N_per_m = 9000.0\n");
  struct Wrong {
    Words words;
    const char* told;
  };
  const Words before = files();
  for (const Wrong& wrong :
       {Wrong{{"advise", "contest.toml"},
              "contest.toml:2:8: task.kind: advice is given on experiments of the kinds tapping and arm-tapping"},
        Wrong{{"advise", file, "--set", "control.cancelation=on"}, "did you mean cancellation?"},
        Wrong{{"advise", file, "--set", "control.force_gain=-1"}, "--set control.force_gain=-1"},
        Wrong{{"advise", file, "--with", "none.toml"}, "none.toml"},
        Wrong{{"advise", file, "--with", "model.toml"}, "model.toml:2:"}, Wrong{{"advise", "none.toml"}, "none.toml"},
        Wrong{{"advise", arms, "--set", "control.forcegain=1"}, "control.forcegain: unknown key"},
        Wrong{{"advise", arms, "--set", "arm.urdf=none.urdf"}, "does not exist; name a URDF file"},
        Wrong{{"advise", arms, "--set", "task.slowest_m_per_s=0.5"}, "task.fastest_m_per_s: 0.16 is less"},
        Wrong{{"advise", arms, "--set", "control.force_gain=-1"}, "--set control.force_gain=-1"},
        Wrong{{"advise", file, "--vary", "control.force_gain=1,2"}, "--vary"}, Wrong{{"advise"}, "EXPERIMENT"}}) {
    const Outcome outcome = tactus(wrong.words + Words{"--out", "advice"});
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_NE(outcome.err.find(wrong.told), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(files(), before);
}

TEST_F(AdviseCommand, ResultsOfAnotherVerbBesideAModelAreNoIntervals) {
  make_folder("found");
  write("found/model.toml", "[control.model.linkage]\nstiffness_N_per_m = 3950.0\n");
  write("found/results.json", "{\"experiment\": \"tapping\"}");
  const Outcome outcome = tactus({"advise", quick_experiment(), "--with", "found/model.toml"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("found/results.json: this is no result of tactus identify"), std::string::npos)
      << outcome.err;
}

}  // namespace
}  // namespace tactus::cli
