#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tests/cli/command.hpp"

namespace tactus::cli {
namespace rig_run_test {

/// A pair of arms that are emulated, driven at the real clock.
class RigRun : public Command {
 protected:
  /// One side, all joints alike, at the port `@1` or `@2`.
  static std::string side(const std::string& name, const std::string& port, const std::string& bus,
                          const std::string& model, int joints, const std::string& more) {
    std::string text = "[arm." + name + "]\nbus = \"" + bus + "\"\nport = \"" + port + "\"\n";
    if (bus == "damiao") text += "reply_timeout_s = 0.05\nwatchdog_s = 1.0\n";
    for (int i = 1; i <= joints; ++i) {
      const std::string number = std::to_string(i);
      text += "[arm." + name + ".joint_" + number + "]\nmotor = " + number + "\nmodel = \"" + model +
              "\"\nlower_rad = -3.0\nupper_rad = 3.0\nvelocity_limit_rad_per_s = 8.0\ntorque_limit_Nm = "
              "1.5\ntorque_rate_limit_Nm_per_s = 500.0\n" +
              more;
    }
    return text;
  }
  static std::string pair(const std::string& bus, const std::string& model, int joints, const std::string& of_leader,
                          const std::string& of_both = {}) {
    return side("leader", "@1", bus, model, joints, of_leader + of_both) +
           side("follower", "@2", bus, model, joints, of_both);
  }
  /// How far a joint is from its leader's at most at this second, in rad.
  static double apart(const std::string& said, const std::string& second) {
    const auto at = said.find("farthest apart ", said.find("\n" + second + " s: "));
    return std::atof(said.c_str() + at + std::string("farthest apart ").size());
  }
  /// The peers at `@1` and `@2`, then the rest of the script, in which `$RUN` drives the rig.
  std::string shell(const std::string& leader, const std::string& follower, const std::string& rig,
                    const std::string& rest) {
    write("rig.in", rig);
    write("script", R"sh(
      cat rig.in >rig.toml; rm -f said1 said2; mkfifo said1 said2
      $TACTUS emulate )sh" +
                        leader + R"sh( >said1 2>emulate.err </dev/null & peers=$!
      $TACTUS emulate )sh" +
                        follower + R"sh( >said2 2>emulate.err </dev/null & peers="$peers $!"
      trap 'kill -KILL $peers 2>/dev/null' EXIT
      read -r leader <said1; read -r follower <said2
      sed -i "s|@1|$leader|; s|@2|$follower|" rig.toml
      mkfifo hands; exec 9<>hands; rm hands
      RUN="$TACTUS run $JOINTS --realtime --device rig.toml"
      )sh" + rest);
    setenv("TACTUS", TACTUS_COMMAND, 1);
    setenv("JOINTS", TACTUS_EXAMPLE_FOLDER "/rigs/joints.toml", 1);
    EXPECT_EQ(std::system(("cd '" + folder().string() + "' && sh script >out 2>err").c_str()), 0) << content("err");
    return content("out") + content("err");
  }
  using Holds = std::function<bool(const std::string& said)>;
  /// The same, up to three times until all `signs` are in what it says and `holds` it. A machine that does other things
  /// too may keep a motor unheard for longer than it may be, or a joint that is probed from going as far as it should;
  /// then both hold. Or the probe's force goes on for some ticks, and the joint stays where that leaves it: a leader is
  /// followed from there.
  std::string shell_until(const std::vector<std::string>& signs, const std::string& leader, const std::string& follower,
                          const std::string& rig, const std::string& rest, const Holds& holds = {}) {
    std::string said;
    for (int tries = 0; tries < 3; ++tries) {
      said = shell(leader, follower, rig, rest);
      const auto shows = [&said](const std::string& sign) { return said.find(sign) != std::string::npos; };
      if (std::all_of(signs.begin(), signs.end(), shows) && (!holds || holds(said))) break;
    }
    return said;
  }
};

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

/// A trigger that turns half as far as the gripper. As a joint it has a quarter of its motor's inertia, so that half of
/// the usual force tries its sign: with all of it a trigger that nobody holds is faster than it may be.
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
    $RUN --arm --duration-s 6 --set control.supervision.probe.force_N=0.2 <&9
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

