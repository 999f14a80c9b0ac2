// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/core/signals.hpp>

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace tactus {
namespace {

struct Pose {
  double position_m = 0.0;
  std::int64_t count = 0;
  static constexpr auto signals() {
    return List{observed("position_m", &Pose::position_m, units::metre, "", "", "", "Where."),
                observed("count", &Pose::count, units::none, "", "", "", "How often.")};
  }
};

/// The same part twice.
struct Both : Part<Pose, "left_">, Part<Pose, "right_"> {
  using Left = Part<Pose, "left_">;
  using Right = Part<Pose, "right_">;
  static constexpr auto signals() { return joined(Left::signals(), Right::signals()); }
};

TEST(Part, OfOneTypeMayStandTwiceInARecordEachUnderItsOwnNames) {
  static_assert(Recordable<Both>);
  Both both;
  both.Left::position_m = 1.5;
  both.Right::position_m = 2.5;
  both.Right::count = 7;
  std::vector<std::string> names;
  std::vector<double> values;
  for_each_signal<Both>([&](const auto& signal) {
    names.emplace_back(signal.name);
    values.push_back(static_cast<double>(both.*signal.member));
    EXPECT_STREQ(signal.unit.suffix, names.size() % 2 == 1 ? units::metre.suffix : units::none.suffix);
  });
  EXPECT_EQ(names, (std::vector<std::string>{"left_position_m", "left_count", "right_position_m", "right_count"}));
  EXPECT_EQ(values, (std::vector<double>{1.5, 0.0, 2.5, 7.0}));
}

}  // namespace
}  // namespace tactus
