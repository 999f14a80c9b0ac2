// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <string>

#include "tests/cli/command.hpp"
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace tactus::cli {
namespace plant_test {

using Json = nlohmann::json;

/// Both programs, started and stopped by a shell. A slow servo and long silences, so that sanitizers and a loaded
/// machine keep up.
class Plant : public Command {
 protected:
  Plant() { setenv("NAME", name.c_str(), 1); }

  /// Runs a script in the folder, with functions that start the programs.
  void shell(const std::string& script) {
    write("script", R"(
      slow="--set servo.rate_Hz=1000 --set plant.longest_step_s=5e-5 --set task.taps=2 --priority 10"
      plant() { exec $TACTUS plant quick.toml $slow --name $NAME --silence-s 5 "$@" >plant.out 2>plant.log </dev/null; }
      drive() { $TACTUS run quick.toml $slow --realtime --plant $NAME --plant-silence-s ${silence-5} "$@"; }
      trap 'kill -KILL $(jobs -p) 2>/dev/null' EXIT
      wait_for() { for i in $(seq 300); do grep -q "$2" $1 2>/dev/null && return; sleep 0.1; done; exit 3; }
      )" + script);
    setenv("TACTUS", TACTUS_COMMAND, 1);
    ASSERT_EQ(std::system(("cd '" + folder().string() + "' && sh script").c_str()), 0)
        << content("plant.out") << content("plant.log") << content("run.log");
  }

  const std::string name = "test-cli-" + std::to_string(getpid());
};

TEST_F(Plant, IsDrivenByARunInAnotherProcessWhoseLogReplays) {
  quick_experiment();
  shell(R"(
    plant --json & plant=$!
    wait_for plant.log "Plant '$NAME'"
    drive --json --out results >run.json 2>run.log || exit 4
    drive --set control.force_gain=1.5 >run.out 2>run.log || exit 5
    wait_for plant.log ' s: '
    kill -INT $plant
    wait $plant || exit 6
  )");
  const Json run = Json::parse(content("run.json")), plant = Json::parse(content("plant.out"));
  EXPECT_EQ(run["plant"], name);
  EXPECT_EQ(run["clock"], "real");
  EXPECT_EQ(run["runs"][0]["metrics"]["taps"], 2);
  EXPECT_GT(run["runs"][0]["metrics"]["peak_force_N"], 0.05) << "what no sensor tells came too";
  EXPECT_EQ(plant["name"], name);
  EXPECT_EQ(plant["taps"], 4);
  EXPECT_EQ(plant["released"], 0);
  EXPECT_GE(plant["commands"], run["runs"][0]["servo"]["ticks"].get<int>() - 2);
  EXPECT_GT(plant["readings"], 1000);
  const Outcome replayed = tactus({"replay", "results/log", "--check", "--json"});
  EXPECT_EQ(replayed.status, 0) << replayed.out << replayed.err;
  EXPECT_EQ(Json::parse(replayed.out)["taps"], 2);
  const Outcome gone = tactus({"run", "quick.toml", "--realtime", "--plant", name});
  EXPECT_EQ(gone.status, 2) << "a plant that was stopped leaves nothing";
  EXPECT_NE(gone.err.find("tactus plant EXPERIMENT --name " + name), std::string::npos) << gone.err;
}

TEST_F(Plant, ThatIsKilledEndsTheRunAndIsReplacedByTheNext) {
  quick_experiment();
  shell(R"(
    plant --set task.observation_s=9 & plant=$!
    wait_for plant.out "Plant '$NAME'"
    ( silence=2; drive --set task.observation_s=9 --out results >run.out 2>run.log; echo $? >run.status ) &
    wait_for plant.out 'driven by process'
    drive >second.out 2>second.log; echo $? >second.status
    kill -KILL $plant
    wait_for run.status .
    drive >dead.out 2>dead.log; echo $? >dead.status
    plant --duration-s 1.1 &
    wait_for plant.out "Plant '$NAME'"
    wait
  )");
  EXPECT_EQ(content("run.status"), "1\n");
  EXPECT_NE(content("run.log").find("died"), std::string::npos) << content("run.log");
  EXPECT_EQ(content("second.status"), "2\n");
  EXPECT_NE(content("second.log").find("is driven already (process "), std::string::npos) << content("second.log");
  EXPECT_EQ(content("dead.status"), "2\n");
  EXPECT_NE(content("dead.log").find("is dead (process "), std::string::npos) << content("dead.log");
  EXPECT_NE(content("plant.out").find("control cycles missed"), std::string::npos) << content("plant.out");
  EXPECT_EQ(tactus({"replay", "results/log", "--check"}).status, 0) << "the log shows how it ended";
}

TEST_F(Plant, WrongUseIsRefusedByTheOption) {
  quick_experiment();
  const auto expect_refused = [&](const std::vector<std::string>& words, const char* word) {
    const Outcome outcome = tactus(words);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_NE(outcome.err.find(word), std::string::npos) << outcome.err;
  };
  expect_refused({"run", "quick.toml", "--plant", name}, "--plant: a plant runs at the real clock: add --realtime");
  expect_refused({"run", "quick.toml", "--realtime", "--plant-silence-s", "1"}, "--plant-silence-s requires --plant");
  expect_refused({"run", "quick.toml", "--realtime", "--plant", "a/b"}, "--plant: 'a/b' is no name");
  expect_refused({"run", "quick.toml", "--realtime", "--plant", name, "--plant-silence-s", "20"},
                 "--plant-silence-s: 20 s is out of bounds");
  expect_refused({"plant", "quick.toml", "--name", ""}, "--name: '' is no name");
  expect_refused({"plant", "quick.toml", "--name", name, "--silence-s", "0"}, "--silence-s: 0 s is out of bounds");
  expect_refused({"plant", "quick.toml", "--name", name, "--duration-s", "-1"}, "--duration-s: -1 s is out of bounds");
  expect_refused({"plant", "quick.toml", "--set", "master.motor_mass=3"}, "master.motor_mass");
  expect_refused({"plant", "nothing.toml"}, "nothing.toml");
  const std::string contest = std::string(TACTUS_EXPERIMENT_FOLDER) + "/contest.toml";
  expect_refused({"plant", contest, "--name", name}, "contest");
}

}  // namespace plant_test
}  // namespace tactus::cli
