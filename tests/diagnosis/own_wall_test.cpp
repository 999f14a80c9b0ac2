// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/diagnosis/own_wall.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::diagnosis {
namespace own_wall_test {

constexpr double frequency_Hz = 8.0;

/// Four seconds at 1 kHz of a position, and of a force that is computed each `hold` samples from the position of 2 ms
/// before.
struct Made {
  std::vector<double> position, force;
};
template <class Law>
Made made(std::size_t hold, Law law) {
  Made all;
  for (std::size_t i = 0; i < 4000; ++i) {
    all.position.push_back(2e-3 * std::sin(2.0 * std::numbers::pi * frequency_Hz * 1e-3 * static_cast<double>(i)));
    const bool update = i % hold == 0;
    all.force.push_back(update ? law(i >= 2 ? all.position[i - 2] : 0.0, i) : all.force.back());
  }
  return all;
}

std::optional<OwnWall> found(const Made& one) {
  return find_own_wall(one.force, one.position, frequency_Hz, Seconds{1e-3});
}

TEST(OwnWall, ASpringFromAPlaceOnIsFoundWithItsHoldAndDelay) {
  const auto wall = found(made(10, [](double x, std::size_t) { return std::max(0.0, 1000.0 * x); }));
  ASSERT_TRUE(wall);
  EXPECT_FALSE(wall->switched);
  EXPECT_GT(wall->explained, 0.99);
  EXPECT_NEAR(wall->held_s, 0.01, 1e-9);
  EXPECT_NEAR(wall->delay_s, 2e-3, 1e-9);
}

TEST(OwnWall, AForceOfTwoLevelsIsSwitched) {
  const auto wall = found(made(1, [](double x, std::size_t) { return x > 5e-4 ? 5.0 : 0.0; }));
  ASSERT_TRUE(wall);
  EXPECT_TRUE(wall->switched);
  EXPECT_GT(wall->explained, 0.99);
}

TEST(OwnWall, AForceOfAnotherOriginIsNotExplained) {
  const auto other =
      found(made(1, [](double, std::size_t i) { return 1.0 + std::sin(0.09 * static_cast<double>(i)); }));
  ASSERT_TRUE(other);
  EXPECT_LT(other->explained, 0.3);
  const auto attracts = found(made(10, [](double x, std::size_t) { return std::max(0.0, -1000.0 * x); }));
  ASSERT_TRUE(attracts);
  EXPECT_LT(attracts->explained, 0.1);
  const auto pulls_too = found(made(10, [](double x, std::size_t) { return std::clamp(3000.0 * x, -2.0, 2.0); }));
  ASSERT_TRUE(pulls_too);
  EXPECT_EQ(pulls_too->explained, 0.0) << "a coupling that reaches its limits on both sides is no wall";
  EXPECT_FALSE(found(made(1, [](double, std::size_t) { return 1.0; })));
}

}  // namespace own_wall_test
}  // namespace tactus::diagnosis
