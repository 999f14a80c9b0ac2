// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/advice/methods.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

namespace tactus::advice {
namespace methods_test {

std::vector<Method> all() { return combine(position_force_dimensions({}), 2); }

TEST(Methods, AreEveryCombinationOfAtMostTwoStagesAndOneFilterTheSimplestFirst) {
  const auto methods = all();
  // Without cancellation, with it, and with an estimate of the grip within it: none, 7 alone; damping (2) with
  // compensation (1) or a filter (4), compensation with a filter (4).
  EXPECT_EQ(methods.size(), 3U * (1U + 7U + 2U + 8U + 4U));
  EXPECT_EQ(methods[0].words(), "no stage");
  EXPECT_EQ(methods[1].words(), "cancellation");
  EXPECT_EQ(methods[2].words(), "cancellation and an estimate of the grip");
  for (std::size_t i = 0; i < methods.size(); ++i) {
    EXPECT_EQ(std::count(methods.begin(), methods.end(), methods[i]), 1) << methods[i].words();
  }
}

TEST(Methods, EachSaysEveryKeyThatIsSearchedSoThatNothingOfTheFileIsLeftOn) {
  for (const Method& method : all()) {
    const auto settings = method.settings();
    for (const char* key : {"control.architecture", "control.cancellation", "control.operator_estimate",
                            "control.damping.damping_N_s_per_m", "control.hand_compensation_Hz",
                            "control.command_filter.kind", "control.force_filter.kind"}) {
      EXPECT_EQ(std::count_if(settings.begin(), settings.end(), [&](const auto& one) { return one.first == key; }), 1)
          << method.words() << " " << key;
    }
  }
}

TEST(Methods, ANotchStandsAtTheModeOfTheMasterInTheHand) {
  const auto frequency = [](const control::MasterModel& model) {
    return std::stod(position_force_dimensions(model)[5][1].settings[1].second);
  };
  // A hand that gives nowhere leaves motor and drum on the linkage.
  control::MasterModel held;
  held.hand.damping_N_s_per_m = 1e5;
  const double mass_kg = held.motor.mass_kg + held.drum.mass_kg;
  EXPECT_NEAR(frequency(held), std::sqrt(held.linkage.stiffness_N_per_m / mass_kg) / (2.0 * std::numbers::pi), 0.1);
  EXPECT_NE(frequency({}), frequency(held));
}

TEST(Methods, ATunedNumberStandsInTheWordsAndNothingElseOfTheMethodMoves) {
  const auto methods = all();
  const auto damped = std::find_if(methods.begin(), methods.end(), [](const Method& method) {
    return method.words() == "cancellation and local damping of 5 N s/m";
  });
  ASSERT_NE(damped, methods.end());
  const auto tuned = retuned(*damped);
  ASSERT_EQ(tuned.size(), 2U);
  EXPECT_EQ(tuned[0].words(), "cancellation and local damping of 3.5 N s/m");
  EXPECT_EQ(tuned[1].words(), "cancellation and local damping of 7 N s/m");
  auto before = damped->settings(), after = tuned[0].settings();
  ASSERT_EQ(before.size(), after.size());
  std::size_t moved = 0;
  for (std::size_t i = 0; i < before.size(); ++i) moved += before[i] == after[i] ? 0U : 1U;
  EXPECT_EQ(moved, 1U);
  EXPECT_TRUE(retuned(methods.front()).empty());
}

TEST(Methods, AnEstimateOfTheGripIsTriedWithCancellationAlone) {
  std::size_t following = 0;
  for (const Method& method : all()) {
    if (!method.has(grip_estimate)) continue;
    ++following;
    EXPECT_TRUE(method.has("cancellation")) << method.words();
  }
  EXPECT_EQ(following, all().size() / 3);
}

TEST(Methods, ANumberIsRoundedToThreeDigits) {
  EXPECT_EQ(rounded(22.6543), 22.7);
  EXPECT_EQ(rounded(0.0123456), 0.0123);
  EXPECT_EQ(rounded(0.0), 0.0);
}

}  // namespace methods_test
}  // namespace tactus::advice
