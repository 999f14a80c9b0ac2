// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/support_words.hpp>

#include <gtest/gtest.h>

namespace tactus::cli {
namespace {

using control::SupportFault;
using control::SupportFinding;

std::string said(const SupportFinding& found) {
  devices::RigJoint joint;
  joint.path = "arm.leader.joint_2";
  return words_of(found, joint);
}

TEST(SupportWords, AWeightBeyondTheLimitIsStatedBesideIt) {
  EXPECT_EQ(
      said({.fault = SupportFault::weight, .weight_N = -8123.4, .limit_N = 15.0}),
      "; arm.leader.joint_2 would bear a gravity torque of 8123 N m by the URDF, and its limit is 15 N m: not "
      "powered; look at the URDF's units (m, kg), masses and zero positions, or raise torque_limit_Nm, the gate's "
      "force_limit_N or the URDF's effort");
}

TEST(SupportWords, AJointThatMovesIsStatedWithItsMotionAndTheLikelyCause) {
  const SupportFinding rises{.fault = SupportFault::force,
                             .joint = 1,
                             .share = 0.71,
                             .moved_m = 0.0123,
                             .speed_m_per_s = 0.084,
                             .excess_N = 2.53,
                             .weight_N = 11.6,
                             .limit_N = 15.0};
  EXPECT_EQ(
      said(rises),
      "; arm.leader.joint_2 moved by 12.3 mrad at 0.08 rad/s with 71 % of gravity compensation, whose torque there "
      "is wrong by about 2.53 N m of 12 N m, against gravity: the URDF overstates the weight (units, masses), or a "
      "joint counts the other way (sign) or is swapped with another; all joints were released");
  SupportFinding sinks = rises;
  sinks.excess_N = -2.53;
  EXPECT_NE(said(sinks).find("as gravity pulls: the URDF understates the weight"), std::string::npos) << said(sinks);
  SupportFinding aside = rises;
  aside.weight_N = 0.1;
  EXPECT_NE(said(aside).find("by the URDF it bears next to no weight: joints are swapped"), std::string::npos)
      << said(aside);
  EXPECT_EQ(said({}), "");
}

}  // namespace
}  // namespace tactus::cli
