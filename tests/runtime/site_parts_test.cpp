// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/agreement.hpp>
#include <tactus/runtime/servo/site_parts.hpp>

#include <cstdint>
#include <string>

#include <gtest/gtest.h>

namespace tactus::runtime {
namespace site_parts_test {

control::Agreement of_cells(std::size_t cells) {
  control::Agreement agreement;
  agreement.add_to_digest("joint 1 of the rig: shoulder in rad");
  for (std::uint64_t cell = 0; cell < cells; ++cell) agreement.add("key", 0xfedcba9876543210U ^ cell << 40U);
  return agreement;
}

// Which cell a packet tells goes by its number and by how many there are, so the digest is not enough.
TEST(SiteParts, AnAgreementOfALogTellsWhatTheOneBeforeTold) {
  for (const std::size_t cells : {std::size_t{0}, std::size_t{7}, control::Agreement::most_cells}) {
    const control::Agreement before = of_cells(cells);
    const auto after = agreement_from(text_of(before));
    ASSERT_TRUE(after) << text_of(before);
    EXPECT_EQ(after->size(), before.size());
    for (std::int64_t packet = 1; packet < 300; ++packet) {
      const auto told = before.excerpt(packet), again = after->excerpt(packet);
      EXPECT_EQ(again.digest, told.digest);
      EXPECT_EQ(again.cell, told.cell);
      EXPECT_EQ(again.value, told.value);
    }
  }
}

TEST(SiteParts, WhatIsNoAgreementIsNone) {
  const std::string too_long = text_of(of_cells(control::Agreement::most_cells)) + " 1";
  for (const std::string& text : {std::string(), std::string("no number"), std::string("12 34 x"), std::string("12 -"),
                                  std::string("12 11112222333344445"), too_long}) {
    EXPECT_FALSE(agreement_from(text)) << text;
  }
}

}  // namespace site_parts_test
}  // namespace tactus::runtime
