// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm/largest_inertia.hpp>

#include <algorithm>

#include <gtest/gtest.h>
#include <tests/arm/random_arm.hpp>

namespace tactus::arm {
namespace largest_inertia_test {

/// The largest inertia of each joint that so many random poses within the limits have.
JointVector found_at_random(const Chain::Params& params, RandomArm& random, int poses) {
  const auto chain = Chain::make(params).value();
  JointVector largest = JointVector::Zero(chain.joints());
  for (int pose = 0; pose < poses; ++pose) {
    JointVector at(chain.joints());
    for (int i = 0; i < chain.joints(); ++i) {
      const JointLimits& limits = params.joints[static_cast<std::size_t>(i)].limits;
      at[i] = random.between(std::max(limits.lower_rad, -3.2), std::min(limits.upper_rad, 3.2));
    }
    largest = largest.cwiseMax(chain.mass_matrix(at).diagonal());
  }
  return largest;
}

TEST(LargestInertia, NoPoseOfAnyArmExceedsIt) {
  RandomArm random(41);
  for (std::size_t joints = 1; joints <= most_joints; ++joints) {
    for (int arm = 0; arm < 20; ++arm) {
      Chain::Params params = random.arm(joints);
      for (JointParams& joint : params.joints) {
        if (joint.kind == JointKind::prismatic) joint.limits = {.lower_rad = -0.3, .upper_rad = 0.5};
      }
      const JointVector bound = largest_inertia(params), found = found_at_random(params, random, 200);
      for (Eigen::Index i = 0; i < found.size(); ++i) {
        EXPECT_LE(found[i], bound[i] * (1.0 + 1e-9)) << joints << " joints, joint " << i + 1;
      }
      EXPECT_NEAR(found[found.size() - 1], bound[found.size() - 1], 1e-9 * bound[found.size() - 1])
          << "the last joint has one inertia at all poses";
    }
  }
}

}  // namespace largest_inertia_test
}  // namespace tactus::arm