/// HLS servos have no watchdog: what is left of a program that was killed is its last current.
class GuardedRun : public RigRun {
 protected:
  /// In the rest of the script `drive` starts a run in `$run` that writes into run.out, and waits until it is active;
  /// `$guards` are its guards; `power PORT` prints how servo 1 answers to the question for register 40, torque enable.
  std::string guarded_until(const std::vector<std::string>& signs, const std::string& rest) {
    return shell_until(signs, "feetech --model hls3625", "feetech --model hls3625",
                       pair("feetech", "hls3625", 2, "", "torque_Nm_per_A = 0.8\n"), R"sh(
      power() {
        exec 3<>"$1"
        timeout 0.3 cat <&3 >stale
        printf '\377\377\001\004\002\050\001\317' >&3
        timeout 5 head -c 7 <&3 | od -An -tx1 | tr -d ' \n'
        exec 3>&-
        echo
      }
      said() { for try in $(seq 100); do grep -q "$1" run.out && return; sleep 0.1; done; cat run.out; }
      drive() {
        $RUN --arm <&9 >run.out 2>&1 & run=$!
        said 'follower active'
        grep -q 'follower active' run.out && active="$active $1"
        guards=
        for child in /proc/[0-9]*/stat; do
          read -r pid name state parent rest <$child
          [ "$parent" = $run ] && guards="$guards $pid"
        done 2>/dev/null
      }
      )sh" + rest);
  }
  static constexpr const char* off = "ffff01030000fb";
  static constexpr const char* on = "ffff01030001fa";
};

TEST_F(GuardedRun, ServosWithoutAWatchdogLoseTheirPowerWhenTheProgramIsKilled) {
  const std::string said = guarded_until({"active yes no fault\n"}, R"sh(
      drive yes; kill -KILL $run; wait $run 2>/dev/null; sleep 1
      echo guarded yes $(power $leader) $(power $follower)
      # At once, so that the program does not find out that its guards are gone.
      drive no; kill -KILL $guards $run; wait $run 2>/dev/null; sleep 1
      echo guarded no $(power $leader) $(power $follower)
      drive fault; kill -SEGV $run; wait $run 2>/dev/null; sleep 1
      echo guarded fault $(power $leader) $(power $follower)
      echo active$active
  )sh");
  EXPECT_NE(said.find(std::string("guarded yes ") + off + " " + off + "\n"), std::string::npos) << said;
  // The check can fail.
  EXPECT_NE(said.find(std::string("guarded no ") + on + " " + on + "\n"), std::string::npos) << said;
  EXPECT_NE(said.find(std::string("guarded fault ") + off + " " + off + "\n"), std::string::npos) << said;
}

TEST_F(GuardedRun, ServosLoseTheirPowerWhileTheProgramIsStoppedAndItNeedsArmingAgain) {
  // The port is the program's, so power is read after its end: it has none of its own by then.
  const std::string said = guarded_until({"active stopped\n", "status 0\n", "armed 2 times"}, R"sh(
      drive stopped
      kill -STOP $run; sleep 1
      echo stopped $(power $leader) $(power $follower)
      kill -CONT $run
      said 'switched its motors off'
      # It has no power by itself.
      sleep 1.5; echo resumed $(tail -n 1 run.out)
      echo clear >&9; sleep 1.2; echo arm >&9; sleep 3
      tail -n 1 run.out
      kill -INT $run; wait $run; echo status $?
      grep 'armed 2 times' run.out
      echo active$active
  )sh");
  EXPECT_NE(said.find(std::string("stopped ") + off + " " + off + "\n"), std::string::npos) << said;
  EXPECT_NE(said.find("guard process switched its motors off"), std::string::npos) << said;
  const auto resumed = said.find("resumed ");
  ASSERT_NE(resumed, std::string::npos) << said;
  const std::string line = said.substr(resumed, said.find('\n', resumed) - resumed);
  EXPECT_NE(line.find("leader fault, follower fault"), std::string::npos) << line;
  EXPECT_NE(said.find("armed 2 times"), std::string::npos) << said;
}

