// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/cli/command.hpp"
#include "tests/cli/schema_validator.hpp"
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace tactus::cli {
namespace {

using Words = std::vector<std::string>;
using Json = nlohmann::json;

const std::string experiments_folder = TACTUS_EXPERIMENT_FOLDER;
const std::string examples_folder = TACTUS_EXAMPLE_FOLDER;

class Results : public Command {
 protected:
  [[nodiscard]] Json schema_of(const std::string& verb) const {
    Words words{"schema", "--results"};
    std::istringstream parts(verb);
    for (std::string part; parts >> part;) words.push_back(part);
    const Outcome outcome = tactus(words);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return Json::parse(outcome.out, nullptr, false);
  }

  /// The printed document is of the verb's schema, and begins with what made it.
  void expect_document(const std::string& verb, const Json& document) const {
    const Json schema = schema_of(verb);
    ASSERT_TRUE(schema.is_object()) << verb;
    EXPECT_EQ(SchemaValidator(schema).faults(document), "") << verb;
    for (const char* name : {"version", "command", "seed", "configuration"}) {
      EXPECT_TRUE(document.contains(name)) << verb << ": " << name;
      Json without = document;
      without.erase(name);
      EXPECT_NE(SchemaValidator(schema).faults(without), "")
          << "the schema of " << verb << " does not ask for " << name;
    }
  }

  /// Runs a verb with `--json` and checks what it prints. Returns it.
  Json expect_valid(const std::string& verb, Words arguments, int status = 0) const {
    arguments.push_back("--json");
    const Outcome outcome = tactus(arguments);
    EXPECT_EQ(outcome.status, status) << verb << ": " << outcome.err;
    Json document = Json::parse(outcome.out, nullptr, false);
    EXPECT_TRUE(document.is_object()) << verb << ": " << outcome.out.substr(0, 400);
    if (document.is_object()) expect_document(verb, document);
    return document;
  }
};

TEST_F(Results, OfARunAreOfItsSchemaWhateverItsKindAndClock) {
  const std::string quick = quick_experiment();
  const Json runs =
      expect_valid("run", {"run", quick, "--vary", "control.cancellation=on,off", "--set", "control.force_gain=10"});
  EXPECT_EQ(runs["command"],
            "tactus run quick.toml --vary control.cancellation=on,off --set control.force_gain=10 --json");
  EXPECT_EQ(runs["seed"], 1);
  EXPECT_EQ(runs["configuration"]["control"]["force_gain"], 10.0);
  EXPECT_FALSE(runs["runs"][0]["metrics"].contains("settling_time_median_s_censored"));
  EXPECT_TRUE(runs["runs"][1]["metrics"]["settling_time_median_s_censored"]);
  expect_valid("run", {"run", quick, "--set", "task.supervised=true", "--set", "control.force_gain=40", "--set",
                       "control.cancellation=off"});
  expect_valid("run", {"run", quick, "--realtime", "--priority", "10"});
  setenv("ROS_LOCALHOST_ONLY", "1", 1);
  expect_valid("run", {"run", quick, "--ros2", "--namespace", "results_" + std::to_string(getpid())});
  const Json arms = expect_valid("run", {"run", experiments_folder + "/arm-tapping.toml", "--set", "task.taps=1"});
  EXPECT_EQ(arms["runs"][0]["metrics"]["taps"], 1);
  expect_valid("run", {"run", experiments_folder + "/arm-tapping.toml", "--set", "task.taps=1", "--realtime"});
  const Json coupled = expect_valid("run", {"run", experiments_folder + "/arm-vibration.toml"});
  EXPECT_EQ(coupled["runs"][0]["metrics"]["vibrates"], 0);
  const Json arm_contest = expect_valid(
      "run", {"run", experiments_folder + "/arm-contest.toml", "--set", "task.taps=1", "--set", "task.lowest_gain=0.9",
              "--set", "task.highest_gain=1.1", "--set", "pairs.pair_2.name=''", "--set", "pairs.pair_3.name=''",
              "--set", "pairs.pair_4.name=''", "--set", "hands.hand_2.name=''"});
  EXPECT_EQ(arm_contest["results"].size(), arm_contest["methods"].size());
  EXPECT_TRUE(arm_contest["results"][0]["gain_limit_censored"]);
  for (const char* kind : {"force-display", "hydraulic-chirp", "inverse-model-chirp", "prediction-block"}) {
    expect_valid("run", {"run", experiments_folder + "/" + kind + ".toml"});
  }
  const Json map_of_gains = expect_valid("run", {"run", experiments_folder + "/contest.toml", "--set", "task.taps=1",
                                                 "--set", "task.lowest_gain=0.9", "--set", "task.highest_gain=1.1"});
  EXPECT_TRUE(map_of_gains["methods"][0]["gain_limit_censored"]);
}

TEST_F(Results, OfStabilityAreOfTheirSchemas) {
  const std::string tapping = experiments_folder + "/tapping.toml";
  for (const char* verb : {"margins", "scorecard", "two-port"}) {
    expect_valid(std::string("stability ") + verb, {"stability", verb, tapping});
  }
  expect_valid("stability limit", {"stability", "limit", tapping, "--set", "task.taps=1"});
  const Json map = expect_valid(
      "stability map", {"stability", "map", TACTUS_QUICK_MAP, "--vary", "environment.stiffness_N_per_m=1000,40000",
                        "--vary", "control.force_gain=0.01,0.02"});
  EXPECT_EQ(map["settled_limit"].size(), map["settled_limit_censored"].size());
  EXPECT_TRUE(map["settled_limit_censored"][0]) << "the largest gain of the map settles on a soft wall";
  const std::string arms = experiments_folder + "/arm-tapping.toml";
  expect_valid("stability margins", {"stability", "margins", arms});
  expect_valid("stability margins", {"stability", "margins", arms, "--set", "control.force_gain=90"});
  expect_valid("stability map", {"stability", "map", arms, "--vary", "control.method=position-force"});
}

TEST_F(Results, OfRecordingsAreOfTheirSchemas) {
  const std::string shaking = examples_folder + "/recordings/shaking-contact.csv";
  expect_valid("diagnose", {"diagnose", shaking});
  expect_valid("identify frf", {"identify", "frf", shaking, shaking, "--input", "displayed_force", "--output",
                                "master_position", "--method", "etfe", "--compare"});
  std::ostringstream table;
  table << "time_s,position_m,force_N\n";
  for (int i = 0; i < 8000; ++i) {
    constexpr double moved_mass_kg = 0.5, viscous_N_s_per_m = 1.2, amplitude_m = 0.02;
    const double t = 1e-3 * i, phase = std::numbers::pi * (t + 0.5 * t * t), w = std::numbers::pi * (1.0 + t);
    const double position_m = amplitude_m * std::sin(phase), velocity_m_per_s = amplitude_m * w * std::cos(phase);
    table << t << "," << position_m << "," << viscous_N_s_per_m * velocity_m_per_s - moved_mass_kg * w * w * position_m
          << "\n";
  }
  write("free.csv", table.str());
  expect_valid("identify inverse", {"identify", "inverse", "free.csv", "--out", "found"});
  expect_valid("estimate force", {"estimate", "force", "free.csv", "--model", "found/model.toml", "--compare",
                                  "force_N", "--out", "felt"});
  EXPECT_TRUE(
      content("felt/estimated_force.csv").starts_with("time_s,position_m,actuator_force_N,estimated_force_N\n"));
  expect_valid("identify frf", {"identify", "frf", "felt/estimated_force.csv", "--input", "actuator_force_N",
                                "--output", "estimated_force", "--method", "etfe"});
  const std::string urdf = examples_folder + "/recordings/three-joints.urdf";
  const Words columns{"--time", "time", "--position", "2:4", "--effort", "8:10"};
  const auto with_columns = [&columns](Words words) {
    words.insert(words.end(), columns.begin(), columns.end());
    return words;
  };
  expect_valid("identify arm", with_columns({"identify", "arm", examples_folder + "/recordings/arm-free-motion.csv",
                                             "--urdf", urdf, "--gravity", "0,-9.81,0", "--out", "arm"}));
  expect_valid("identify excitation", {"identify", "excitation", "--urdf", urdf, "--duration-s", "6"});
  expect_valid("estimate torque", with_columns({"estimate", "torque", examples_folder + "/recordings/arm-pushed.csv",
                                                "--model", "arm/model.toml"}));
  expect_valid("identify prediction", {"identify", "prediction", experiments_folder + "/inverse-model-chirp.toml"});
}

TEST_F(Results, OfLogsMachinesAndFaultsAreOfTheirSchemas) {
  ASSERT_EQ(tactus({"run", quick_experiment(), "--realtime", "--priority", "10", "--out", "one"}).status, 0);
  expect_valid("replay", {"replay", "one/log"});
  expect_valid("export", {"export", "one/log", "--to", "mat"});
  const Outcome doctor = tactus({"doctor", "--duration-s", "0.2", "--json"});
  expect_document("doctor", Json::parse(doctor.out, nullptr, false));
  expect_valid("faults", {"faults", "--seeds", "1", "--only", "encoder-freeze"}, 0);
  const Json of_arms =
      expect_valid("faults", {"faults", experiments_folder + "/arm-tapping.toml", "--with",
                              experiments_folder + "/arms/limits.toml", "--seeds", "1", "--only", "cut"});
  EXPECT_EQ(of_arms["rows"][0]["survived"], 1);
  expect_valid("plant", {"plant", "quick.toml", "--name", "results-test", "--duration-s", "0.2", "--priority", "10"});
  expect_valid("relay", {"relay", "quick.toml", "--master", "127.0.0.1:47101", "--for-master", "127.0.0.1:47102",
                         "--slave", "127.0.0.1:47103", "--for-slave", "127.0.0.1:47104", "--duration-s", "0.1"});
}

TEST_F(Results, ASchemaIsThereForEachVerbThatPrintsJsonAndForNoOther) {
  std::set<std::string> with_json;
  const std::function<void(Words)> visit = [&](const Words& verb) {
    Words help = verb;
    help.push_back("--help");
    const std::string text = tactus(help).out;
    std::string name;
    for (const std::string& word : verb) name += (name.empty() ? "" : " ") + word;
    if (text.find("  --json ") != std::string::npos) with_json.insert(name);
    const std::size_t below = std::min(text.find("\nRun:\n"), text.find("\nSubcommands:\n"));
    if (below == std::string::npos) return;
    std::istringstream lines(text.substr(below, text.find("\nExample:\n") - below));
    std::string line;
    while (std::getline(lines, line)) {
      if (!line.starts_with("  ") || line.size() < 3 || line[2] == ' ') continue;
      Words next = verb;
      next.push_back(line.substr(2, line.find(' ', 2) - 2));
      visit(next);
    }
  };
  visit({});
  EXPECT_GE(with_json.size(), 20U);
  for (const std::string& verb : with_json) {
    const Json schema = schema_of(verb);
    ASSERT_TRUE(schema.is_object()) << verb;
    EXPECT_EQ(schema["$schema"], "https://json-schema.org/draft/2020-12/schema") << verb;
  }
  const Outcome none = tactus({"schema", "--results", "key"});
  EXPECT_EQ(none.status, 2);
  EXPECT_NE(none.err.find("stability map"), std::string::npos) << none.err;
}

}  // namespace
}  // namespace tactus::cli
