// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/station/supervised_arms.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <tests/sweeps/arming_bench.hpp>

/// Of the shipped pairs those whose motors differ most from what an experiment's file chose for both arms.
namespace tactus::sweeps {
namespace arming_pairs_test {

const std::vector<ShippedPair>& pairs() {
  static const std::vector<ShippedPair> all = shipped_pairs();
  return all;
}

// The torque that tries the motors of the larger arm is all that a motor of its leader can give. A support that may be
// wrong by so much became active and ran off at 3 rad/s.
TEST(ArmingOfPairs, AGearedLeaderWithAWrongModelIsReleasedBeforeItFollows) {
  constexpr std::int64_t seed = 7;
  constexpr std::size_t masses = 12, reversed = 31;
  for (const std::size_t index : {masses, reversed}) {
    const WrongPair wrong = wrong_pair(pairs(), seed, index);
    ASSERT_NE(wrong.words.find("(leader), held, the same with geared-pair.toml"), std::string::npos) << wrong.words;
    const Arming arming = arm_both(pairs()[wrong.pair], wrong.before, wrong.beliefs);
    // An arm that was released falls, and ends in a fault of its gate.
    EXPECT_EQ(arming.leader.found.fault, control::SupportFault::force) << wrong.words << ": " << words_of(arming);
    EXPECT_FALSE(arming.became_active()) << wrong.words;
    EXPECT_LE(arming.fastest(), 0.5) << wrong.words << ": " << words_of(arming);
    EXPECT_LE(arming.farthest(), 0.03) << wrong.words << ": " << words_of(arming);
  }
}

// Joint 2 of an arm that hangs has more than twice the inertia of one that is bent as at the start of its file.
TEST(ArmingOfPairs, RightPairsThatHangBecomeActive) {
  for (const ShippedPair& pair : pairs()) {
    if (!pair.hangs_freely()) continue;
    const Arming arming = arm_both(pair, Before::hangs, truth_of(pair));
    EXPECT_TRUE(arming.became_active()) << pair.name << ": " << words_of(arming);
  }
}

TEST(ArmingOfPairs, NoSupportMayBeWrongByMoreThanATenthOfWhatItsMotorGivesAndItsFriction) {
  for (const ShippedPair& pair : pairs()) {
    const auto sites = station::arm_sites(pair.setup.params, pair.setup, pair.leader_limits, pair.follower_limits);
    ASSERT_TRUE(sites) << pair.name << ": " << describe(sites.error());
    const auto expect_small = [&](const auto& site, const Joints<station::DeviceLimits>& limits,
                                  const station::DescribedArm& arm) {
      for (std::size_t i = 0; i < limits.size(); ++i) {
        const double friction_N = arm.arm.chain.joints[i].friction.coulomb_N_m;
        const control::SupportCheck::Params& joint = site.support().checks()[i].params();
        EXPECT_LE(joint.least_force_N, 0.1 * limits[i].force_N + friction_N + 1e-12)
            << pair.name << ", joint " << i + 1;
        EXPECT_LE(joint.least_force_N, joint.trial_force_N) << pair.name << ", joint " << i + 1;
      }
    };
    expect_small(sites->master(), pair.leader_limits, pair.setup.leader);
    expect_small(sites->slave(), pair.follower_limits, pair.setup.follower);
  }
}

}  // namespace arming_pairs_test
}  // namespace tactus::sweeps
