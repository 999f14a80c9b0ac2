// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/rig/pose_guide.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <tests/devices/rig/arms_bench.hpp>

namespace tactus::devices {
namespace pose_guide_test {

using arm::JointVector;

constexpr Eigen::Index joints = 7;
/// How far from its pose a hand leaves a joint, at most.
constexpr double hand_rad = 0.1;

arm::Chain::Params openarm() { return rig_arms_test::setup_of().leader.arm.chain; }

/// What the motors of an arm read that a hand has moved there: joint = sign·(motor of joint)/gear + offset.
struct WrongRig {
  JointVector scale = JointVector::Ones(joints);
  JointVector offset = JointVector::Zero(joints);
  std::vector<Eigen::Index> motor_of{0, 1, 2, 3, 4, 5, 6};

  std::vector<JointVector> read(const std::vector<JointVector>& poses, signal::Random& random) const {
    std::vector<JointVector> all;
    for (const JointVector& pose : poses) {
      JointVector read(joints);
      for (Eigen::Index i = 0; i < joints; ++i) {
        const double at_rad = pose[motor_of[static_cast<std::size_t>(i)]] + random.uniform(-hand_rad, hand_rad);
        read[i] = scale[i] * at_rad + offset[i];
      }
      all.push_back(read);
    }
    return all;
  }
};

TEST(PoseGuide, ItsPosesAreWithinTheLimitsAndTurnEachJointFar) {
  const auto arm = openarm();
  const auto poses = guide_poses(arm);
  ASSERT_EQ(poses.size(), 3U);
  for (Eigen::Index i = 0; i < joints; ++i) {
    const auto& limits = arm.joints[static_cast<std::size_t>(i)].limits;
    double turned_rad = 0.0;
    for (const JointVector& pose : poses) {
      EXPECT_GE(pose[i], limits.lower_rad);
      EXPECT_LE(pose[i], limits.upper_rad);
      turned_rad = std::max(turned_rad, std::fabs(pose[i] - poses[0][i]));
    }
    EXPECT_GT(turned_rad, 0.6) << i;
  }
}

TEST(PoseGuide, TwoHundredRightRigsAreNotRefused) {
  const auto poses = guide_poses(openarm());
  signal::Random random(1);
  for (int rig = 0; rig < 200; ++rig) {
    for (const GuideFinding& found : judge_poses(poses, WrongRig{}.read(poses, random))) {
      EXPECT_EQ(found.fault, GuideFault::none) << rig << ": " << found.read_rad << " for " << found.expected_rad;
    }
  }
}

TEST(PoseGuide, TwoHundredWrongRigsAreFoundAtTheJointThatIsWrong) {
  const auto poses = guide_poses(openarm());
  signal::Random random(2);
  const auto expect = [&](const WrongRig& wrong, Eigen::Index joint, GuideFault fault) {
    const auto all = judge_poses(poses, wrong.read(poses, random));
    for (Eigen::Index i = 0; i < joints; ++i) {
      const bool of_another = fault == GuideFault::swapped && i == joint + 1;
      const GuideFault expected = i == joint || of_another ? fault : GuideFault::none;
      EXPECT_EQ(all[static_cast<std::size_t>(i)].fault, expected) << i << " for " << joint;
    }
    if (fault == GuideFault::swapped) {
      EXPECT_EQ(all[static_cast<std::size_t>(joint)].other, static_cast<std::size_t>(joint + 1));
    }
  };
  for (int rig = 0; rig < 200; ++rig) {
    WrongRig wrong;
    const auto joint = static_cast<Eigen::Index>(random.bits() % static_cast<std::uint64_t>(joints));
    const double sign = random.uniform() < 0.5 ? -1.0 : 1.0;
    switch (rig % 5) {
      case 0:
        wrong.scale[joint] = -1.0;
        expect(wrong, joint, GuideFault::direction);
        break;
      case 1:
        wrong.offset[joint] = sign * random.uniform(0.4, std::numbers::pi);
        expect(wrong, joint, GuideFault::zero);
        break;
      case 2:
        wrong.scale[joint] = random.uniform() < 0.5 ? random.uniform(0.35, 0.5) : random.uniform(2.0, 10.0);
        expect(wrong, joint, GuideFault::gear);
        break;
      case 3: {
        const Eigen::Index first = joint % (joints - 1);
        std::swap(wrong.motor_of[static_cast<std::size_t>(first)], wrong.motor_of[static_cast<std::size_t>(first + 1)]);
        expect(wrong, first, GuideFault::swapped);
        break;
      }
      default:
        wrong.scale[joint] = 0.0;
        wrong.offset[joint] = 0.05;
        expect(wrong, joint, GuideFault::unmoved);
    }
  }
}

}  // namespace pose_guide_test
}  // namespace tactus::devices
