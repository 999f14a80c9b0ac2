// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/rig_drive.hpp>

#include <gtest/gtest.h>

namespace tactus::cli {
namespace {

station::DescribedArm arm_with(const char* urdf, double shoulder_N_m, double elbow_N_m) {
  station::DescribedArm arm;
  arm.urdf = urdf;
  arm.joints = {"shoulder", "elbow"};
  arm.arm.chain.joints = Joints<arm::JointParams>(2);
  arm.arm.chain.joints[0].friction.coulomb_N_m = shoulder_N_m;
  arm.arm.chain.joints[1].friction.coulomb_N_m = elbow_N_m;
  return arm;
}

TEST(UnstatedFriction, NamesTheJointsOfEachUrdfOnce) {
  station::DescribedArms arms;
  arms.leader = arms.follower = arm_with("one.urdf", 0.2, 0.1);
  EXPECT_EQ(unstated_friction(arms), "");
  arms.leader = arms.follower = arm_with("one.urdf", 0.0, 0.0);
  EXPECT_EQ(unstated_friction(arms).find("tactus: one.urdf states no friction for shoulder, elbow: 0 is assumed"), 0U);
  EXPECT_EQ(unstated_friction(arms).find("one.urdf", 12), std::string::npos) << "both arms are of this file";
  arms.follower = arm_with("other.urdf", 0.1, 0.0);
  EXPECT_NE(unstated_friction(arms).find("\ntactus: other.urdf states no friction for elbow: "), std::string::npos);
}

}  // namespace
}  // namespace tactus::cli
