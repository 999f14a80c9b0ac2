// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/arm/fit.hpp>

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tests/arm_identification/exact_arm.hpp"
#include <gtest/gtest.h>

namespace tactus::arm_identification {
namespace {

std::vector<std::string> joint_names(std::size_t joints) {
  std::vector<std::string> all;
  for (std::size_t j = 1; j <= joints; ++j) all.push_back("j" + std::to_string(j));
  return all;
}

/// An exact recording of an arm by another library's dynamics, with efforts of a stated unit.
ArmRecording recording_of(const arm::Chain::Params& truth, std::uint64_t seed, const std::string& effort_unit = "N m") {
  const Samples samples = exact_motion(truth, {.seed = seed, .rate_Hz = 200.0});
  ArmRecording recording{.file = "simulated.csv",
                         .position_names = joint_names(truth.joints.size()),
                         .effort_names = joint_names(truth.joints.size()),
                         .effort_unit = effort_unit,
                         .sample_time = Seconds{samples.time_s[1]}};
  recording.position = samples.position;
  recording.velocity = samples.velocity;
  recording.effort = samples.torque;
  return recording;
}

void reverse(arm::Chain::Params& params, std::size_t joint) {
  arm::JointAxis& axis = params.joints[joint].axis;
  axis = {-axis.x, -axis.y, -axis.z};
}

/// Two joints in a vertical plane, as many small arms have: bodies of 2 and 0.2 kg.
arm::Chain::Params planar_arm() {
  arm::Chain::Params params{.joints = Joints<arm::JointParams>(2), .gravity = {0.0, 0.0, -9.81}};
  params.joints[1].origin = {.x_m = 0.3};
  params.joints[0].body = {2.0, 0.15, 0.0, 0.0, 0.002, 0.02, 0.02, 0.0, 0.0, 0.0};
  params.joints[1].body = {0.2, 0.1, 0.0, 0.0, 0.0002, 0.001, 0.001, 0.0, 0.0, 0.0};
  for (arm::JointParams& joint : params.joints) {
    joint.axis = {0.0, 1.0, 0.0};
    joint.drive.armature_kg_m2 = 0.01;
    joint.friction = {.coulomb_N_m = 0.05, .viscous_N_m_s_per_rad = 0.03, .velocity_scale_rad_per_s = 0.02};
  }
  return params;
}

/// What `identify_arm` refuses with, or nothing.
std::string refused_with(const arm::Chain::Params& truth, const arm::Chain::Params& urdf, std::uint64_t seed = 1,
                         const std::string& effort_unit = "N m") {
  const auto found =
      identify_arm(std::array{recording_of(truth, seed, effort_unit)}, joint_names(truth.joints.size()), urdf);
  return found ? "nothing" : describe(found.error());
}

::testing::AssertionResult has(const std::string& text, const std::string& words) {
  if (text.find(words) != std::string::npos) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "'" << words << "' is not in: " << text;
}

TEST(ArmUrdfCheck, AReversedJointIsNamedWithTheOptionThatReversesIt) {
  arm::Chain::Params urdf = planar_arm();
  reverse(urdf, 1);
  for (const std::string unit : {"N m", ""}) {
    const std::string told = refused_with(planar_arm(), urdf, 1, unit);
    EXPECT_TRUE(has(told, "joint 'j2' counts the other way than the URDF")) << unit;
    EXPECT_TRUE(has(told, "--reverse j2")) << unit;
  }
  // Of seven joints whose masses are off, each in turn. The first turns about an axis that gravity has no part in here.
  for (const std::size_t joint : {1U, 3U, 5U}) {
    arm::Chain::Params wrong = believed(open_arm(), 3);
    reverse(wrong, joint);
    EXPECT_TRUE(has(refused_with(open_arm(), wrong), "--reverse j" + std::to_string(joint + 1)));
  }
}

TEST(ArmUrdfCheck, TheDirectionOfGravityIsNamed) {
  const auto expect = [](const arm::Gravity& gravity, const std::string& words) {
    arm::Chain::Params truth = planar_arm();
    truth.gravity = gravity;
    EXPECT_TRUE(has(refused_with(truth, planar_arm()), words));
  };
  expect({9.81, 0.0, 0.0}, "--gravity 9.81,0,0");
  expect({-9.81, 0.0, 0.0}, "--gravity -9.81,0,0");
  arm::Chain::Params truth = open_arm();
  for (const auto& [gravity, words] :
       std::array<std::pair<arm::Gravity, std::string>, 3>{{{{0.0, 0.0, -9.81}, "--gravity 0,0,-9.81"},
                                                            {{9.81, 0.0, 0.0}, "--gravity 9.81,0,0"},
                                                            {{0.0, 9.81, 0.0}, "--gravity 0,9.81,0"}}}) {
    truth.gravity = gravity;
    EXPECT_TRUE(has(refused_with(truth, believed(open_arm(), 5)), words));
  }
}

TEST(ArmUrdfCheck, GravityIsFoundWithinTwoDegreesOnRequest) {
  arm::Chain::Params truth = open_arm();
  const double tilt = 0.26;  // 15 degrees
  truth.gravity = {9.81 * std::sin(tilt), -9.81 * std::cos(tilt), 0.0};
  const auto found =
      identify_arm(std::array{recording_of(truth, 2)}, joint_names(7), believed(open_arm(), 5), {.free_gravity = true});
  ASSERT_TRUE(found) << describe(found.error());
  const arm::Gravity& gravity = found->model.head.gravity;
  const arm::Vector3 is(gravity.x_m_per_s2, gravity.y_m_per_s2, gravity.z_m_per_s2);
  const arm::Vector3 should(truth.gravity.x_m_per_s2, truth.gravity.y_m_per_s2, truth.gravity.z_m_per_s2);
  EXPECT_LT(std::acos(is.normalized().dot(should.normalized())), 0.035) << text_of(gravity);
}

TEST(ArmUrdfCheck, AMassThatTheUrdfLacksIsFoundWithItsSizeAndStatedTorquesAreBelieved) {
  arm::Chain::Params truth = planar_arm();
  // A tool of 0.4 kg, 0.1 m from the second joint.
  arm::Body& body = truth.joints[1].body;
  body.mass_kg += 0.4;
  const auto found = identify_arm(std::array{recording_of(truth, 1)}, joint_names(2), planar_arm());
  ASSERT_TRUE(found) << describe(found.error());
  EXPECT_FALSE(found->scaled_efforts);
  for (const ArmJointFit& joint : found->joints) EXPECT_NEAR(joint.effort_per_N_m, 1.0, 1e-9);
  ASSERT_TRUE(found->payload);
  EXPECT_NEAR(found->payload->mass_kg, 0.4, 0.04);
  EXPECT_NEAR(found->payload->centre_m.x(), 0.1, 0.01);
  EXPECT_LT(found->payload->left, much_left);
  EXPECT_GT(found->payload->left_without, 0.3);
  EXPECT_TRUE(found->warnings.empty());
}

/// Arms of two to seven joints.
arm::Chain::Params arm_of(std::uint64_t seed) {
  const std::size_t joints = std::array<std::size_t, 4>{2, 4, 6, 7}[seed % 4];
  return joints == 2 ? planar_arm() : joints == 7 ? open_arm() : drawn_arm(seed, joints);
}

TEST(ArmUrdfCheck, OfARightUrdfNothingIsNamed) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const arm::Chain::Params truth = arm_of(seed);
    const auto found = identify_arm(std::array{recording_of(truth, seed)}, joint_names(truth.joints.size()), truth);
    ASSERT_TRUE(found) << seed << ": " << describe(found.error());
    EXPECT_FALSE(found->payload) << seed << ": " << found->payload->mass_kg;
    for (const std::string& warning : found->warnings) ADD_FAILURE() << seed << ": " << warning;
  }
}

TEST(ArmUrdfCheck, WhereAllMassesAreOffByUpToTwentyPercentNoJointAndNoGravityIsNamed) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const arm::Chain::Params truth = arm_of(seed), urdf = believed(truth, seed);
    const auto found = identify_arm(std::array{recording_of(truth, seed)}, joint_names(truth.joints.size()), urdf);
    ASSERT_TRUE(found) << seed << ": " << describe(found.error());
    for (const std::string& warning : found->warnings) ADD_FAILURE() << seed << ": " << warning;
  }
}

TEST(ArmUrdfCheck, ATiltOfFiveDegreesIsNotRefused) {
  arm::Chain::Params truth = planar_arm();
  const double tilt = 0.09;  // 5 degrees
  truth.gravity = {9.81 * std::sin(tilt), 0.0, -9.81 * std::cos(tilt)};
  const auto found = identify_arm(std::array{recording_of(truth, 1)}, joint_names(2), planar_arm());
  ASSERT_TRUE(found) << describe(found.error());
  for (const ArmJointFit& joint : found->joints) EXPECT_LT(joint.relative, much_left);
}

}  // namespace
}  // namespace tactus::arm_identification
