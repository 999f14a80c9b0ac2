// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/urdf/urdf.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/arm/mujoco_arm.hpp"
#include "tests/arm/random_arm.hpp"
#include "tests/scratch_path.hpp"
#include <gtest/gtest.h>

namespace tactus::urdf {
namespace {

using arm::JointVector;

class Urdf : public ::testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(file_); }
  Result<Arm> read_text(const std::string& text, const std::string& tip = {}) {
    std::ofstream(file_) << text;
    return read(file_, tip);
  }
  /// What the reader complains of.
  std::string complaint(const std::string& text, const std::string& tip = {}) {
    const Result<Arm> arm = read_text(text, tip);
    return arm ? "nothing" : describe(arm.error());
  }
  const std::string file_ = scratch_path().string() + ".urdf";
};

std::string link(const std::string& name,
                 const std::string& numbers = "1.5 0.1 0.2 0.3 0.02 0.03 0.04 0.001 0.002 0.003",
                 const std::string& rpy = "0.1 0.2 0.3") {
  double n[10];
  std::istringstream(numbers) >> n[0] >> n[1] >> n[2] >> n[3] >> n[4] >> n[5] >> n[6] >> n[7] >> n[8] >> n[9];
  std::ostringstream text;
  text << "<link name='" << name
       << "'>\n<visual><geometry><mesh filename='package://none/it.stl'/></geometry></visual>\n"
       << "<inertial><mass value='" << n[0] << "'/><origin xyz='" << n[1] << " " << n[2] << " " << n[3] << "' rpy='"
       << rpy << "'/>\n<inertia ixx='" << n[4] << "' iyy='" << n[5] << "' izz='" << n[6] << "' ixy='" << n[7]
       << "' ixz='" << n[8] << "' iyz='" << n[9] << "'/></inertial></link>\n";
  return text.str();
}

std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child,
                  const std::string& rest = "") {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" + child +
         "'/><origin xyz='0.1 -0.2 0.3' rpy='0.4 -0.5 0.6'/>" + rest + "</joint>\n";
}

std::string robot(const std::string& inside) {
  return "<?xml version='1.0'?>\n<robot name='test'>\n" + inside + "</robot>\n";
}

/// Three joints that move; a tool and a flange fixed behind, one of them without a body.
std::string arm_text() {
  return robot(link("base") + link("one") + link("two") + link("three") + "<link name='flange'/>\n" + link("tool") +
               joint("j1", "revolute", "base", "one",
                     "<axis xyz='0 0 2'/><limit lower='-1' upper='2' velocity='3' effort='40'/>") +
               joint("j2", "prismatic", "one", "two", "<axis xyz='1 1 0'/><dynamics damping='0.5' friction='0.25'/>") +
               joint("j3", "continuous", "two", "three") + joint("to_flange", "fixed", "three", "flange") +
               joint("to_tool", "fixed", "flange", "tool"));
}

TEST_F(Urdf, AnArmHasTheMassMatrixAndTorquesThatMuJoCoReadsFromTheSameFile) {
  const std::string mujoco_section = "<mujoco><compiler balanceinertia='false' discardvisual='true'/></mujoco>\n";
  std::string text = arm_text();
  text.insert(text.find("<link"), mujoco_section);
  // MuJoCo reads meshes, and welds what is fixed; damping and friction are not what is compared.
  for (std::string_view visual = "<visual>"; text.find(visual) != std::string::npos;) {
    const std::size_t from = text.find(visual);
    text.erase(from, text.find("</visual>") + 9 - from);
  }
  const std::size_t dynamics = text.find("<dynamics");
  text.erase(dynamics, text.find("/>", dynamics) + 2 - dynamics);
  const Result<Arm> own = read_text(text);
  ASSERT_TRUE(own) << describe(own.error());
  arm::MuJoCoArm foreign(file_);
  ASSERT_TRUE(foreign) << foreign.complaint();
  ASSERT_EQ(foreign.joints(), 3);
  foreign.set_gravity({0.0, 0.0, -9.81});
  const arm::Chain chain = *arm::Chain::make(own->params);
  arm::RandomArm random(5);
  for (int i = 0; i < 20; ++i) {
    const JointVector q = random.vector(3, 2.0);
    const JointVector v = random.vector(3, 2.0);
    const JointVector a = random.vector(3, 20.0);
    EXPECT_LT(arm::apart(Eigen::MatrixXd(chain.mass_matrix(q)), foreign.mass_matrix(q)), 1e-7);
    EXPECT_LT(arm::apart(Eigen::VectorXd(chain.inverse_dynamics(q, v, a)), foreign.inverse_dynamics(q, v, a)), 1e-7);
  }
}

