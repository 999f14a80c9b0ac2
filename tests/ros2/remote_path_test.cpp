// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/ros2/remote_path.hpp>

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace tactus {
namespace {

using ros2::RemotePath;
constexpr Seconds tick{1e-3};

TEST(RemotePath, WithoutAWishTheHandFollowsTheScript) {
  RemotePath path = RemotePath::make({}, tick).value();
  for (const double scripted_m : {0.0, 0.01, -0.02, 0.3}) EXPECT_EQ(path.step({.scripted_m = scripted_m}), scripted_m);
  EXPECT_FALSE(path.driven());
}

TEST(RemotePath, AWishIsFollowedFromWhereTheHandIsNoFasterThanAllowed) {
  RemotePath path = RemotePath::make({.fastest_m_per_s = 0.5}, tick).value();
  path.step({.scripted_m = 0.01});
  // 0.5 m/s for 1 ms is 0.5 mm, so 2 mm take four ticks.
  EXPECT_DOUBLE_EQ(path.step({.scripted_m = 0.05, .requested_m = 0.012}), 0.0105);
  EXPECT_DOUBLE_EQ(path.step({.scripted_m = 0.05}), 0.011);
  EXPECT_DOUBLE_EQ(path.step({.scripted_m = 0.05}), 0.0115);
  EXPECT_DOUBLE_EQ(path.step({.scripted_m = 0.05}), 0.012);
  EXPECT_DOUBLE_EQ(path.step({.scripted_m = 0.05}), 0.012);
  EXPECT_TRUE(path.driven());
}

TEST(RemotePath, WhenTheOtherProgramFallsSilentTheHandStaysWhereItIs) {
  RemotePath path = RemotePath::make({.fastest_m_per_s = 0.5, .timeout_s = 0.02}, tick).value();
  path.step({.requested_m = 0.1});
  double before = 0.0;
  for (int i = 0; i < 20; ++i) before = path.step({.scripted_m = -0.1});
  EXPECT_DOUBLE_EQ(before, 0.0105);
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(path.step({.scripted_m = -0.1}), before);
  EXPECT_GT(path.step({.requested_m = 0.1}), before);
}

TEST(RemotePath, AWishThatIsNoNumberIsNone) {
  RemotePath path = RemotePath::make({}, tick).value();
  path.step({.scripted_m = 0.02});
  for (const double wish : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(path.step({.scripted_m = 0.03, .requested_m = wish}), 0.03);
  }
  EXPECT_FALSE(path.driven());
}

RC_GTEST_PROP(RemotePath, NoWishLeavesTheReachOrExceedsTheSpeed, ()) {
  const auto requests = *rc::gen::container<std::vector<double>>(rc::gen::arbitrary<double>());
  const RemotePath::Params params{.lowest_m = -0.03, .highest_m = 0.05, .fastest_m_per_s = 0.2};
  RemotePath path = RemotePath::make(params, tick).value();
  double before = path.step({});
  for (const double wish : requests) {
    const double now = path.step({.requested_m = wish});
    RC_ASSERT(std::isfinite(now));
    RC_ASSERT(now >= params.lowest_m && now <= params.highest_m);
    RC_ASSERT(std::fabs(now - before) <= 0.2e-3 * (1 + 1e-12));
    before = now;
  }
}

TEST(RemotePath, AReachThatIsInsideOutIsRefusedByName) {
  const auto path = RemotePath::make({.lowest_m = 0.1, .highest_m = -0.1}, tick);
  ASSERT_FALSE(path);
  EXPECT_EQ(path.error().parameter, "lowest_m");
}

}  // namespace
}  // namespace tactus