TEST_F(GuardedRun, AProgramWhoseGuardIsGoneReleasesAtOnceAndSaysWhy) {
  const std::string said = guarded_until({"active gone\n"}, R"sh(
      drive gone
      kill -KILL $guards; sleep 0.3; kill -STOP $run; sleep 0.1
      echo gone $(power $leader) $(power $follower)
      kill -CONT $run; said 'guard process of its motors is gone'
      echo clear >&9; sleep 1.2; echo arm >&9; sleep 2
      tail -n 1 run.out
      kill -STOP $run; sleep 0.1; echo later $(power $leader) $(power $follower); kill -CONT $run
      kill -INT $run; wait $run; echo status $?
      grep 'armed 1 times' run.out
      echo active$active
  )sh");
  EXPECT_NE(said.find(std::string("gone ") + off + " " + off + "\n"), std::string::npos) << said;
  EXPECT_NE(said.find(std::string("later ") + off + " " + off + "\n"), std::string::npos) << said;
  EXPECT_NE(said.find("the guard process of its motors is gone, so they get no power: start the run again"),
            std::string::npos)
      << said;
}

/// Arms with their weight behind the motors, held at first 0.15 rad apart.
class ArmRun : public RigRun {
 protected:
  /// In the rest of the script `$ARMS` drives them.
  std::string arms_until(const std::vector<std::string>& signs, const std::string& rest) {
    const std::string arm =
        "damiao --motors 8 --arm $EXPERIMENTS/arms/openarm-class.urdf --armature 0.0167,0.0167,0.029,0.029,0.0018 "
        "--model DM8009,DM8009,DM4340,DM4340,DM4310 --held 0.2,-1.77,0.15,";
    const std::filesystem::path rigs = TACTUS_EXAMPLE_FOLDER "/rigs";
    setenv("EXPERIMENTS", TACTUS_EXPERIMENT_FOLDER, 1);
    setenv("RIGS", rigs.c_str(), 1);
    return shell_until(signs, arm + "1.55,0.2,0.1,0.2", arm + "1.4,0.2,0.1,0.2", "", R"sh(
      sed "s|/dev/serial/by-id/LEADER|$leader|; s|/dev/serial/by-id/FOLLOWER|$follower|
           s|^framing.*|reply_timeout_s = 0.05\nwatchdog_s = 1.0|" $RIGS/openarm-arms.toml >rig.toml
      ARMS="$TACTUS run $RIGS/arms.toml --realtime --device rig.toml"
      )sh" + rest);
  }
};

TEST_F(ArmRun, TwoArmsCarryThemselvesAndTheFollowerGoesToItsLeader) {
  const std::string said = arms_until({"; armed 1 times, held 0 times, ", ", not responding in 0, lost in 0 cycles; "},
                                      "$ARMS --arm --duration-s 12 --out run --overwrite <&9; echo status $?\n"
                                      "$TACTUS replay run/log --check; echo replayed $?");
  EXPECT_NE(said.find(", not responding in 0, lost in 0 cycles; "), std::string::npos) << said;
  EXPECT_NE(said.find("11 s: leader active, follower active (none), "), std::string::npos) << said;
  EXPECT_NE(said.find("; armed 1 times, held 0 times, "), std::string::npos) << said;
  EXPECT_NE(said.find("\n0 records of the log dropped.\nReport: run/report.html\nLog: run/log\n"), std::string::npos)
      << said;
  EXPECT_NE(said.find("status 0\n"), std::string::npos) << said;
  EXPECT_NE(
      said.find(
          " control cycles of both sites of 8 joints: every output is the recorded one, bit for bit.\nreplayed 0\n"),
      std::string::npos)
      << said;
  EXPECT_LT(apart(said, "11"), 0.06) << said;
}

TEST_F(ArmRun, AFollowerWhoseMotorsAreGoneIsAFaultAndTheLeaderHoldsItself) {
  const std::string said = arms_until({"leader active, follower active (none)"}, R"sh(
      $ARMS --arm --duration-s 14 <&9 >run.out 2>&1 & run=$!
      for try in $(seq 120); do grep -q 'follower active' run.out && break; sleep 0.1; done
      kill -KILL ${peers##* }
      wait $run; echo status $?
      cat run.out)sh");
  EXPECT_NE(said.find("leader active, follower active (none)"), std::string::npos) << said;
  EXPECT_NE(said.find("leader hold, follower fault (gate), "), std::string::npos) << said;
  EXPECT_NE(said.find("; follower: its port was closed"), std::string::npos) << said;
  EXPECT_EQ(said.find("leader fault"), std::string::npos) << said;
  EXPECT_NE(said.find("Ended in a fault: follower (gate); follower: its port was closed"), std::string::npos) << said;
  EXPECT_NE(said.find(" (damiao) did not report within 0.5 s that it is off ("), std::string::npos) << said;
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
