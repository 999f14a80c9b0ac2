#include <tactus/configuration/nearest.hpp>

#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <tests/configuration/experiment.hpp>

namespace tactus::configuration {
namespace {

TEST(Nearest, SlipsCountLettersMissingAddedReplacedAndSwapped) {
  EXPECT_EQ(slips("", ""), 0U);
  EXPECT_EQ(slips("gain", "gain"), 0U);
  EXPECT_EQ(slips("gain", "GAIN"), 0U);
  EXPECT_EQ(slips("gain", "gin"), 1U);
  EXPECT_EQ(slips("gain", "gaint"), 1U);
  EXPECT_EQ(slips("gain", "gaim"), 1U);
  EXPECT_EQ(slips("gain", "agin"), 1U);
  EXPECT_EQ(slips("kitten", "sitting"), 3U);
  EXPECT_EQ(slips("", "abc"), 3U);
  EXPECT_EQ(slips("ca", "abc"), 3U) << "the restricted distance edits no swapped pair again";
}

TEST(Nearest, NothingIsSuggestedWhereNothingIsNear) {
  const std::vector<std::string_view> words{"off", "model", "adaptive"};
  EXPECT_EQ(nearest_word("of", words), "off");
  EXPECT_EQ(nearest_word("Model", words), "model");
  EXPECT_EQ(nearest_word("adaptve", words), "adaptive");
  EXPECT_EQ(nearest_word("on", words), "");
  EXPECT_EQ(nearest_word("", words), "");
  EXPECT_EQ(nearest_word("something else", words), "");
  EXPECT_EQ(nearest_word("x", std::vector<std::string_view>{"y"}), "");
}

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