TEST_F(Urdf, NamesLimitsAndFrictionAreTakenOver) {
  const Result<Arm> arm = read_text(arm_text());
  ASSERT_TRUE(arm) << describe(arm.error());
  EXPECT_EQ(arm->name, "test");
  EXPECT_EQ(arm->base, "base");
  EXPECT_EQ(arm->joints, (std::vector<std::string>{"j1", "j2", "j3"}));
  EXPECT_EQ(arm->links, (std::vector<std::string>{"one", "two", "three"}));
  EXPECT_EQ(arm->params.joints[0].limits.lower_rad, -1.0);
  EXPECT_EQ(arm->params.joints[0].limits.effort_N_m, 40.0);
  EXPECT_EQ(arm->params.joints[1].kind, arm::JointKind::prismatic);
  EXPECT_EQ(arm->params.joints[1].friction.viscous_N_m_s_per_rad, 0.5);
  EXPECT_EQ(arm->params.joints[1].friction.coulomb_N_m, 0.25);
  EXPECT_EQ(arm->params.joints[2].axis.x, 1.0);  // URDF's own default
  EXPECT_EQ(arm->params.joints[2].body.mass_kg, 3.0);
  ASSERT_EQ(arm->frames.size(), 3U);
  EXPECT_EQ(arm->frames[0].size(), 1U);
  ASSERT_EQ(arm->frames[2].size(), 3U);
  EXPECT_EQ(arm->frames[2][1].name, "flange");
  EXPECT_NEAR(arm->frames[2][1].origin_m.z(), 0.3, 1e-15);  // as `joint` places it
}

