// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/core/spelling.hpp>

#include <string_view>
#include <vector>

#include <gtest/gtest.h>

namespace tactus {
namespace {

TEST(Spelling, SlipsCountLettersMissingAddedReplacedAndSwapped) {
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

TEST(Spelling, NothingIsSuggestedWhereNothingIsNear) {
  const std::vector<std::string_view> words{"off", "model", "adaptive"};
  EXPECT_EQ(nearest_word("of", words), "off");
  EXPECT_EQ(nearest_word("Model", words), "model");
  EXPECT_EQ(nearest_word("adaptve", words), "adaptive");
  EXPECT_EQ(nearest_word("on", words), "");
  EXPECT_EQ(nearest_word("", words), "");
  EXPECT_EQ(nearest_word("something else", words), "");
  EXPECT_EQ(nearest_word("no", std::vector<std::string_view>{"on", "yes"}), "") << "the opposite";
  EXPECT_EQ(nearest_word("ON", std::vector<std::string_view>{"on"}), "on");
  EXPECT_EQ(nearest_word("x", std::vector<std::string_view>{"y"}), "");
}

}  // namespace
}  // namespace tactus
