// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/nearest.hpp>

#include <vector>

#include <gtest/gtest.h>
#include <tests/configuration/experiment.hpp>

namespace tactus::configuration {
namespace {

TEST(Nearest, OfEquallyNearKeysTheOneInTheNearerSectionIsMeant) {
  testing::Slave left;
  testing::Slave right;
  std::vector<Binding> bindings = bind(left, "left");
  for (const Binding& binding : bind(right, "right")) bindings.push_back(binding);
  EXPECT_EQ(nearest_path("right.mas_kg", false, bindings), "right.mass_kg");
  EXPECT_EQ(nearest_path("left.mas_kg", false, bindings), "left.mass_kg");
  EXPECT_EQ(nearest_path("right.mass", false, bindings), "right.mass_kg");
  EXPECT_EQ(nearest_path("rihgt", true, bindings), "right");
  EXPECT_EQ(nearest_path("rihgt", false, bindings), "") << "a section is no value";
}

TEST(Nearest, AUnitAloneDoesNotMakeTwoKeysAlike) {
  testing::Slave slave;
  const std::vector<Binding> bindings = bind(slave);
  EXPECT_EQ(nearest_path("x_N_per_m", false, bindings), "");
  EXPECT_EQ(nearest_path("mass_g", false, bindings), "mass_kg");
}

}  // namespace
}  // namespace tactus::configuration
