// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/cli/rig_run.hpp"

namespace tactus::cli {
namespace guarded_run_test {

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

}  // namespace guarded_run_test
}  // namespace tactus::cli
