// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <string>
#include <vector>

#include "tests/cli/command.hpp"
#include "tests/cli/schema_validator.hpp"
#include <nlohmann/json.hpp>

namespace tactus::cli {
namespace device_rig_test {

/// A joint's section of ten lines.
std::string joint(const std::string& path, int motor, const std::string& model, const std::string& torque_limit_Nm,
                  const std::string& more = "# of no meaning") {
  return "[" + path + "]\nmotor = " + std::to_string(motor) + "\nmodel = \"" + model +
         "\"\nlower_rad = -1.5\nupper_rad = 1.5\nvelocity_limit_rad_per_s = 5.0\ntorque_limit_Nm = " + torque_limit_Nm +
         "\ntorque_rate_limit_Nm_per_s = 10.0\n" + more + "\n\n";
}

class DeviceRig : public Command {
 protected:
  /// Emulated motors with these options, `@1` and on in the rig their ports; then what a command of `device` says.
  Outcome device(const std::vector<std::string>& emulated, const std::string& rig, const std::string& command) {
    std::string script = "rm -f said*\ncat rig.in >rig.toml\n";
    for (std::size_t i = 1; i <= emulated.size(); ++i) {
      const std::string number = std::to_string(i);
      script += "mkfifo said" + number + "\n$TACTUS emulate " + emulated[i - 1] + " >said" + number +
                " 2>emulate.err </dev/null & peers=\"$peers $!\"\ntrap \"kill -KILL $peers\" EXIT\nread -r path <said" +
                number + " || exit 99\nsed -i \"s|@" + number + "|$path|\" rig.toml\n";
    }
    write("rig.in", rig);
    write("script", script + "$TACTUS device " + command + " >out 2>err\necho $? >status\n");
    setenv("TACTUS", TACTUS_COMMAND, 1);
    EXPECT_EQ(std::system(("cd '" + folder().string() + "' && sh script 2>script.err").c_str()), 0)
        << content("emulate.err") << content("script.err");
    return {.status = std::atoi(content("status").c_str()), .out = content("out"), .err = content("err")};
  }
  void expect_of_schema(const Outcome& outcome) const {
    const auto schema = nlohmann::json::parse(tactus({"schema", "--results", "device", "check"}).out);
    EXPECT_EQ(SchemaValidator(schema).faults(nlohmann::json::parse(outcome.out, nullptr, false)), "") << outcome.out;
  }
  static bool says(const Outcome& outcome, const std::string& text) {
    return outcome.out.find(text) != std::string::npos;
  }
};

const std::string servos = "[arm.leader]\nbus = \"dynamixel\"\nport = \"@1\"\n\n" +
                           joint("arm.leader.shoulder", 1, "xl330-m288", "0.3") +
                           joint("arm.leader.elbow", 2, "xl330-m288", "0.3");

std::string damiao(const std::string& first, const std::string& second, const std::string& more = "# none") {
  return "[arm.follower]\nbus = \"damiao\"\nport = \"@1\"\n\n" + joint("arm.follower.shoulder", 1, first, "5.0", more) +
         joint("arm.follower.elbow", 2, second, "5.0");
}

TEST_F(DeviceRig, APairThatIsWhatItsFileSaysIsClean) {
  std::string follower = damiao("DM4340", "DM4310");
  follower.replace(follower.find("@1"), 2, "@2");
  const std::vector<std::string> motors{"dynamixel", "damiao --model DM4340,DM4310"};
  const Outcome clean = device(motors, servos + follower, "check rig.toml");
  EXPECT_EQ(clean.status, 0) << clean.out << clean.err;
  EXPECT_EQ(clean.out.find("Clean: each motor is what was stated; "), 0U) << clean.out;
  EXPECT_TRUE(says(clean,
                   "Motors of one model cannot detect that two were swapped: move each joint by hand under "
                   "'tactus device watch rig.toml'.\n"));
  const Outcome json = device(motors, servos + follower, "check rig.toml arm.follower.elbow --json");
  expect_of_schema(json);
  EXPECT_EQ(json.status, 0);
  const auto told = nlohmann::json::parse(json.out);
  EXPECT_EQ(told["clean"], true);
  ASSERT_EQ(told["buses"].size(), 1U);
  ASSERT_EQ(told["buses"][0]["motors"].size(), 1U);
  const auto& motor = told["buses"][0]["motors"][0];
  EXPECT_EQ(motor["joint"], "arm.follower.elbow");
  EXPECT_EQ(motor["firmware"], "5013");
  EXPECT_EQ(motor["torque_limit_Nm"], 10.0);
  EXPECT_EQ(motor["state"], "well");
}

TEST_F(DeviceRig, MotorsThatAreNotTheStatedOnesAreToldWithTheirLine) {
  const Outcome swapped = device({"damiao --model DM4310,DM4340"}, damiao("DM4340", "DM4310"), "check rig.toml --json");
  expect_of_schema(swapped);
  EXPECT_EQ(swapped.status, 1);
  const auto told = nlohmann::json::parse(swapped.out);
  EXPECT_EQ(told["clean"], false);
  const auto& problem = told["buses"][0]["motors"][0]["problems"][0];
  EXPECT_EQ(problem["place"], "rig.toml:7:9");
  EXPECT_EQ(problem["key"], "arm.follower.shoulder.model");
  const std::string message = problem["message"];
  EXPECT_NE(message.find("it looks as if motors 1 and 2 were swapped: exchange their identifiers"), std::string::npos)
      << message;
  const Outcome silent = device({"dynamixel --fault silence:2"}, servos, "check rig.toml");
  EXPECT_EQ(silent.status, 1);
  EXPECT_EQ(silent.out.find("Not clean; no motor got power.\nrig.toml:16:9: arm.leader.elbow.motor: servo 2 does not "
                            "answer at 1000000 bit/s: look at its power"),
            0U)
      << silent.out;
  const Outcome twins =
      device({"damiao --model DM4340,DM4310 --fault twin:2"}, damiao("DM4340", "DM4310"), "check rig.toml");
  EXPECT_EQ(twins.status, 1);
  EXPECT_TRUE(says(twins, "rig.toml:16:9: arm.follower.elbow.motor: motor 2 (DM4310) answers twice")) << twins.out;
  const Outcome other = device({"dynamixel --fault wrong-model:1"}, servos, "check rig.toml");
  EXPECT_TRUE(says(other, "rig.toml:7:9: arm.leader.shoulder.model: servo 1 reports model number 1220 (XC330-T288)"))
      << other.out;
  const Outcome elsewhere = device({"dynamixel --fault wrong-model:1"}, servos, "check rig.toml arm.leader.elbow");
  EXPECT_EQ(elsewhere.status, 1);
  EXPECT_TRUE(says(elsewhere, "arm.leader: another motor of this bus is wrong: check all of it.\n")) << elsewhere.out;
}

/// As `tactus run` refuses it, in the same words.
TEST_F(DeviceRig, AFollowerThatTakesNoForceIsNotClean) {
  std::string follower =
      "[arm.follower]\nbus = \"feetech\"\nport = \"@1\"\n"
      "[arm.follower.elbow]\nmotor = 1\nmodel = \"sts3215\"\nlower_rad = -1.5\nupper_rad = 1.5\n"
      "velocity_limit_rad_per_s = 3.0\n";
  const Outcome follows = device({"feetech --motors 1"}, follower, "check rig.toml");
  EXPECT_EQ(follows.status, 1);
  EXPECT_TRUE(says(follows,
                   "Not clean; no motor got power.\nrig.toml:6:9: arm.follower.elbow.model: a sts3215 takes no command "
                   "of force, so it can lead and not follow: swap leader and follower"))
      << follows.out << follows.err;
  for (auto at = follower.find("follower"); at != std::string::npos; at = follower.find("follower", at)) {
    follower.replace(at, 8, "leader");
  }
  const Outcome leads = device({"feetech --motors 1"}, follower, "check rig.toml");
  EXPECT_EQ(leads.status, 0) << leads.out << leads.err;
}

TEST_F(DeviceRig, AWrongBitRateIsFoundAndTheRightOneTold) {
  const Outcome rate = device({"dynamixel --bits-per-s 57600 --deaf-otherwise"}, servos, "check rig.toml");
  EXPECT_EQ(rate.status, 1);
  EXPECT_TRUE(says(rate,
                   "rig.toml:1:6: arm.leader.bits_per_s: the motors answer at 57600 bit/s, not at 1000000: state "
                   "bits_per_s = 57600"))
      << rate.out;
}

TEST_F(DeviceRig, AJointThatIsNotWhereItMayBeAndALimitThatTheMotorDoesNotReachAreTold) {
  const Outcome outside =
      device({"damiao --model DM4340,DM4310"}, damiao("DM4340", "DM4310", "offset_rad = 2.0"), "check rig.toml");
  EXPECT_EQ(outside.status, 1);
  EXPECT_TRUE(says(outside,
                   "rig.toml:13:14: arm.follower.shoulder.offset_rad: it is at 2 rad, where it may be from "
                   "-1.5 to 1.5: move it there by hand; where it is there, put it to its zero and run "
                   "'tactus device zero rig.toml arm.follower.shoulder'.\n"))
      << outside.out;
  const Outcome limit = device({"dynamixel --fault low-limit:2"}, servos, "check rig.toml");
  EXPECT_EQ(limit.status, 1);
  EXPECT_TRUE(says(limit,
                   "rig.toml:21:19: arm.leader.elbow.torque_limit_Nm: 0.3 N m is more than its motor is set to "
                   "give, 0.062 N m: lower it"))
      << limit.out;
  const Outcome hot =
      device({"damiao --model DM4340,DM4310 --fault hot-winding:1"}, damiao("DM4340", "DM4310"), "check rig.toml");
  EXPECT_EQ(hot.status, 1);
  EXPECT_TRUE(says(hot, "rig.toml:6:9: arm.follower.shoulder.motor: motor 1: too hot: let it cool")) << hot.out;
}

TEST_F(DeviceRig, APortThatIsNotThereIsToldBesideTheOthers) {
  std::string follower = damiao("DM4340", "DM4310");
  follower.replace(follower.find("@1"), 2, "/dev/ttyACM-nobody");
  const Outcome outcome = device({"dynamixel"}, servos + follower, "check rig.toml");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_TRUE(says(outcome, "rig.toml:27:8: arm.follower.port: /dev/ttyACM-nobody: there is no such port"))
      << outcome.out;
}

TEST_F(DeviceRig, ZeroWritesTheOffsetWithWhichTheJointIsAtZeroWhereItIs) {
  const std::string rig = damiao("DM4340", "DM4310", "offset_rad = 0.25  # of last week");
  const Outcome zeroed = device({"damiao --model DM4340,DM4310"}, rig, "zero rig.toml arm.follower.shoulder");
  EXPECT_EQ(zeroed.status, 0) << zeroed.err;
  EXPECT_EQ(zeroed.out, "arm.follower.shoulder was at 0.2502 rad and is at zero now.\n");
  // The motor stands at the code above zero, which is 12.5 rad / 65535.
  std::string expected = content("rig.toml");
  EXPECT_NE(expected.find("offset_rad = -0.000191  # of last week\n"), std::string::npos) << expected;
  const Outcome all =
      device({"damiao --model DM4340,DM4310"}, damiao("DM4340", "DM4310"), "zero rig.toml arm.follower");
  EXPECT_EQ(all.status, 0);
  EXPECT_NE(content("rig.toml").find("motor = 2\noffset_rad = -0.000191\n"), std::string::npos) << content("rig.toml");
  const Outcome wrong =
      device({"damiao --fault silence:2"}, damiao("DM4310", "DM4310"), "zero rig.toml arm.follower.shoulder");
  EXPECT_EQ(wrong.status, 2);
  EXPECT_NE(wrong.err.find("motor 2 (DM4310) does not answer"), std::string::npos) << wrong.err;
  EXPECT_EQ(content("rig.toml").find("offset_rad"), std::string::npos);
  const Outcome nobody = device({"damiao"}, damiao("DM4310", "DM4310"), "zero rig.toml arm.follower.wrist");
  EXPECT_EQ(nobody.status, 2);
  EXPECT_NE(nobody.err.find("'arm.follower.wrist' is no part of the rig: its joints are arm.follower.shoulder, "
                            "arm.follower.elbow"),
            std::string::npos)
      << nobody.err;
}

TEST_F(DeviceRig, ZeroOfOneMotorLeavesTheOthersOfItsArm) {
  const std::string rig = damiao("DM4340", "DM4310");
  for (const char* motor : {"2", "elbow"}) {
    const Outcome one =
        device({"damiao --model DM4340,DM4310"}, rig, std::string("zero rig.toml arm.follower --motor ") + motor);
    EXPECT_EQ(one.status, 0) << one.err;
    EXPECT_EQ(one.out, "arm.follower.elbow was at 0.0001907 rad and is at zero now.\n");
    const std::string written = content("rig.toml");
    EXPECT_NE(written.find("motor = 2\noffset_rad = -0.000191\n"), std::string::npos) << written;
    EXPECT_EQ(written.find("offset_rad"), written.rfind("offset_rad")) << written;
  }
  for (const char* motor : {"3", "wrist", "arm.follower.elbow"}) {
    const Outcome unknown = device({"damiao"}, rig, std::string("zero rig.toml arm --motor ") + motor);
    EXPECT_EQ(unknown.status, 2);
    EXPECT_NE(unknown.err.find(std::string("'") + motor +
                               "' is no motor and no joint there: the motors are 1 (arm.follower.shoulder), 2 "
                               "(arm.follower.elbow)"),
              std::string::npos)
        << unknown.err;
    EXPECT_EQ(content("rig.toml").find("offset_rad"), std::string::npos);
  }
}

TEST_F(DeviceRig, WatchShowsEachJointALineAndLimitsWhichOneHolds) {
  const Outcome watched = device({"dynamixel"}, servos, "watch rig.toml arm.leader.elbow --duration-s 0.5");
  EXPECT_EQ(watched.status, 0) << watched.err;
  EXPECT_EQ(watched.out.find("# time_s joint unit position moved velocity temperature_C age_ms state\n"), 0U);
  EXPECT_TRUE(says(watched, " arm.leader.elbow rad 0.0000 0.0000 0.000 35 ")) << watched.out;
  EXPECT_FALSE(says(watched, "shoulder"));
  const Outcome limits = device({"dynamixel --fault low-limit:2"}, servos, "limits rig.toml");
  EXPECT_EQ(limits.status, 0) << limits.err;
  // 1.75 A and 0.175 A times 0.52 / 1.47 Nm/A.
  EXPECT_EQ(limits.out.find("arm.leader\n"), 0U) << limits.out;
  EXPECT_TRUE(says(limits, "shoulder        0.6190  0.3000  file ")) << limits.out;
  EXPECT_TRUE(says(limits, "elbow          0.06190  0.3000  motor ")) << limits.out;
  const auto of_the_file = limits.out.find("joint     force rate  stiffness    damping\n");
  ASSERT_NE(of_the_file, std::string::npos) << limits.out;
  EXPECT_NE(limits.out.find("elbow          10.00          -          -\n", of_the_file), std::string::npos)
      << limits.out;
}

/// The longest line in columns, headings and rules of tables included.
std::size_t widest(const std::string& text) {
  std::size_t most = 0, columns = 0;
  for (const char c : text) {
    constexpr unsigned continued = 0x80, of_continued = 0xc0;
    if ((static_cast<unsigned char>(c) & of_continued) != continued) ++columns;
    if (c == '\n') columns = 0;
    most = std::max(most, columns);
  }
  return most;
}

TEST_F(DeviceRig, TablesOfEightJointsHaveARowForEachAndFitInto80Columns) {
  std::string rig = "[arm.follower]\nbus = \"damiao\"\nport = \"@1\"\n\n";
  for (int i = 1; i <= 8; ++i) rig += joint("arm.follower.joint_" + std::to_string(i), i, "DM4310-48V", "5.0");
  const std::vector<std::string> motors{"damiao --motors 8 --model DM4310-48V"};
  const Outcome checked = device(motors, rig, "check rig.toml");
  EXPECT_EQ(checked.status, 0) << checked.out << checked.err;
  const auto table = checked.out.find("arm.follower: damiao at ");
  ASSERT_NE(table, std::string::npos) << checked.out;
  EXPECT_LE(widest(checked.out.substr(table)), 80U) << checked.out;
  EXPECT_TRUE(says(checked, "\njoint_8      8  DM4310-48V  ")) << checked.out;
  const Outcome limits = device(motors, rig, "limits rig.toml");
  EXPECT_LE(widest(limits.out), 80U) << limits.out;
  EXPECT_TRUE(says(limits, "\njoint_8 ")) << limits.out;
  const Outcome probed = device(motors, rig, "list $path --probe");
  EXPECT_LE(widest(probed.out), 80U) << probed.out;
  EXPECT_TRUE(says(probed, " 8 (Damiao motor)\n")) << probed.out;
}

TEST_F(DeviceRig, AnInverse3IsCheckedThroughItsService) {
  std::string rig = "[desk.leader]\nbus = \"inverse3\"\nport = \"@1\"\n";
  for (const char* axis : {"x\nmotor = 1", "y\nmotor = 2", "z\nmotor = 3"}) {
    const std::string name(1, axis[0]);
    rig += "[desk.leader." + name + "]" + (axis + 1) +
           "\nmodel = \"inverse3\"\nlower_m = -0.1\nupper_m = 0.1\nvelocity_limit_m_per_s = 1.0\nforce_limit_N = "
           "2.0\nforce_rate_limit_N_per_s = 50.0\n";
  }
  // Its address is a URL; the rig has host and port.
  const std::string no_scheme = "x rig.toml >/dev/null 2>&1; sed -i 's|ws://||' rig.toml; $TACTUS device ";
  const Outcome clean = device({"inverse3 --port 0"}, rig, no_scheme + "check rig.toml --json");
  expect_of_schema(clean);
  EXPECT_EQ(clean.status, 0) << clean.out << clean.err;
  const auto told = nlohmann::json::parse(clean.out);
  EXPECT_EQ(told["buses"][0]["motors"][2]["joint"], "desk.leader.z");
  EXPECT_EQ(told["buses"][0]["motors"][2]["position_m"], 0.0);
  EXPECT_EQ(told["buses"][0]["motors"][2]["firmware"], "3.5.0");
  const Outcome uncalibrated = device({"inverse3 --port 0 --uncalibrated"}, rig, no_scheme + "check rig.toml");
  EXPECT_EQ(uncalibrated.status, 1);
  EXPECT_TRUE(says(uncalibrated, "rig.toml:5:9: desk.leader.x.motor: device 049D is not calibrated and gives no force"))
      << uncalibrated.out;
}

TEST_F(DeviceRig, ListAsksOnlyWhereItIsTold) {
  const Outcome quiet = device({"dynamixel"}, servos, "list $path");
  EXPECT_EQ(quiet.status, 0);
  EXPECT_EQ(quiet.out.find('\n'), quiet.out.size() - 1) << quiet.out;
  const Outcome probed = device({"dynamixel --bits-per-s 57600 --deaf-otherwise"}, servos, "list $path --probe");
  EXPECT_TRUE(says(probed, "\n  dynamixel, bits_per_s = 57600: 1 (xl330-m288), 2 (xl330-m288)\n")) << probed.out;
  EXPECT_FALSE(says(probed, "1000000"));
  const Outcome damiao_motors = device({"damiao --framing slcan"}, servos, "list $path --probe");
  EXPECT_TRUE(says(damiao_motors, "\n  damiao, framing = \"slcan\": 1 (Damiao motor), 2 (Damiao motor)\n"))
      << damiao_motors.out;
  const Outcome feetech = device({"feetech --motors 3"}, servos, "list $path --probe");
  EXPECT_TRUE(says(feetech,
                   "\n  feetech, bits_per_s = 1000000: 1 (Feetech servo), 2 (Feetech servo),\n    3 (Feetech servo)\n"))
      << feetech.out;
}

}  // namespace device_rig_test
}  // namespace tactus::cli