TEST_F(Urdf, OtherDynamicsReadBackAndAllElseStays) {
  const std::string text = arm_text();
  Result<Arm> arm = read_text(text);
  ASSERT_TRUE(arm) << describe(arm.error());
  arm::RandomArm random(9);
  for (arm::JointParams& joint : arm->params.joints) {
    joint.body = random.body();
    joint.friction = {.coulomb_N_m = random.between(0.0, 1.0), .viscous_N_m_s_per_rad = random.between(0.0, 1.0)};
  }
  const Result<std::string> made = with_dynamics(file_, *arm, "of a test");
  ASSERT_TRUE(made) << describe(made.error());
  EXPECT_NE(made->find("<!-- of a test -->"), std::string::npos);
  const Result<Arm> back = read_text(*made);
  ASSERT_TRUE(back) << describe(back.error());
  EXPECT_EQ(back->joints, arm->joints);
  EXPECT_EQ(back->links, arm->links);
  EXPECT_EQ(back->params.joints[0].limits.effort_N_m, 40.0);
  const arm::Chain written = *arm::Chain::make(arm->params);
  const arm::Chain read = *arm::Chain::make(back->params);
  for (int i = 0; i < 20; ++i) {
    const JointVector q = random.vector(3, 2.0);
    const JointVector v = random.vector(3, 2.0);
    const JointVector a = random.vector(3, 20.0);
    EXPECT_LT(arm::apart(Eigen::VectorXd(read.motor_torque(q, v, a)), Eigen::VectorXd(written.motor_torque(q, v, a))),
              1e-12);
  }
  const auto count = [](const std::string& in, std::string_view word) {
    int found = 0;
    for (std::size_t at = in.find(word); at != std::string::npos; at = in.find(word, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count(*made, "<mesh"), count(text, "<mesh"));
  EXPECT_EQ(count(*made, "<inertial>"), 4);  // the base's, which does not move, and one for each joint
}

TEST_F(Urdf, AGripperIsLeftOutByTheNameOfTheTip) {
  std::string text = arm_text();
  text.insert(text.find("</robot>"), link("left") + link("right") + joint("finger", "prismatic", "tool", "left") +
                                         joint("other", "prismatic", "tool", "right", "<mimic joint='finger'/>"));
  EXPECT_NE(complaint(text).find("branches"), std::string::npos) << complaint(text);
  EXPECT_NE(complaint(text).find("--tip"), std::string::npos);
  const Result<Arm> arm = read_text(text, "tool");
  ASSERT_TRUE(arm) << describe(arm.error());
  EXPECT_EQ(arm->joints.size(), 3U);
  EXPECT_EQ(arm->params.joints[2].body.mass_kg, 6.0);  // the fingers ride along
  EXPECT_NE(complaint(text, "tolo").find("'tolo'"), std::string::npos);
}

TEST_F(Urdf, WhatIsWrongIsSaidWithItsLineNameAndRemedy) {
  struct Case {
    std::string text;
    std::vector<std::string> said;
  };
  const std::string plain = joint("j", "revolute", "a", "b");
  const std::string a = link("a");
  std::string nine = link("l0");
  for (int i = 1; i <= 9; ++i) {
    const std::string n = std::to_string(i);
    nine += link(std::string("l") + n) + joint(std::string("j") + n, "revolute", "l" + std::to_string(i - 1), "l" + n);
  }
  const std::vector<Case> cases{
      {robot(a + "<link name='b'/>\n" + plain), {":7:", "'b'", "'j'", "<inertial>", "add"}},
      {robot(nine), {"j9", "ninth", "--tip"}},
      {robot(a + link("b") + joint("j", "revolute", "a", "b", "<mimic joint='k'/>")), {"'j'", "mimics"}},
      {robot(a + link("b") + joint("j", "floating", "a", "b")), {"'j'", "'floating'", "revolute"}},
      {robot(a + link("b") + joint("j", "planar", "a", "b")), {"'j'", "'planar'"}},
      {robot(a + link("b") + joint("j", "revolute", "a", "b", "<axis xyz='0 0 0'/>")), {"'j'", "axis"}},
      {robot(a + link("b") + joint("j", "revolute", "a", "b", "<axis xyz='0 one 0'/>")), {"'one'", "not a number"}},
      {robot(a + link("b") + joint("j", "revolute", "a", "b", "<axis xyz='0 1'/>")), {"2 numbers where 3"}},
      {robot(a + link("b") + joint("j", "revolute", "a", "b", "<axis xyz='0 nan 1'/>")), {"not finite"}},
      {robot(a + link("b") + joint("j", "revolute", "a", "c")), {"'c'", "'j'", "add the link"}},
      {robot(a + link("b")), {"'a' and 'b'", "child of no joint"}},
      {robot(a + a), {"two links 'a'"}},
      {robot(a + link("b") + plain + plain), {"two joints 'j'"}},
      {robot(a + link("b") + plain + joint("k", "revolute", "b", "a")), {"circle"}},
      {robot(a), {"no joint that moves"}},
      {robot(a + link("b", "-2 0 0 0 1 1 1 0 0 0") + plain), {"-2 kg", "'b'", "at least 0 kg"}},
      {robot(a + link("b", "1 0 0 0 0.1 0.1 0.5 0 0 0") + plain), {"'b'", "no body has this inertia"}},
      {robot(a + link("b", "1 0 0 0 -0.1 0.1 0.1 0 0 0") + plain), {"'b'", "-0.1"}},
      {"<sdf/>", {"<robot>"}},
      {"", {"whole XML"}},
      {robot("<xacro:include filename='x'/>" + a), {"xacro"}},
  };
  for (const Case& c : cases) {
    const std::string told = complaint(c.text);
    for (const std::string& words : c.said) EXPECT_NE(told.find(words), std::string::npos) << words << " in " << told;
    EXPECT_EQ(told.rfind(file_, 0), 0U) << told;
  }
  EXPECT_EQ(read("no/such.urdf").error().code, ErrorCode::missing);
}

TEST_F(Urdf, XacroInACommentOrATextDoesNoHarmAndAnElementOfItIsNamedWithItsLine) {
  std::string text = arm_text();
  text.insert(text.find("</robot>"),
              "<!-- <xacro:gripper name='j1'/> -->\n<note>run &lt;xacro:arm&gt;</note>\n"
              "<transmission><!-- <xacro:x/> --></transmission>\n");
  const Result<Arm> arm = read_text(text);
  ASSERT_TRUE(arm) << describe(arm.error());
  EXPECT_EQ(arm->joints.size(), 3U);
  text.insert(text.find("</robot>"), "<gazebo>\n<xacro:property name='a'/></gazebo>\n");
  const std::string told = complaint(text);
  EXPECT_NE(told.find("<xacro:property>"), std::string::npos) << told;
  EXPECT_NE(told.find(".urdf:"), std::string::npos) << told;
}

TEST_F(Urdf, AnImpossibleBodyThatMovesNoJointIsWarnedOfAndDoesNotCount) {
  for (const char* numbers :
       {"1e-6 0 0 0 1e-6 1e-6 1e-6 1e-6 1e-6 1e-6", "-1 0 0 0 1 1 1 0 0 0", "1 0 0 0 1 1 9 0 0 0"}) {
    // The body of the base, and one that is fixed to it.
    for (const bool fixed : {false, true}) {
      const std::string base =
          fixed ? "<link name='base'/>" + link("stand", numbers) + joint("to_stand", "fixed", "base", "stand")
                : link("base", numbers);
      const Result<Arm> arm = read_text(robot(base + link("one") + joint("j1", "continuous", "base", "one")));
      ASSERT_TRUE(arm) << numbers << describe(arm.error());
      ASSERT_EQ(arm->warnings.size(), 1U) << numbers;
      EXPECT_NE(arm->warnings[0].find(fixed ? "'stand'" : "'base'"), std::string::npos) << arm->warnings[0];
      EXPECT_NE(arm->warnings[0].find(".urdf:"), std::string::npos) << arm->warnings[0];
      EXPECT_NEAR(arm->params.joints[0].body.mass_kg, 1.5, 1e-12);
    }
    EXPECT_NE(complaint(robot(link("base") + link("one", numbers) + joint("j1", "continuous", "base", "one"))),
              "nothing");
  }
  EXPECT_TRUE(read_text(arm_text())->warnings.empty());
}

TEST_F(Urdf, LimitsThatCannotBeAreNamedWithTheirJoint) {
  const auto with_limit = [&](const std::string& limit, const std::string& type = "revolute") {
    return robot(link("base") + link("one") + joint("j1", type, "base", "one", limit));
  };
  const std::string reversed = complaint(with_limit("<limit lower='1' upper='-1' effort='10' velocity='3'/>"));
  for (const char* words : {"'j1'", "lower=1", "upper=-1", "exchange"}) {
    EXPECT_NE(reversed.find(words), std::string::npos) << words << " in " << reversed;
  }
  struct Case {
    const char* limit;
    std::vector<std::string> said;
  };
  for (const Case& c :
       {Case{"<limit lower='-1' upper='1' effort='0' velocity='3'/>", {"'j1' has an effort limit of 0 N m"}},
        Case{"<limit lower='-1' upper='1' effort='1' velocity='0'/>", {"'j1' has a velocity limit of 0 rad/s"}},
        Case{"<limit lower='0' upper='0' effort='1' velocity='3'/>", {"'j1' has a range from 0 to 0 rad"}},
        Case{"<limit lower='0' upper='0' effort='0' velocity='0'/>", {"range", "effort", "velocity"}},
        Case{"<limit effort='1' velocity='3'/>", {"'j1' states no range"}}, Case{"", {"'j1' states no range"}},
        Case{"<limit lower='-1' upper='1' effort='1' velocity='3'/>", {}}}) {
    const Result<Arm> arm = read_text(with_limit(c.limit));
    ASSERT_TRUE(arm) << c.limit << describe(arm.error());
    ASSERT_EQ(arm->doubtful_limits.size(), c.said.size()) << c.limit;
    for (std::size_t i = 0; i < c.said.size(); ++i) {
      EXPECT_NE(arm->doubtful_limits[i].find(c.said[i]), std::string::npos) << arm->doubtful_limits[i];
    }
    EXPECT_GT(arm->params.joints[0].limits.effort_N_m, 0.0);
    EXPECT_LT(arm->params.joints[0].limits.lower_rad, arm->params.joints[0].limits.upper_rad);
  }
  EXPECT_TRUE(read_text(with_limit("<limit effort='1' velocity='3'/>", "continuous"))->doubtful_limits.empty());
  EXPECT_EQ(read_text(with_limit("<limit upper='1' effort='1' velocity='3'/>"))->params.joints[0].limits.lower_rad,
            0.0);
}

/// Neither a file that is cut off nor one in which a letter is another one ends the program.
TEST_F(Urdf, DamagedFilesAreReadOrRefused) {
  const std::string whole = arm_text();
  for (std::size_t length = 0; length < whole.size(); length += 7) {
    const Result<Arm> arm = read_text(whole.substr(0, length));
    EXPECT_FALSE(arm) << length;
    EXPECT_FALSE(!arm && describe(arm.error()).empty());
  }
  arm::RandomArm random(2);
  int read_anyway = 0;
  for (int i = 0; i < 500; ++i) {
    std::string text = whole;
    for (int k = 0; k < 3; ++k) {
      text[static_cast<std::size_t>(random.between(0.0, static_cast<double>(text.size()) - 0.5))] =
          static_cast<char>(random.between(1.0, 126.0));
    }
    read_anyway += read_text(text) ? 1 : 0;
  }
  EXPECT_LT(read_anyway, 500);
  std::string deep;
  for (int i = 0; i < 5000; ++i) deep += "<link>";
  EXPECT_FALSE(read_text("<robot>" + deep));
  EXPECT_FALSE(read_text("<robot>" + std::string(std::size_t{5} << 20U, ' ') + "</robot>"));
}

}  // namespace
}  // namespace tactus::urdf
