// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/probe_words.hpp>

#include <gtest/gtest.h>

namespace tactus::cli {
namespace probe_words_test {

using control::ProbeReport;
using control::ProbeVerdict;

std::string words(const ProbeReport& found) {
  devices::RigJoint joint;
  joint.path = "arm.follower.elbow";
  return words_of(found, joint);
}

TEST(ProbeWords, AJointThatDidNotMoveIsStatedWithItsTorqueItsTravelAndWhatToDo) {
  EXPECT_EQ(words({.verdict = ProbeVerdict::still, .force_N = 0.4, .moved_m = 0.00107, .needed_m = 0.002}),
            "; sign probe of arm.follower.elbow: it moved by 1.1 mrad under 0.40 N m, and must move by 2.0 mrad both "
            "ways: let it move freely; if it is heavier or has more friction, raise the probe's most_force_N, or "
            "duration_s (of an arm: its torque in rig.probe_torque)");
}

TEST(ProbeWords, AReversedOneAndOneThatGoesAstrayAreSentencesToo) {
  EXPECT_EQ(words({.verdict = ProbeVerdict::reversed, .force_N = 0.4}),
            "; sign probe of arm.follower.elbow: it moved against the torque of its motor (0.40 N m): correct the "
            "motor's wiring, its encoder or its driver; `sign` of the rig file turns both and does not help");
  EXPECT_EQ(words({.verdict = ProbeVerdict::astray, .force_N = 0.2, .moved_m = 0.21, .most_m = 0.2}),
            "; sign probe of arm.follower.elbow: it moved by 210.0 mrad under 0.20 N m, beyond 200.0 mrad: if it is "
            "light, lower the probe's force_N, or hold it lightly");
  EXPECT_EQ(words({.verdict = ProbeVerdict::astray, .force_N = 0.2, .moved_m = 0.02, .most_m = 0.2}),
            "; sign probe of arm.follower.elbow: it moved by 20.0 mrad under 0.20 N m, the same way for either sign: "
            "keep your hand off it until it is tested");
  EXPECT_EQ(words({}), "");
  EXPECT_EQ(words({.verdict = ProbeVerdict::passed}), "");
}

}  // namespace probe_words_test
}  // namespace tactus::cli
