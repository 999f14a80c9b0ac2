// SPDX-License-Identifier: Apache-2.0
#include "tests/cli/rig_run.hpp"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>

namespace tactus::cli {
namespace rig_run_test {

TEST_F(RigRun, APairOfSevenJointsAlignsAndTeleoperatesWithALogThatIsWhole) {
  // It stands 0.2 rad away; what is left holds against the friction of the joint, less than 0.02 rad at 4 N m/rad.
  const auto follows = [](const std::string& said) { return apart(said, "5") < 0.02; };
  const std::string said =
      shell_until({"; armed 1 times, held 0 times, ", ", not responding in 0, lost in 0 cycles; "}, "damiao --motors 7",
                  "damiao --motors 7", pair("damiao", "DM4310", 7, "offset_rad = 0.2\n"),
                  "$RUN --arm --duration-s 6 --out run --overwrite <&9; echo status $?\n"
                  "$TACTUS replay run/log --check; echo replayed $?",
                  follows);
  EXPECT_NE(said.find("; armed 1 times, held 0 times, a device late in "), std::string::npos) << said;
  EXPECT_NE(said.find(", not responding in 0, lost in 0 cycles; "), std::string::npos) << said;
  EXPECT_NE(said.find("5 s: leader active, follower active (none), "), std::string::npos) << said;
  EXPECT_NE(said.find("\n0 records of the log dropped.\nReport: run/report.html\nLog: run/log\n"), std::string::npos)
      << said;
  EXPECT_NE(said.find("status 0\n"), std::string::npos) << said;
  EXPECT_NE(
      said.find(
          " control cycles of both sites of 7 joints: every output is the recorded one, bit for bit.\nreplayed 0\n"),
      std::string::npos)
      << said;
  EXPECT_PRED1(follows, said);
}

/// Three episodes, of which the operator discards the second; then the log is a data set, and a recording, as it lies
/// there.
TEST_F(RigRun, EpisodesAreExportedAsWideTablesWithNamesUnitsAndWallClockTimes) {
  const std::string said =
      shell_until({" episodes: number ", "left out: discarded", "diagnosed 0\n"}, "damiao --motors 2",
                  "damiao --motors 2", pair("damiao", "DM4310", 2, "offset_rad = 0.1\n"), R"sh(
    rm -rf run wide
    date +%s >before
    $RUN --arm --out run --overwrite <&9 >run.out 2>&1 & run=$!
    last() { tail -n 1 run.out; }
    until_it_says() { for try in $(seq 100); do last | grep -q "$1" && break; sleep 0.1; done; }
    until_it_says 'follower active'
    sleep 1; echo release >&9
    until_it_says 'follower armed'
    echo arm >&9
    until_it_says 'follower active'
    sleep 1; echo discard >&9; sleep 0.3; echo start >&9
    sleep 1.5
    kill -INT $run; wait $run
    date +%s >after
    tail -n 20 run.out
    $TACTUS export run/log --wide --rate 50 --out wide; echo exported $?
    $TACTUS export run/log --to mat --out run/log.mat; echo exported $?
    $TACTUS diagnose run/log; echo diagnosed $?)sh");
  EXPECT_NE(said.find("left out: discarded"), std::string::npos) << said;
  EXPECT_NE(said.find("exported 0\n"), std::string::npos) << said;
  EXPECT_NE(said.find("diagnosed 0\n"), std::string::npos) << said;
  EXPECT_NE(said.find(" episodes: number "), std::string::npos) << said;
  EXPECT_EQ(content("wide/episode_2.csv"), "");
  for (const char* name : {"wide/episode_1.csv", "wide/episode_3.csv"}) {
    const std::string table = content(name);
    EXPECT_TRUE(
        table.starts_with("time_s,wall_time_s,leader.joint_1.position_rad,leader.joint_2.position_rad,"
                          "leader.joint_1.velocity_rad_per_s,leader.joint_2.velocity_rad_per_s,"
                          "leader.joint_1.torque_Nm,"))
        << table.substr(0, 400);
    EXPECT_NE(table.find(",follower.joint_2.position_rad,"), std::string::npos);
    EXPECT_NE(table.find(",active,none,active,none\n"), std::string::npos);
    const auto first = table.find('\n') + 1;
    EXPECT_EQ(std::atof(table.c_str() + first), 0.0);
    const double wall_s = std::atof(table.c_str() + table.find(',', first) + 1);
    EXPECT_GE(wall_s, std::atof(content("before").c_str())) << name;
    EXPECT_LE(wall_s, std::atof(content("after").c_str())) << name;
  }
}

/// A trigger that turns half as far as the gripper. As a joint it has a quarter of its motor's inertia, which the first
/// trial of its sign, the weakest one, must not make faster than it may be.
TEST_F(RigRun, AGripperGoesAsFarAsItsTriggerTimesTheScale) {
  const std::string rig = side("leader", "@1", "damiao", "DM4310", 1, "offset_rad = 0.2\ngear = 0.5\n") +
                          side("follower", "@2", "damiao", "DM4310", 1, "");
  // What the motors say, without any file. Friction leaves them less than 0.03 rad apart; without the scale it were
  // more, for the trigger is more than 0.05 rad from zero.
  const auto scaled = [](const std::string& said) {
    const std::string key = "\"position_rad\": ";
    const auto first = said.find(key), second = said.rfind(key);
    if (first == second) return false;
    const double trigger_rad = std::atof(said.c_str() + first + key.size()),
                 gripper_rad = std::atof(said.c_str() + second + key.size());
    return std::fabs(trigger_rad) > 0.05 && std::fabs(gripper_rad - (trigger_rad / 0.5 + 0.2)) < 0.03;
  };
  const std::string said =
      shell_until({"5 s: leader active, follower active (none), "}, "damiao --motors 1", "damiao --motors 1", rig, R"sh(
    $RUN --arm --duration-s 6 <&9
    for port in $leader $follower; do
      $TACTUS device check --bus damiao --port $port --motors 1:DM4310 --json | grep position_rad
    done)sh",
                  scaled);
  EXPECT_PRED1(scaled, said);
}

TEST_F(RigRun, ALeaderWithoutForceIsFollowed) {
  const std::string rig = side("leader", "@1", "feetech", "sts3215", 2, "offset_rad = 0.2\n") +
                          side("follower", "@2", "damiao", "DM4310", 2, "");
  const std::string said = shell_until({"4 s: leader active, follower active (none), "}, "feetech", "damiao", rig,
                                       "$RUN --arm --duration-s 5 <&9; echo status $?");
  EXPECT_NE(said.find("4 s: leader active, follower active (none), "), std::string::npos) << said;
  EXPECT_LT(apart(said, "4"), 0.02) << said;
  EXPECT_NE(said.find("armed 1 times"), std::string::npos) << said;
}

TEST_F(RigRun, ArmsThatAreTooFarApartAreNotArmedAndWhatToDoIsSaid) {
  const std::string said = shell("damiao", "damiao", pair("damiao", "DM4310", 2, "offset_rad = 0.5\n"),
                                 "$RUN --arm --duration-s 2 <&9; echo status $?");
  EXPECT_NE(said.find("leader configure, follower configure (started), most torque 0.00, farthest apart 0.500"),
            std::string::npos)
      << said;
  EXPECT_NE(said.find("; too far apart to arm: move arm.leader.joint_1 by 0.50 rad to where its follower is\n"),
            std::string::npos)
      << said;
  EXPECT_NE(said.find("armed 0 times"), std::string::npos) << said;
}

TEST_F(RigRun, AMotorThatFallsSilentHoldsBothWithoutForceAndIsSaid) {
  const std::string said =
      shell_until({"follower active"}, "damiao", "damiao --fault silence:2@4", pair("damiao", "DM4310", 2, ""),
                  "$RUN --arm --duration-s 6 --out run --overwrite <&9; echo status $?\n"
                  "$TACTUS replay run/log --check; echo replayed $?");
  EXPECT_NE(said.find("follower active"), std::string::npos) << said;
  EXPECT_NE(said.find("bit for bit.\nreplayed 0\n"), std::string::npos) << said;
  EXPECT_NE(said.find("leader hold, follower hold (device), "), std::string::npos) << said;
  EXPECT_NE(said.find("; follower: joint_2 not responding for "), std::string::npos) << said;
  EXPECT_NE(said.find("; the follower is not responding: look at 'tactus device check'\n"), std::string::npos) << said;
  EXPECT_EQ(said.find("not responding in 0,"), std::string::npos) << said;
  // Nobody knows whether it is off: its last status was another.
  EXPECT_NE(said.find("tactus: arm.follower.joint_2: motor 2 at "), std::string::npos) << said;
  EXPECT_NE(said.find(" (damiao) did not report within 0.5 s that it is off (status 0x1 (enabled)): switch off the "
                      "supply of arm.follower, and keep clear of it until then\n"),
            std::string::npos)
      << said;
  EXPECT_NE(said.find("status 1\n"), std::string::npos) << said;
}

TEST_F(RigRun, AStatusThatIsNotKnownEndsTheForceOfBothAndTheMotorIsToldAtTheEnd) {
  const std::string said =
      shell_until({"follower active"}, "damiao", "damiao --fault status=0x7:2@4", pair("damiao", "DM4310", 2, ""),
                  "$RUN --arm --duration-s 6 <&9; echo status $?");
  EXPECT_NE(said.find("follower active"), std::string::npos) << said;
  EXPECT_NE(said.find("leader hold, follower fault (gate), "), std::string::npos) << said;
  EXPECT_NE(said.find("; follower: joint_2 has the fault "), std::string::npos) << said;
  EXPECT_NE(said.find(" (status 0x7 (unknown))"), std::string::npos) << said;
  EXPECT_NE(said.find("tactus: arm.follower.joint_2: motor 2 at "), std::string::npos) << said;
  EXPECT_NE(said.find("tactus: a motor did not report that it is off: switch off its supply\n"), std::string::npos)
      << said;
}

TEST_F(RigRun, AMotorThatIgnoresDisableIsToldWhenTheRunIsInterrupted) {
  const std::string said = shell_until({"follower active"}, "damiao", "damiao --fault ignores-disable:2",
                                       pair("damiao", "DM4310", 2, ""), R"sh(
      $RUN --arm <&9 >run.out 2>&1 & run=$!
      for try in $(seq 100); do grep -q 'follower active' run.out && break; sleep 0.1; done
      kill -INT $run
      wait $run; echo status $?
      cat run.out)sh");
  EXPECT_NE(said.find("follower active"), std::string::npos) << said;
  EXPECT_NE(said.find("tactus: arm.follower.joint_2: motor 2 at "), std::string::npos) << said;
  EXPECT_EQ(said.find("tactus: arm.follower.joint_1: "), std::string::npos) << said;
  EXPECT_EQ(said.find("tactus: arm.leader"), std::string::npos) << said;
  EXPECT_NE(said.find("status 1\n"), std::string::npos) << said;
}

TEST_F(RigRun, ServosOfBothMakesThatIgnoreItAreToldWhenTheRunIsInterrupted) {
  std::string rig = side("leader", "@1", "dynamixel", "xl330-m288", 2, "") +
                    side("follower", "@2", "feetech", "hls3625", 2, "torque_Nm_per_A = 0.8\n");
  const std::string limit = "torque_limit_Nm = 1.5";
  for (auto at = rig.find(limit); at != std::string::npos; at = rig.find(limit, at)) {
    rig.replace(at, limit.size(), "torque_limit_Nm = 0.3");
  }
  const std::string said = shell_until({"follower active"}, "dynamixel --fault ignores-disable:2",
                                       "feetech --model hls3625 --fault ignores-disable:2", rig, R"sh(
      $RUN --arm --set control.supervision.probe.force_N=0.2 --set control.supervision.probe.duration_s=0.35 <&9 >run.out 2>&1 & run=$!
      for try in $(seq 100); do grep -q 'follower active' run.out && break; sleep 0.1; done
      kill -INT $run
      wait $run; echo status $?
      cat run.out)sh");
  EXPECT_NE(said.find("follower active"), std::string::npos) << said;
  for (const char* told : {"tactus: arm.leader.joint_2: motor 2 at ", " (dynamixel) ",
                           "tactus: arm.follower.joint_2: motor 2 at ", " (feetech) ", "torque enable 1)"}) {
    EXPECT_NE(said.find(told), std::string::npos) << told << said;
  }
  EXPECT_EQ(said.find(".joint_1: motor 1 at "), std::string::npos) << said;
  EXPECT_NE(said.find("status 1\n"), std::string::npos) << said;
}

TEST_F(RigRun, AHandleWhoseForceGoesOnWithoutCommandsIsToldWhenTheRunIsInterrupted) {
  const std::filesystem::path rigs = TACTUS_EXAMPLE_FOLDER "/rigs";
  setenv("RIGS", rigs.c_str(), 1);
  const std::string said = shell_until({"follower active"}, "inverse3 --port 0 --keeps-force", "damiao --motors 3", "",
                                       R"sh(
      sed "s|127.0.0.1:10001|${leader#ws://}|; s|/dev/serial/by-id/FOLLOWER|$follower|
           s|^bus = \"damiao\"|&\nreply_timeout_s = 0.05\nwatchdog_s = 1.0|" $RIGS/inverse3.toml >rig.toml
      $TACTUS run $RIGS/axes.toml --realtime --device rig.toml --arm <&9 >run.out 2>&1 & run=$!
      for try in $(seq 100); do grep -q 'follower active' run.out && break; sleep 0.1; done
      kill -INT $run
      wait $run; echo status $?
      cat run.out)sh");
  EXPECT_NE(said.find("follower active"), std::string::npos) << said;
  for (const char* axis : {"x: motor 1 at ", "y: motor 2 at ", "z: motor 3 at "}) {
    EXPECT_NE(said.find(std::string("tactus: desk.leader.") + axis), std::string::npos) << axis << said;
  }
  EXPECT_EQ(said.find("tactus: desk.follower"), std::string::npos) << said;
  EXPECT_NE(said.find("status 1\n"), std::string::npos) << said;
}

TEST_F(RigRun, AMotorWithAFaultEndsTheForceOfBothAndIsSaid) {
  const std::string said =
      shell_until({"follower active"}, "damiao", "damiao --fault hot-drive:2@4", pair("damiao", "DM4310", 2, ""),
                  "$RUN --arm --duration-s 6 <&9; echo status $?");
  EXPECT_NE(said.find("follower active"), std::string::npos) << said;
  EXPECT_NE(said.find("leader hold, follower fault (gate), "), std::string::npos) << said;
  EXPECT_NE(said.find("; follower: joint_2 has the fault hot"), std::string::npos) << said;
  EXPECT_NE(said.find("\nEnded in a fault: follower (gate); follower: joint_2 has the fault hot"), std::string::npos)
      << said;
  EXPECT_NE(said.find("\ntactus: the run ended in a fault: follower (gate); follower: joint_2 has the fault hot"),
            std::string::npos)
      << said;
  EXPECT_NE(said.find("status 1\n"), std::string::npos) << said;
}

TEST_F(RigRun, NothingIsDrivenBeforeTheRigIsClean) {
  const std::string said = shell("damiao", "damiao --fault hot-drive:1", pair("damiao", "DM4310", 2, ""),
                                 "$RUN --arm --duration-s 6 <&9; echo status $?");
  EXPECT_NE(said.find("arm.follower.joint_1.motor: motor 1: too hot: "), std::string::npos) << said;
  EXPECT_NE(
      said.find("tactus: rig.toml: it is not clean, so nothing was driven: fix what 'tactus device check' reports"),
      std::string::npos)
      << said;
  EXPECT_NE(said.find("status 1\n"), std::string::npos) << said;
}

TEST_F(RigRun, AnArmThatTheRigDoesNotFitIsRefusedBeforeAnythingIsOpened) {
  const auto file = std::filesystem::path(TACTUS_EXAMPLE_FOLDER "/rigs/arms.toml");
  write("rig.toml", pair("damiao", "DM4310", 7, ""));
  const auto said = tactus({"run", file.string(), "--realtime", "--device", "rig.toml"});
  EXPECT_EQ(said.status, 2);
  EXPECT_NE(said.err.find("arm.leader.joint_1.damping_limit_Nms_per_rad: 0 N m s/rad is less than the 5 N m s/rad that "
                          "the experiment asks of its motor's own law"),
            std::string::npos)
      << said.err;
  const auto other = tactus({"run", TACTUS_EXPERIMENT_FOLDER "/contest.toml", "--realtime", "--device", "rig.toml"});
  EXPECT_NE(other.err.find("only an experiment of the kind tapping or arm-tapping drives a rig"), std::string::npos)
      << other.err;
}

TEST_F(RigRun, WhatMakesNoSenseIsRefusedWithTheRemedy) {
  const auto refusal = [this](const std::string& rig, const std::vector<std::string>& more) {
    write("rig.toml", rig);
    std::vector<std::string> words{"run", TACTUS_EXAMPLE_FOLDER "/rigs/joints.toml", "--realtime", "--device",
                                   "rig.toml"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = tactus(words);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    return outcome.err;
  };
  const std::string rig = pair("damiao", "DM4310", 1, "");
  EXPECT_NE(refusal(rig, {"--device", "slave=other"}).find("--device: a rig has the devices of both sites"),
            std::string::npos);
  std::string second = rig;
  for (auto at = second.find("[arm."); at != std::string::npos; at = second.find("[arm.", at))
    second.replace(at, 5, "[leg.");
  second.replace(second.find("@1"), 2, "@3");
  second.replace(second.find("@2"), 2, "@4");
  EXPECT_NE(refusal(rig + second, {}).find("--device: the rig has two pairs: name one, as rig.toml:arm"),
            std::string::npos);
  EXPECT_NE(refusal(side("leader", "@1", "damiao", "DM4310", 1, ""), {})
                .find("arm: a leader and a follower are driven together: write the other one too"),
            std::string::npos);
  EXPECT_NE(refusal(pair("feetech", "sts3215", 1, ""), {})
                .find("arm.follower.joint_1.model: a sts3215 takes no command of force, so it can lead and not follow"),
            std::string::npos);
}

}  // namespace rig_run_test
}  // namespace tactus::cli
