// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/core/joints.hpp>

#include <string>
#include <type_traits>

#include <gtest/gtest.h>

namespace tactus {
namespace {

static_assert(std::is_same_v<Each<double, int>, int>);
static_assert(std::is_same_v<Each<Joints<double>, int>, Joints<int>>);
static_assert(std::is_same_v<JointOf<Joints<double>>, double>);
static_assert(std::is_same_v<JointOf<double>, double>);
static_assert(std::is_trivially_copyable_v<Joints<double>>);

TEST(Joints, HoldAsManyAsTheyWereMadeWith) {
  Joints<double> joints(3, 0.5);
  joints[1] = 2.0;
  double sum = 0.0;
  for (const double each : joints) sum += each;
  EXPECT_EQ(joints.size(), 3U);
  EXPECT_EQ(sum, 3.0);
  EXPECT_EQ(Joints<double>().size(), 0U);
}

TEST(Joints, WhatIsWrittenForOneAxisRunsForEachJoint) {
  const auto add = [](auto& to, const auto& from) {
    for_each_joint([](double& each, double other) { each += other; }, to, from);
  };
  double axis = 1.0;
  add(axis, 2.0);
  EXPECT_EQ(axis, 3.0);
  Joints<double> arm(2, 1.0), more(2, 2.0);
  more[1] = 5.0;
  add(arm, more);
  EXPECT_EQ(arm[0], 3.0);
  EXPECT_EQ(arm[1], 6.0);
}

TEST(Joints, AMemberOfEachIsTakenAsJointsOrAsItself) {
  struct Pair {
    double left = 1.0, right = 2.0;
  };
  EXPECT_EQ(member_of_each(Pair{}, &Pair::right), 2.0);
  Joints<Pair> pairs(2);
  pairs[1].right = 7.0;
  const Joints<double> rights = member_of_each(pairs, &Pair::right);
  EXPECT_EQ(rights[0], 2.0);
  EXPECT_EQ(rights[1], 7.0);
}

/// An element that refuses what is negative.
struct Root {
  double value = 0.0;
  static Result<Root> make(double square, Seconds) {
    if (square < 0.0) return Error{.code = ErrorCode::out_of_bounds, .parameter = "square", .message = {}, .place = {}};
    return Root{std::sqrt(square)};
  }
};

TEST(Joints, AnElementIsMadeForEachAndAnErrorNamesTheJoint) {
  EXPECT_EQ(make_each<Root>(4.0, Seconds{1.0})->value, 2.0);
  EXPECT_EQ(make_each<Root>(-1.0, Seconds{1.0}).error().parameter, "square");
  Joints<double> squares(2, 4.0);
  squares[1] = 9.0;
  EXPECT_EQ((*make_each<Root>(squares, Seconds{1.0}))[1].value, 3.0);
  squares[1] = -9.0;
  EXPECT_EQ(make_each<Root>(squares, Seconds{1.0}).error().parameter, "joint_2.square");
}

}  // namespace
}  // namespace tactus
