// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/core/units.hpp>

#include <set>
#include <string>

#include <gtest/gtest.h>

namespace tactus {
namespace {

TEST(Units, TheLongestEndingThatFitsIsTheUnit) {
  EXPECT_STREQ(unit_at_end_of("torque_N_m").symbol, "N m");
  EXPECT_STREQ(unit_at_end_of("force_N").symbol, "N");
  EXPECT_STREQ(unit_at_end_of("stiffness_N_per_m").symbol, "N/m");
  EXPECT_STREQ(unit_at_end_of("time_ms").symbol, "ms");
}

TEST(Units, ANameWithoutAnEndingOrWithNothingBeforeItHasNoUnit) {
  EXPECT_STREQ(unit_at_end_of("force_gain").symbol, "");
  EXPECT_STREQ(unit_at_end_of("_N").symbol, "");
  EXPECT_STREQ(unit_at_end_of("").symbol, "");
}

TEST(Units, NoTwoUnitsShareAnEnding) {
  std::set<std::string> suffixes;
  for (const Unit& unit : units::known) EXPECT_TRUE(suffixes.insert(unit.suffix).second) << unit.suffix;
}

}  // namespace
}  // namespace tactus
