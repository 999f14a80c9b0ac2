// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/tasks/bytes.hpp>

#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include <gtest/gtest.h>

namespace tactus::tasks {
namespace {

TEST(Bytes, NumbersComeBackWithAllTheirBits) {
  const std::string bytes = ByteWriter()
                                .put(-0.0)
                                .put(std::numeric_limits<double>::denorm_min())
                                .put(std::optional<double>())
                                .put(std::optional(0.1))
                                .put(true)
                                .put(std::string_view("a\0b", 3))
                                .take();
  ByteReader reader(bytes);
  const auto zero = reader.get<double>();
  EXPECT_TRUE(zero == 0.0 && std::signbit(zero));
  EXPECT_EQ(reader.get<double>(), std::numeric_limits<double>::denorm_min());
  std::optional<double> none = 1.0, some;
  reader.get(none);
  reader.get(some);
  EXPECT_FALSE(none);
  EXPECT_EQ(some, 0.1);
  EXPECT_TRUE(reader.get<bool>());
  EXPECT_FALSE(reader.complete());
  std::string text;
  reader.get(text);
  EXPECT_EQ(text, std::string("a\0b", 3));
  EXPECT_TRUE(reader.complete());
}

TEST(Bytes, FewerBytesThanAreReadGiveZerosAndAreNoticed) {
  const std::string bytes = ByteWriter().put(7).take();
  ByteReader reader(bytes);
  EXPECT_EQ(reader.get<double>(), 0.0);
  EXPECT_FALSE(reader.complete());
  ByteReader text_reader(bytes);
  std::string text;
  text_reader.get(text);
  EXPECT_FALSE(text_reader.complete());
  const std::string too_long = ByteWriter().put(std::uint64_t{1} << 60).take();
  ByteReader long_reader(too_long);
  long_reader.get(text);
  EXPECT_EQ(text, "");
  EXPECT_FALSE(long_reader.complete());
}

}  // namespace
}  // namespace tactus::tasks
