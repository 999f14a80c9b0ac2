// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "tests/cli/rig_run.hpp"

namespace tactus::cli {
namespace rehearse_test {

/// Rig files whose ports do not exist, run with emulated motors.
class Rehearse : public RigRun {
 protected:
  static constexpr const char* leader_port = "/dev/serial/by-id/LEADER";
  static std::string with_ports(std::string rig) {
    for (const auto& [mark, port] : {std::pair{"@1", leader_port}, std::pair{"@2", "/dev/serial/by-id/FOLLOWER"}}) {
      rig.replace(rig.find(mark), 2, port);
    }
    return rig;
  }
  /// What `tactus rehearse rig.toml WORDS` prints, up to three times until it has all `signs`; an operator is there who
  /// types nothing.
  std::string rehearse(const std::string& rig, const std::string& words, const std::vector<std::string>& signs) {
    write("rig.toml", with_ports(rig));
    write("script", "rm -f hands; mkfifo hands; exec 9<>hands; \"$TACTUS\" rehearse rig.toml " + words +
                        " <&9; echo status $?\n");
    setenv("TACTUS", TACTUS_COMMAND, 1);
    std::string said;
    for (int tries = 0; tries < 3; ++tries) {
      EXPECT_EQ(std::system(("cd '" + folder().string() + "' && sh script >out 2>err").c_str()), 0) << content("err");
      said = content("out") + content("err");
      const auto shows = [&said](const std::string& sign) { return said.find(sign) != std::string::npos; };
      if (std::all_of(signs.begin(), signs.end(), shows)) break;
    }
    for (const std::string& sign : signs) EXPECT_NE(said.find(sign), std::string::npos) << sign << "\n" << said;
    return said;
  }
  std::string refusal(const std::string& rig, std::vector<std::string> words) {
    write("rig.toml", with_ports(rig));
    words.insert(words.begin(), {"rehearse", "rig.toml"});
    const Outcome outcome = tactus(words);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    return outcome.err;
  }
};

/// Signs, zeros and gears are those of the file, so that both sides start in one pose within the limits, which 0 is
/// not.
TEST_F(Rehearse, DamiaoMotorsStartWithinTheirLimitsAndAreDrivenAsThoseOfTheFile) {
  std::string rig = side("leader", "@1", "damiao", "DM4310", 2, "offset_rad = 0.7\nsign = -1\n") +
                    side("follower", "@2", "damiao", "DM4340", 2, "gear = 0.5\n");
  for (auto at = rig.find("lower_rad = -3.0"); at != std::string::npos; at = rig.find("lower_rad = -3.0", at)) {
    rig.replace(at, 16, "lower_rad = 1.0");
  }
  const std::string said = rehearse(
      rig, "--arm --duration-s 5 --out run --overwrite",
      {"Rehearsal: all motors are emulated, and no port of the rig file is opened.\n",
       "arm.leader: 2 emulated damiao motors at /dev/pts/", ", in place of /dev/serial/by-id/LEADER\n",
       "arm.follower: 2 emulated damiao motors at /dev/pts/", "leader active, follower active (none), ", "status 0\n"});
  EXPECT_EQ(content("rig.toml"), with_ports(rig));
  EXPECT_NE(said.find("; armed 1 times"), std::string::npos) << said;
  const Outcome replayed = tactus({"replay", "run/log", "--check"});
  EXPECT_EQ(replayed.status, 0) << replayed.err;
}

TEST_F(Rehearse, ALeaderOfDynamixelServosLeadsAnArmOfDamiaoMotors) {
  std::string rig =
      side("leader", "@1", "dynamixel", "xm430-w210", 1, "") + side("follower", "@2", "damiao", "DM4310", 1, "");
  rig.insert(rig.find("port = "), "bits_per_s = 4000000\n");
  // What such a servo can do.
  rig.replace(rig.find("velocity_limit_rad_per_s = 8.0"), 30, "velocity_limit_rad_per_s = 4.0");
  rig.replace(rig.find("torque_limit_Nm = 1.5"), 21, "torque_limit_Nm = 0.6");
  static_cast<void>(rehearse(rig, "--arm --duration-s 5",
                             {"arm.leader: 1 emulated dynamixel motor at /dev/pts/",
                              "leader active, follower active (none), ", "status 0\n"}));
}

TEST_F(Rehearse, FeetechServosLeadAndFollowWithoutAGuard) {
  const std::string rig = side("leader", "@1", "feetech", "sts3215", 2, "") +
                          side("follower", "@2", "feetech", "hls3625", 2, "torque_Nm_per_A = 0.8\n");
  static_cast<void>(rehearse(
      rig, "--arm --duration-s 5",
      {"arm.leader: 2 emulated feetech motors at /dev/pts/", "arm.follower: 2 emulated feetech motors at /dev/pts/",
       "leader active, follower active (none), ", "status 0\n"}));
}

TEST_F(Rehearse, AFaultOfOneSideIsReportedAsThatOfARealMotorWouldBe) {
  static_cast<void>(rehearse(pair("damiao", "DM4310", 2, ""), "--arm --duration-s 5 --fault follower:hot-drive:2@4",
                             {"follower active", "leader hold, follower fault (gate), ", "; follower: joint_2 ",
                              "Ended in a fault: follower", "status 1\n"}));
  static_cast<void>(rehearse(pair("damiao", "DM4310", 2, ""), "--arm --duration-s 5 --fault leader:wrong-scale:1",
                             {"arm.leader.joint_1.model: motor 1 (DM4310): its register 22 (VMAX) reads ",
                              "tactus: rig.toml: it is not clean, so nothing was driven", "status 1\n"}));
}

TEST_F(Rehearse, WhatCannotBeRehearsedIsRefusedWithTheRemedy) {
  const std::string damiao = pair("damiao", "DM4310", 1, "");
  EXPECT_NE(refusal(damiao, {"--fault", "elbow:silence"})
                .find("--fault: 'elbow:silence' names no side: write leader:FAULT or follower:FAULT"),
            std::string::npos);
  EXPECT_NE(refusal(damiao, {"--fault", "leader:silence:7"}).find("--fault: 'silence:7' names no motor of arm.leader"),
            std::string::npos);
  EXPECT_NE(refusal(damiao, {"--led", "0.3,5"}).find("--led: only arms are led"), std::string::npos);
  EXPECT_NE(refusal(damiao, {"--wall", "0.02"}).find("--wall: only arms"), std::string::npos);
  EXPECT_NE(refusal(damiao, {"--tapped", "0.03,2,5"}).find("--tapped: only arms"), std::string::npos);
  EXPECT_NE(refusal(damiao, {"--requests"})
                .find("--requests: requests come from a page or a ROS 2 node: add --live or --ros2"),
            std::string::npos);
  EXPECT_NE(refusal(damiao, {"--peer", "127.0.0.1:7001"}).find("--peer: there is no link where both sites run"),
            std::string::npos);
  EXPECT_NE(
      refusal(side("leader", "@1", "feetech", "sts3250", 1, "") + side("follower", "@2", "damiao", "DM4310", 1, ""), {})
          .find("rig.toml:6:9: arm.leader.joint_1.model: tactus does not emulate a sts3250"),
      std::string::npos);
  const Outcome no_rig = tactus({"rehearse", "openarm"});
  EXPECT_EQ(no_rig.status, 2);
  EXPECT_NE(no_rig.err.find("RIG: 'openarm' is no rig file, whose name ends in .toml"), std::string::npos)
      << no_rig.err;
}

}  // namespace rehearse_test
}  // namespace tactus::cli
