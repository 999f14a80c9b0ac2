#include <tactus/interfaces/cli/probe_words.hpp>

#include <gtest/gtest.h>

namespace tactus::cli {
namespace {

using control::ProbeReport;
using control::ProbeVerdict;

std::string said(const ProbeReport& found) {
  devices::RigJoint joint;
  joint.path = "arm.follower.elbow";
  return words_of(found, joint);
}

TEST(ProbeWords, AJointThatDidNotMoveIsStatedWithItsTorqueItsTravelAndWhatToDo) {
  EXPECT_EQ(said({.verdict = ProbeVerdict::still, .force_N = 0.4, .moved_m = 0.00107, .needed_m = 0.002}),
            "; sign probe of arm.follower.elbow: it moved by 1.1 mrad under 0.40 N m, and must move by 2.0 mrad both "
            "ways: let it move freely; if it is heavier or has more friction, raise the probe's most_force_N, or "
            "duration_s (of an arm: its torque in rig.probe_torque)");
}

TEST(ProbeWords, AReversedOneAndOneThatGoesAstrayAreSentencesToo) {
  EXPECT_EQ(said({.verdict = ProbeVerdict::reversed, .force_N = 0.4}),
            "; sign probe of arm.follower.elbow: it moved against the torque of its motor (0.40 N m): correct the "
            "motor's wiring, its encoder or its driver; `sign` of the rig file turns both and does not help");
  EXPECT_EQ(said({.verdict = ProbeVerdict::astray, .force_N = 0.2, .moved_m = 0.21, .most_m = 0.2}),
            "; sign probe of arm.follower.elbow: it moved by 210.0 mrad under 0.20 N m, beyond 200.0 mrad or the same "
            "way for either sign: keep your hand off it; if it is light, lower the probe's force_N");
  EXPECT_EQ(said({}), "");
  EXPECT_EQ(said({.verdict = ProbeVerdict::passed}), "");
}

}  // namespace
}  // namespace tactus::cli
