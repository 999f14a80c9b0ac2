// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include <nlohmann/json.hpp>
#include <tests/cli/command.hpp>
#include <tests/cli/schema_validator.hpp>
#include <unistd.h>

namespace tactus::cli {
namespace rig_sites_test {

/// Two programs on the loopback, each with one side of a rig whose motors are emulated.
class RigSites : public Command {
 protected:
  RigSites() {
    const int port = 20000 + 4 * (getpid() % 10000);
    for (int i = 0; i < 4; ++i) {
      std::string name = std::to_string(i);
      name.insert(name.begin(), 'P');
      setenv(name.c_str(), std::to_string(port + i).c_str(), 1);
    }
    setenv("TACTUS", TACTUS_COMMAND, 1);
    setenv("JOINTS", TACTUS_EXAMPLE_FOLDER "/rigs/joints.toml", 1);
  }

  /// Runs a script in the folder. `rig SIDE PORT [JOINT...]` writes a rig file of that side alone; `site NAME MORE...`
  /// is a program in JSON; `end_both` ends them with Ctrl-C and says how they end.
  [[nodiscard]] int shell(const std::string& script) {
    std::ofstream(folder() / "script") << R"sh(
      set -u
      rig() {
        side=$1; shift
        { echo "[arm.$side]"; echo 'bus = "damiao"'; echo "port = \"$1\""; echo 'reply_timeout_s = 0.05'; echo 'watchdog_s = 1.0'
          shift; motor=0
          for joint in "$@"; do
            motor=$((motor + 1))
            echo "[arm.$side.$joint]"; echo "motor = $motor"; echo 'model = "DM4310"'; echo 'lower_rad = -3.0'
            echo 'upper_rad = 3.0'; echo 'velocity_limit_rad_per_s = 8.0'; echo 'torque_limit_Nm = 1.5'
            echo 'torque_rate_limit_Nm_per_s = 500.0'; [ $side = leader ] && echo "offset_rad = $OFFSET"
          done; } >$side.toml
      }
      site() { name=$1; shift; exec $TACTUS run $JOINTS --set control.supervision.longest_stall_s=0.5 \
                 --set control.supervision.watchdog.timeout_s=0.5 --set control.supervision.overload.missed_share=0.9 \
                 --key key --json "$@" >$name.json 2>$name.log <&9; }
      master() { site master --site master --device leader.toml --listen 127.0.0.1:$P0 "$@"; }
      slave() { site slave --site slave --device follower.toml --listen 127.0.0.1:$P2 "$@"; }
      end_both() { kill -INT $master $slave; wait $master; echo status $?; wait $slave; echo status $?; }
      wait_for() { for i in $(seq 300); do grep -q "$2" $1.log 2>/dev/null && return; sleep 0.1; done
                   cat $1.log; exit 3; }
      cd ')sh" + folder().string() + R"sh('
      OFFSET=0.2
      [ -e key ] || $TACTUS key key >/dev/null || exit 2
      rm -f said1 said2 person; mkfifo said1 said2 person
      # Somebody is there as long as this shell, who says nothing.
      exec 9<>person
      $TACTUS emulate damiao --motors 3 >said1 2>emulate.err </dev/null & peers=$!
      $TACTUS emulate damiao --motors 3 >said2 2>emulate.err </dev/null & peers="$peers $!"
      master= slave= relay=
      trap 'kill -KILL $peers $master $slave $relay 2>/dev/null' EXIT
      read -r at_leader <said1; read -r at_follower <said2
    )sh" << script;
    return std::system(
        ("sh '" + (folder() / "script").string() + "' >'" + (folder() / "out").string() + "' 2>&1").c_str());
  }
  [[nodiscard]] nlohmann::json result(const std::string& name) const {
    auto document = nlohmann::json::parse(content(name + ".json"), nullptr, false);
    EXPECT_TRUE(document.is_object()) << name << ": " << content(name + ".json") << all();
    return document.is_object() ? document : nlohmann::json{{"seconds", nlohmann::json::array()}};
  }
  [[nodiscard]] std::string all() const { return content("out") + content("master.log") + content("slave.log"); }
};

TEST_F(RigSites, TheFollowerGoesToItsLeaderAndBothHoldWhereTheLinkIsCut) {
  const int status = shell(R"sh(
    rig leader $at_leader one two three; rig follower $at_follower one two three
    $TACTUS relay $JOINTS --master 127.0.0.1:$P0 --for-master 127.0.0.1:$P1 --slave 127.0.0.1:$P2 \
      --for-slave 127.0.0.1:$P3 --json >relay.json 2>relay.err & relay=$!
    slave --peer 127.0.0.1:$P3 --out follower & slave=$!
    master --peer 127.0.0.1:$P1 --arm --out leader & master=$!
    wait_for master 'leader active, follower active'
    wait_for slave 'leader active, follower active'
    sleep 3
    kill -INT $relay
    wait_for master 'leader hold, .*(timed-out)'
    wait_for slave 'follower hold (timed-out)'
    end_both
  )sh");
  EXPECT_EQ(status, 0) << all();
  EXPECT_EQ(content("out").find("status 0\nstatus 0\n"), 0U) << all();
  const nlohmann::json schema_document = nlohmann::json::parse(tactus({"schema", "--results", "run"}).out);
  const SchemaValidator schema(schema_document);
  for (const char* name : {"master", "slave"}) {
    const auto found = result(name);
    EXPECT_EQ(schema.faults(found), "") << name;
    EXPECT_EQ(found["site"], name);
    EXPECT_EQ(found["armings"], 1) << all();
    EXPECT_EQ(found["holds"], 1) << all();
    EXPECT_GT(found["active_ticks"], 500) << all();
    EXPECT_EQ(found["stale_applied"], 0);
    EXPECT_EQ(found["log_dropped"], 0);
    EXPECT_GT(found["link"]["authentic"], 1000);
    // It stood 0.2 rad away; what is left holds against the friction of the joint, less than 0.02 rad at 4 N m/rad.
    double apart = 1.0;
    for (const auto& second : found["seconds"]) {
      if (second["leader"] == "active" && second["follower"] == "active") apart = second["farthest"];
    }
    EXPECT_LT(apart, 0.02) << all();
  }
  // Each host has the log of its own side.
  for (const auto& [log, topic] : {std::pair{"leader", "/master/joint_3"}, std::pair{"follower", "/slave/joint_3"}}) {
    const auto told = tactus({"export", std::string(log) + "/log", "--to", "mat", "--json"});
    EXPECT_EQ(told.status, 0) << told.err;
    EXPECT_NE(told.out.find(topic), std::string::npos) << told.out;
    const char* other = topic[1] == 'm' ? "/slave/site" : "/master/site";
    EXPECT_EQ(told.out.find(other), std::string::npos) << told.out;
    const auto replayed = tactus({"replay", std::string(log) + "/log", "--check"});
    EXPECT_EQ(replayed.status, 0) << replayed.out << replayed.err;
    EXPECT_NE(replayed.out.find(topic[1] == 'm'
                                    ? "control cycles of the master of 3 joints: every output is the recorded one"
                                    : "control cycles of the slave of 3 joints: every output is the recorded one"),
              std::string::npos)
        << replayed.out;
  }
}

TEST_F(RigSites, ThatAreTooFarApartGetNoPowerAndBothSayWhichJointToMove) {
  EXPECT_EQ(shell(R"sh(
    OFFSET=0.5
    rig leader $at_leader one two three; rig follower $at_follower one two three
    slave --peer 127.0.0.1:$P0 & slave=$!
    master --peer 127.0.0.1:$P2 --arm & master=$!
    wait_for master 'too far apart to arm: move arm.leader.one by 0.50 rad to where its follower is'
    wait_for slave 'too far apart to arm: move arm.leader.one by 0.50 rad to where its follower is'
    end_both
  )sh"),
            0)
      << all();
  for (const char* name : {"master", "slave"}) {
    const auto told = result(name);
    EXPECT_EQ(told["armings"], 0) << all();
    for (const auto& second : told["seconds"]) {
      EXPECT_EQ(second["leader"], "configure");
      EXPECT_EQ(second["follower"], "configure");
      EXPECT_EQ(second["most_torque"], 0.0);
    }
  }
}

TEST_F(RigSites, OfOtherJointsAreNeverArmedAndBothSayInWhat) {
  EXPECT_EQ(shell(R"sh(
    rig leader $at_leader one two three; rig follower $at_follower one three two
    slave --peer 127.0.0.1:$P0 & slave=$!
    master --peer 127.0.0.1:$P2 --arm & master=$!
    wait_for master 'not armed, for joint 2 of the rig is two in rad here and three in rad at the slave: start both'
    wait_for slave 'not armed, for joint 2 of the rig is three in rad here and two in rad at the master: start both'
    sleep 2
    end_both
    cat master.json >master_of_others.json
    rig follower $at_follower one two
    slave --peer 127.0.0.1:$P0 & slave=$!
    master --peer 127.0.0.1:$P2 --arm & master=$!
    wait_for master 'the slave has 2 joints, and this site another number'
    wait_for slave 'the master has 3 joints, and this site another number'
    end_both
  )sh"),
            0)
      << all();
  for (const char* name : {"master_of_others", "master", "slave"}) {
    const auto told = result(name);
    EXPECT_EQ(told["armings"], 0) << all();
    for (const auto& second : told["seconds"]) EXPECT_EQ(second["most_torque"], 0.0) << name;
  }
}

/// Arms with their weight behind the motors, held at first 0.15 rad apart.
TEST_F(RigSites, TwoArmsCarryThemselvesAndTheFollowerGoesToItsLeader) {
  setenv("EXPERIMENTS", TACTUS_EXPERIMENT_FOLDER, 1);
  const int status = shell(R"sh(
    kill -KILL $peers; rigs=$(dirname $JOINTS); JOINTS=$rigs/arms.toml
    arm() { exec $TACTUS emulate damiao --motors 8 --arm $EXPERIMENTS/arms/openarm-class.urdf \
              --armature 0.0167,0.0167,0.029,0.029,0.0018 --model DM8009,DM8009,DM4340,DM4340,DM4310 \
              --held 0.2,-1.77,0.15,$1,0.2,0.1,0.2 2>emulate.err </dev/null; }
    arm 1.55 >said1 & peers=$!
    arm 1.4 >said2 & peers="$peers $!"
    read -r at_leader <said1; read -r at_follower <said2
    sed "s|/dev/serial/by-id/LEADER|$at_leader|; s|/dev/serial/by-id/FOLLOWER|$at_follower|
         s|^framing.*|reply_timeout_s = 0.05\nwatchdog_s = 1.0|" $rigs/openarm-arms.toml >leader.toml
    cp leader.toml follower.toml
    site() { name=$1; shift; exec $TACTUS run $JOINTS --set rig.supervision.longest_stall_s=0.5 \
               --set rig.supervision.watchdog.timeout_s=0.5 --set rig.supervision.overload.missed_share=0.9 \
               --key key --json "$@" >$name.json 2>$name.log <&9; }
    slave --peer 127.0.0.1:$P0 & slave=$!
    master --peer 127.0.0.1:$P2 --arm & master=$!
    wait_for master 'leader active, follower active'
    sleep 3
    kill -INT $master
    # What its leader does then, an arm that falls, is not the follower's affair.
    wait_for slave 'follower hold (peer)'
    kill -INT $slave
    wait $master; echo status $?
    wait $slave; echo status $?
  )sh");
  EXPECT_EQ(status, 0) << all();
  for (const char* name : {"master", "slave"}) {
    const auto found = result(name);
    EXPECT_EQ(found["armings"], 1) << all();
    EXPECT_EQ(found["not_responding_ticks"], 0) << all();
    EXPECT_EQ(found["joints"].size(), 8U);
    double apart = 1.0;
    for (const auto& second : found["seconds"]) {
      if (second["leader"] == "active" && second["follower"] == "active") apart = second["farthest"];
    }
    EXPECT_LT(apart, 0.06) << all();
  }
}

TEST_F(RigSites, WhatMakesNoSenseIsRefusedWithTheRemedy) {
  EXPECT_EQ(shell("rig leader /dev/null one; rig follower /dev/null one; true\n"), 0) << all();
  const auto refusal = [this](std::vector<std::string> more) {
    std::vector<std::string> words{
        "run", TACTUS_EXAMPLE_FOLDER "/rigs/joints.toml", "--site", "master", "--device", "leader.toml"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = tactus(words);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    return outcome.err;
  };
  EXPECT_NE(refusal({}).find("--peer: name the other site: HOST:PORT"), std::string::npos);
  const std::vector<std::string> peer{"--peer", "127.0.0.1:7300", "--unencrypted"};
  const auto with = [&peer](std::vector<std::string> more) {
    more.insert(more.end(), peer.begin(), peer.end());
    return more;
  };
  EXPECT_NE(refusal(with({"--device", "follower.toml"})).find("name it alone"), std::string::npos);
  const std::string silent = refusal(with({"--set", "control.architecture=position-force"}));
  EXPECT_NE(silent.find("control.architecture: a follower of position-force does not send its position"),
            std::string::npos)
      << silent;
  const Outcome other = tactus({"run", TACTUS_EXAMPLE_FOLDER "/rigs/joints.toml", "--site", "slave", "--device",
                                "leader.toml", "--peer", "127.0.0.1:7300", "--unencrypted"});
  EXPECT_EQ(other.status, 2);
  EXPECT_NE(other.err.find("arm: there is no follower, which the slave drives"), std::string::npos) << other.err;
}

}  // namespace rig_sites_test
}  // namespace tactus::cli
