// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/plugin/driver_registry.hpp>
#include <tactus/hardware/devices/rig/rig.hpp>

#include <filesystem>
#include <numbers>
#include <string>

#include <gtest/gtest.h>
#include <tests/devices/rig/rig_files.hpp>
#include <tests/scratch_path.hpp>

namespace tactus::devices {
namespace rig_test {

/// What is said of a file; empty where it is a rig.
std::string problem_of(const std::string& text) {
  const auto rig = Rig::parse(text, "rig.toml");
  return rig ? std::string() : describe(rig.error());
}

const std::string pair_of_two = damiao_side("arm.leader", "/dev/a") + joint("arm.leader.shoulder", 1, "DM4340") +
                                joint("arm.leader.elbow", 2, "DM4310", "sign = -1\noffset_rad = 0.5\ngear = 2.0\n") +
                                damiao_side("arm.follower", "/dev/b") + "framing = \"slcan\"\n" +
                                joint("arm.follower.elbow", 2, "DM4310") + joint("arm.follower.shoulder", 1, "DM4340");

TEST(Rig, NamesBusesMotorsAndJointsAndCouplesJointsOfOneName) {
  const auto rig = Rig::parse(pair_of_two, "rig.toml");
  ASSERT_TRUE(rig) << describe(rig.error());
  ASSERT_EQ(rig->pairs().size(), 1U);
  const RigPair& arm = rig->pairs()[0];
  EXPECT_EQ(arm.name, "arm");
  ASSERT_TRUE(arm.leader && arm.follower);
  EXPECT_EQ(arm.leader->bus.port, "/dev/a");
  EXPECT_EQ(arm.leader->bus.framing, "usb2can");
  EXPECT_EQ(arm.follower->bus.framing, "slcan");
  ASSERT_EQ(arm.leader->joints.size(), 2U);
  const RigJoint& elbow = arm.leader->joints[1];
  EXPECT_EQ(elbow.path, "arm.leader.elbow");
  EXPECT_EQ(elbow.name(), "elbow");
  EXPECT_EQ(elbow.motor.id, 2);
  EXPECT_EQ(elbow.motor.model, "DM4310");
  EXPECT_EQ(elbow.joint.sign, -1);
  EXPECT_EQ(elbow.joint.torque_limit_Nm, 2.0);
  EXPECT_TRUE(elbow.joint.gives_force);
  // In the leader's order, whatever that of the file; and the bus has the motors in that order.
  EXPECT_EQ(arm.follower->joints[0].path, "arm.follower.shoulder");
  EXPECT_EQ(arm.follower->bus.motors[0].model, "DM4340");
}

TEST(Rig, SignOffsetAndGearTranslateBetweenMotorAndJoint) {
  MotorJoint joint;
  joint.sign = -1;
  joint.offset_rad = 0.5;
  joint.gear = 2.0;
  joint.torque_limit_Nm = 3.0;
  // The motor has turned by 1 rad: the joint half as far, the other way, from half a radian on.
  EXPECT_DOUBLE_EQ(joint.position_rad(1.0), 0.0);
  EXPECT_DOUBLE_EQ(joint.velocity_rad_per_s(4.0), -2.0);
  // What the joint gets is what the gear makes of the motor's torque; power is the same on both sides.
  EXPECT_DOUBLE_EQ(joint.motor_torque_Nm(1.0), -0.5);
  EXPECT_DOUBLE_EQ(joint.motor_torque_Nm(1.0) * 4.0, 1.0 * joint.velocity_rad_per_s(4.0));
  EXPECT_DOUBLE_EQ(joint.motor_torque_Nm(-7.0), 1.5);
}

TEST(Rig, ANumberThatBeginsAnewAfterATurnStandsForTheTurnInTheRange) {
  MotorJoint joint;
  joint.lower_rad = -1.0;
  joint.upper_rad = 2.0;
  EXPECT_DOUBLE_EQ(joint.first_position_rad(6.2), 6.2);
  joint.turn_rad = 2.0 * std::numbers::pi;
  EXPECT_DOUBLE_EQ(joint.first_position_rad(6.2), 6.2 - 2.0 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(joint.first_position_rad(1.9), 1.9);
  joint.sign = -1;
  joint.gear = 2.0;
  joint.offset_rad = 1.0;
  // A turn of the motor is half a turn of the joint.
  EXPECT_DOUBLE_EQ(joint.first_position_rad(6.0), -2.0 + std::numbers::pi);
}

TEST(Rig, AMotorThatLosesItsTurnsWithItsPowerStandsForTheTurnInTheRange) {
  const auto first_place_of = [](const std::string& bus, const std::string& model, const std::string& range) {
    std::string text = "[arm.leader]\nbus = \"" + bus +
                       "\"\nport = \"/dev/a\"\n[arm.leader.wrist]\nmotor = 1\nmodel = \"" + model +
                       "\"\noffset_rad = -6.1\nvelocity_limit_rad_per_s = 3.0\ntorque_limit_Nm = 0.2\n"
                       "torque_rate_limit_Nm_per_s = 50.0\n" +
                       range;
    const auto rig = Rig::parse(text, "rig.toml");
    EXPECT_TRUE(rig) << describe(rig.error());
    return rig ? rig->pairs()[0].leader->joints[0].joint.first_position_rad(0.0) : 1e9;
  };
  for (const auto& [bus, model] : {std::pair{"dynamixel", "xm430-w350"}, std::pair{"damiao", "DM4310"}}) {
    EXPECT_NEAR(first_place_of(bus, model, "lower_rad = -2.9\nupper_rad = 2.9\n"), 2.0 * std::numbers::pi - 6.1, 1e-12)
        << bus;
    // A joint that goes farther than a turn is where its motor reports it.
    EXPECT_EQ(first_place_of(bus, model, "lower_rad = -6.2\nupper_rad = 2.9\n"), -6.1) << bus;
  }
}

TEST(Rig, EveryMistakeIsToldWithItsLineAndRemedy) {
  const std::string side = damiao_side("arm.leader", "/dev/a");  // three lines
  const std::string one = joint("arm.leader.elbow", 1, "DM4310");
  EXPECT_EQ(problem_of(side + one), "");
  EXPECT_EQ(problem_of(side + joint("arm.leader.elbow", 1, "DM4311")),
            "rig.toml:6:9: arm.leader.elbow.model: \"DM4311\" is no choice here: it must be \"DM3507\", \"DM4310\", "
            "\"DM4310-48V\", \"DM4340\", \"DM6006\", \"DM8006\", \"DM8009\", \"DM10010L\", \"DM10010\", \"DMH6215\" or "
            "\"DMG6220\"; did you mean \"DM4310\"?");
  EXPECT_EQ(problem_of(side + one + joint("arm.leader.wrist", 1, "DM4310")),
            "rig.toml:13:9: arm.leader.wrist.motor: 1 is the motor of arm.leader.elbow too: each motor has an "
            "identifier of its own");
  EXPECT_EQ(problem_of(side + one + "lower_red = 1.0\n"),
            "rig.toml:12:1: arm.leader.elbow.lower_red: unknown key: did you mean lower_rad?");
  EXPECT_EQ(
      problem_of(side + "bits_per_s = 1000000\n" + one),
      "rig.toml:4:1: arm.leader.bits_per_s: unknown key: [arm.leader] can have bus, port, framing, reply_timeout_s, "
      "watchdog_s, elbow");
  EXPECT_EQ(problem_of(side + "patience_s = 0.002\n" + one),
            "rig.toml:4:1: arm.leader.patience_s: this key is now called reply_timeout_s");
  std::string registered;  // by other cases of this process
  for (const DriverKind& driver : driver_kinds()) registered += ", " + driver.name;
  EXPECT_EQ(
      problem_of("[arm.leader]\nbus = \"damiau\"\nport = \"/dev/a\"\n" + one),
      "rig.toml:2:7: arm.leader.bus: 'damiau' is not a bus that tactus can drive; write one of damiao, dynamixel, "
      "feetech, inverse3" +
          registered + ", or load the driver with `tactus --plugin FILE.so`");
  EXPECT_EQ(problem_of("[arm.leader]\nport = \"/dev/a\"\n" + one),
            "rig.toml:1:6: arm.leader.bus: this key is needed: write bus = \"...\" under [arm.leader]");
  EXPECT_EQ(problem_of("[arm.leader]\nbus = \"damiao\"\n" + one),
            "rig.toml:1:1: arm.leader: port is needed: write for instance port = \"/dev/serial/by-id/...\" under "
            "[arm.leader]");
  EXPECT_EQ(problem_of(side + "[arm.leader.elbow]\nmotor = 1\nmodel = \"DM4310\"\n"),
            "rig.toml:4:1: arm.leader.elbow: lower_rad is needed: write for instance lower_rad = -1.5 under "
            "[arm.leader.elbow]");
  EXPECT_EQ(problem_of(side + joint("arm.leader.elbow", 1, "DM4310", "sign = 0\n")),
            "rig.toml:12:8: arm.leader.elbow.sign: 0 must be 1, or -1 where the motor turns against the joint");
  EXPECT_EQ(problem_of(side), "rig.toml:1:1: arm.leader: 0 joints: one to 8 must follow, as [arm.leader.elbow]");
  EXPECT_EQ(problem_of("title = \"x\"\n"), "rig.toml:1:1: title: unknown key: remove it");
}

TEST(Rig, ALimitBeyondTheMotorsIsRefused) {
  const std::string side = damiao_side("arm.leader", "/dev/a");
  const auto with = [&side](const std::string& line, const std::string& other) {
    std::string text = side + joint("arm.leader.elbow", 1, "DM4310");
    text.replace(text.find(line), line.size(), other);
    return text;
  };
  // The page: a DM4310 ends at 10 N m and 30 rad/s.
  EXPECT_EQ(problem_of(with("torque_limit_Nm = 2.0", "torque_limit_Nm = 10.0")), "");
  EXPECT_EQ(problem_of(with("torque_limit_Nm = 2.0", "torque_limit_Nm = 10.5")),
            "rig.toml:10:19: arm.leader.elbow.torque_limit_Nm: 10.5 N m is beyond what a DM4310 can do, 10 N m: lower "
            "it, or state the model that is there");
  EXPECT_EQ(problem_of(with("torque_limit_Nm = 2.0", "torque_limit_Nm = 10.5\ngear = 2.0")), "");
  EXPECT_EQ(problem_of(with("velocity_limit_rad_per_s = 3.0", "velocity_limit_rad_per_s = 20.0\ngear = 2.0")),
            "rig.toml:9:28: arm.leader.elbow.velocity_limit_rad_per_s: 20 rad/s is beyond what a DM4310 behind a gear "
            "of 2 can do, 15 rad/s: lower it, or state the model that is there");
  EXPECT_EQ(problem_of(with("upper_rad = 1.5", "upper_rad = -1.5")),
            "rig.toml:8:13: arm.leader.elbow.upper_rad: -1.5 rad must be above lower_rad, -1.5 rad");
}

TEST(Rig, PositionsInDegreesAreRefusedWithTheRangeAndTheRemedy) {
  const auto with = [](const std::string& side, const std::string& text, const std::string& line,
                       const std::string& other) {
    std::string whole = side + text;
    whole.replace(whole.find(line), line.size(), other);
    return problem_of(whole);
  };
  const std::string damiao = damiao_side("arm.leader", "/dev/a"), elbow = joint("arm.leader.elbow", 1, "DM4310");
  // The page: the position of a DM4310 ends at 12.5 rad.
  EXPECT_EQ(with(damiao, elbow, "upper_rad = 1.5", "upper_rad = 170.0"),
            "rig.toml:8:13: arm.leader.elbow.upper_rad: 170 rad is beyond where a joint with a DM4310 can be, from "
            "-12.5 to 12.5 rad: state it in rad (170 degrees are 2.9671 rad)");
  EXPECT_EQ(with(damiao, elbow, "lower_rad = -1.5", "lower_rad = -170.0"),
            "rig.toml:7:13: arm.leader.elbow.lower_rad: -170 rad is beyond where a joint with a DM4310 can be, from "
            "-12.5 to 12.5 rad: state it in rad (-170 degrees are -2.9671 rad)");
  EXPECT_EQ(with(damiao, elbow, "upper_rad = 1.5", "upper_rad = 12.5"), "");
  EXPECT_NE(with(damiao, elbow, "upper_rad = 1.5", "upper_rad = 12.51"), "");
  // Behind a gear it goes less far, and where the motor is mounted moves its range.
  EXPECT_NE(with(damiao, elbow, "upper_rad = 1.5", "upper_rad = 6.5\ngear = 2.0"), "");
  EXPECT_EQ(with(damiao, elbow, "upper_rad = 1.5", "upper_rad = 6.5\ngear = 2.0\noffset_rad = 0.5"), "");
  EXPECT_NE(with(damiao, elbow, "lower_rad = -1.5", "lower_rad = -6.0\ngear = 2.0\noffset_rad = 0.5"), "");
  EXPECT_EQ(with(damiao, elbow, "upper_rad = 1.5", "upper_rad = 1.5\noffset_rad = 90.0"),
            "rig.toml:9:14: arm.leader.elbow.offset_rad: 90 rad is beyond where a joint with a DM4310 can be, from -25 "
            "to 25 rad: state it in rad (90 degrees are 1.5708 rad)");
  const std::string servos = "[arm.leader]\nbus = \"dynamixel\"\nport = \"/dev/a\"\n";
  EXPECT_NE(
      with(servos, joint("arm.leader.elbow", 1, "xm430-w210"), "upper_rad = 1.5", "upper_rad = 90.0")
          .find("upper_rad: 90 rad is beyond where a joint with a xm430-w210 can be, from -12.5664 to 12.5664 rad: "
                "state it in rad (90 degrees are 1.5708 rad)"),
      std::string::npos);
  // At the end of a lever of 0.1 m, in millimetres.
  const std::string lever =
      "[arm.leader.elbow]\nmotor = 1\nmodel = \"DM4310\"\nlever_m = 0.1\nlower_m = -0.1\nupper_m = "
      "5.0\nvelocity_limit_m_per_s = 1.0\nforce_limit_N = 2.0\nforce_rate_limit_N_per_s = 50.0\n";
  EXPECT_NE(problem_of(damiao + lever)
                .find("upper_m: 5 m is beyond where a joint with a DM4310 can be, from -1.25 to "
                      "1.25 m: state it in m (5 mm are 0.005 m)"),
            std::string::npos)
      << problem_of(damiao + lever);
}

TEST(Rig, AStiffnessThatItsMotorCannotRunIsRefused) {
  const std::string damiao = damiao_side("arm.leader", "/dev/a");
  const auto with = [&damiao](const std::string& more) {
    return problem_of(damiao + joint("arm.leader.elbow", 1, "DM4310", more));
  };
  // The page: 500 N m/rad and 5 N m s/rad at the motor; about a joint the square of the gear as much.
  EXPECT_EQ(with("stiffness_limit_Nm_per_rad = 500.0\ndamping_limit_Nms_per_rad = 5.0\n"), "");
  EXPECT_EQ(with("stiffness_limit_Nm_per_rad = 2000.0\ngear = 2.0\n"), "");
  EXPECT_EQ(with("stiffness_limit_Nm_per_rad = 501.0\n"),
            "rig.toml:12:30: arm.leader.elbow.stiffness_limit_Nm_per_rad: 501 N m/rad is beyond what a DM4310 can do, "
            "500 N m/rad: lower it, or state the model that is there");
  EXPECT_EQ(with("damping_limit_Nms_per_rad = 21.0\ngear = 2.0\n"),
            "rig.toml:12:29: arm.leader.elbow.damping_limit_Nms_per_rad: 21 N m s/rad is beyond what a DM4310 behind a "
            "gear of 2 can do, 20 N m s/rad: lower it, or state the model that is there");
  const std::string servos = "[arm.leader]\nbus = \"dynamixel\"\nport = \"/dev/a\"\n" +
                             joint("arm.leader.elbow", 1, "xm430-w210", "damping_limit_Nms_per_rad = 0.1\n");
  EXPECT_EQ(
      problem_of(servos),
      "rig.toml:12:29: arm.leader.elbow.damping_limit_Nms_per_rad: a xm430-w210 runs no law by itself: remove this "
      "key");
}

TEST(Rig, APortOfTwoSidesIsRefusedByWhateverNameItGoes) {
  const auto folder = scratch_path();
  std::filesystem::create_directories(folder);
  const std::string link = (folder / "link").string();
  std::filesystem::create_symlink("/dev/null", link);
  const auto both = [](const std::string& first, const std::string& second) {
    return damiao_side("arm.leader", first) + joint("arm.leader.elbow", 1, "DM4310") +
           damiao_side("arm.follower", second) + joint("arm.follower.elbow", 1, "DM4310");
  };
  EXPECT_EQ(problem_of(both("/dev/null", "/dev/zero")), "");
  EXPECT_EQ(problem_of(both("/dev/null", "/dev/null")),
            "rig.toml:14:8: arm.follower.port: '/dev/null' is the port of arm.leader too: leader and follower each "
            "have a bus of their own");
  EXPECT_NE(problem_of(both("/dev/null", link)).find("is the port of arm.leader too, by another name: "),
            std::string::npos);
  std::filesystem::remove_all(folder);
}

TEST(Rig, AJointWithoutItsLikeIsRefusedAndOneSideAloneIsNot) {
  const std::string leader = damiao_side("arm.leader", "/dev/a") + joint("arm.leader.elbow", 1, "DM4310");
  EXPECT_EQ(problem_of(leader + damiao_side("arm.follower", "/dev/b") + joint("arm.follower.wrist", 1, "DM4310")),
            "rig.toml:4:1: arm.leader.elbow: arm.follower has no joint of this name to be coupled with: write "
            "[arm.follower.elbow], or leave this one out");
  EXPECT_EQ(problem_of(leader), "");
  std::string three;
  for (const char* pair : {"a", "b", "c"}) {
    const std::string path = std::string(pair) + ".leader";
    three += damiao_side(path, std::string("/dev/") + pair) + joint(path + ".elbow", 1, "DM4310");
  }
  EXPECT_NE(problem_of(three).find("there are 3 pairs in it: a rig has one or two"), std::string::npos);
}

TEST(Rig, ServosHaveTheirOwnKeys) {
  const std::string sts =
      "[arm.leader]\nbus = \"feetech\"\nport = \"/dev/a\"\n[arm.leader.elbow]\nmotor = 1\nmodel = \"sts3215\"\n"
      "lower_rad = 0.0\nupper_rad = 3.0\nvelocity_limit_rad_per_s = 5.0\n";
  const auto rig = Rig::parse(sts, "rig.toml");
  ASSERT_TRUE(rig) << describe(rig.error());
  const MotorJoint& joint = rig->pairs()[0].leader->joints[0].joint;
  EXPECT_FALSE(joint.gives_force);
  // Nobody may believe that it displays anything.
  EXPECT_LT(joint.limits().force_N, 1e-6);
  EXPECT_GT(joint.limits().force_N, 0.0);
  std::string hls = sts;
  hls.replace(hls.find("sts3215"), 7, "hls3625");
  EXPECT_EQ(problem_of(hls + "torque_limit_Nm = 1.0\ntorque_rate_limit_Nm_per_s = 20.0\n"),
            "rig.toml:4:13: arm.leader.elbow.torque_Nm_per_A: state how much torque a current of this servo gives: its "
            "stall torque over its stall current");
  std::string rate = sts;
  rate.replace(rate.find("[arm.leader.elbow]"), 0, "bits_per_s = 100000\n");
  EXPECT_NE(problem_of(rate).find("rig.toml:4:14: arm.leader.bits_per_s: 100000 bit/s: the servos do 38400"),
            std::string::npos)
      << problem_of(rate);
}

TEST(Rig, AxesOfAnInverse3SlideAndHaveKeysInMetres) {
  const auto axis = [](const std::string& name, int motor, const std::string& force) {
    return "[desk.leader." + name + "]\nmotor = " + std::to_string(motor) +
           "\nmodel = \"inverse3\"\nsign = -1\noffset_m = 0.02\nlower_m = -0.1\nupper_m = 0.1\n"
           "velocity_limit_m_per_s = 1.0\n" +
           force + "force_rate_limit_N_per_s = 50.0\n";
  };
  const std::string side = "[desk.leader]\nbus = \"inverse3\"\nport = \"127.0.0.1:10001\"\ndevice = \"049D\"\n";
  const auto rig = Rig::parse(side + axis("z", 3, "force_limit_N = 2.0\n"), "rig.toml");
  ASSERT_TRUE(rig) << describe(rig.error());
  const RigSide& desk = *rig->pairs()[0].leader;
  EXPECT_EQ(desk.bus.device, "049D");
  EXPECT_EQ(desk.joints[0].joint.torque_limit_Nm, 2.0);
  EXPECT_DOUBLE_EQ(desk.joints[0].joint.position_rad(0.05), -0.03);
  EXPECT_EQ(problem_of(side + axis("z", 3, "")),
            "rig.toml:5:1: desk.leader.z: force_limit_N is needed: write for instance force_limit_N = 1.0 under "
            "[desk.leader.z]");
  EXPECT_EQ(problem_of(side + axis("z", 3, "torque_limit_Nm = 2.0\n"))
                .find("rig.toml:13:1: desk.leader.z.torque_limit_Nm: "
                      "unknown key"),
            0U);
  EXPECT_EQ(
      problem_of(side + axis("z", 4, "force_limit_N = 2.0\n")).find("rig.toml:6:9: desk.leader.z.motor: 4 is out"), 0U);
}

/// An axis in metres has a follower in metres: a motor that turns, at the end of a lever.
TEST(Rig, AJointAtTheEndOfALeverFollowsAnAxisThatSlides) {
  const std::string limits =
      "lower_m = -0.1\nupper_m = 0.1\nvelocity_limit_m_per_s = 1.0\nforce_limit_N = 2.0\n"
      "force_rate_limit_N_per_s = 50.0\n";
  const std::string leader =
      "[desk.leader]\nbus = \"inverse3\"\nport = \"127.0.0.1:10001\"\n[desk.leader.x]\nmotor = 1\n"
      "model = \"inverse3\"\n" +
      limits;
  const auto follower = [](const std::string& keys) {
    return damiao_side("desk.follower", "/dev/b") + "[desk.follower.x]\nmotor = 1\nmodel = \"DM4310\"\n" + keys;
  };
  const auto rig = Rig::parse(leader + follower("lever_m = 0.2\nsign = -1\noffset_m = 0.03\n" + limits), "rig.toml");
  ASSERT_TRUE(rig) << describe(rig.error());
  const RigJoint& one = rig->pairs()[0].follower->joints[0];
  EXPECT_TRUE(one.slides);
  EXPECT_DOUBLE_EQ(one.joint.position_rad(0.5), -0.07);
  EXPECT_DOUBLE_EQ(one.joint.velocity_rad_per_s(0.5), -0.1);
  // No power is made: force times way is torque times angle.
  EXPECT_DOUBLE_EQ(one.joint.motor_torque_Nm(1.5), -0.3);
  EXPECT_DOUBLE_EQ(one.joint.torque_Nm(-0.3), 1.5);
  // Without it radians would be taken for metres.
  const std::string turning =
      "lower_rad = -1.5\nupper_rad = 1.5\nvelocity_limit_rad_per_s = 3.0\ntorque_limit_Nm = 2.0\n"
      "torque_rate_limit_Nm_per_s = 50.0\n";
  EXPECT_EQ(
      problem_of(leader + follower(turning)),
      "rig.toml:15:1: desk.follower.x: it is in rad, and desk.leader.x in m: for the joint that turns, state lever_m "
      "(its displacement in m per radian of the motor), and limits in m and N");
  EXPECT_NE(problem_of(leader + follower("lever_m = 20.0\n" + limits)).find("desk.follower.x.lever_m: 20"),
            std::string::npos);
  EXPECT_NE(problem_of(leader + follower("lever_m = 0.2\n" + turning)).find("lower_rad: unknown key"),
            std::string::npos);
  const std::string strong = "lever_m = 9.0\n" + limits;
  EXPECT_NE(problem_of(leader + follower(strong)).find("2 N is beyond what a DM4310 with a lever of 9 m can do, "),
            std::string::npos)
      << problem_of(leader + follower(strong));
  EXPECT_NE(problem_of(damiao_side("desk.follower", "/dev/b") +
                       "[desk.follower.x]\nmotor = 1\nmodel = \"DM4310\"\nlever_m = 0.2\n" + limits +
                       joint("desk.follower.y", 2, "DM4310"))
                .find("desk.follower.y: it is in rad, and desk.follower.x in m: state lever_m of all joints of a side"),
            std::string::npos);
}

TEST(Rig, APartIsFoundByItsName) {
  const auto rig = Rig::parse(pair_of_two, "rig.toml");
  ASSERT_TRUE(rig);
  EXPECT_EQ(rig->sides()->size(), 2U);
  EXPECT_EQ(rig->sides("arm")->size(), 2U);
  ASSERT_EQ(rig->sides("arm.follower.elbow")->size(), 1U);
  EXPECT_EQ(rig->sides("arm.follower.elbow").value()[0]->path, "arm.follower");
  // No part of a name is a name.
  EXPECT_FALSE(rig->sides("arm.follow"));
  EXPECT_EQ(describe(rig->sides("leg").error()),
            "'leg' is no part of the rig: its joints are arm.leader.shoulder, arm.leader.elbow, "
            "arm.follower.shoulder, arm.follower.elbow");
}

}  // namespace rig_test
}  // namespace tactus::devices
