// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>

#include <limits>

#include <gtest/gtest.h>

namespace tactus::report {
namespace text_test {

TEST(Number, HasTheSignificantDigitsAskedFor) {
  EXPECT_EQ(number(0.012345, 3), "0.0123");
  EXPECT_EQ(number(1.0, 3), "1.00");
  EXPECT_EQ(number(-49.24, 3), "-49.2");
  EXPECT_EQ(number(0.1, 17), "0.10000000000000001");
}

TEST(Number, RoundsIntoANewDigit) {
  EXPECT_EQ(number(9.996, 3), "10.0");
  EXPECT_EQ(number(0.0009999, 2), "0.0010");
}

TEST(Number, KeepsEveryDigitBeforeThePoint) { EXPECT_EQ(number(123456.7, 2), "123457"); }

TEST(Number, IsReadableForVerySmallAndVeryLargeMagnitudes) {
  EXPECT_EQ(number(1e-7, 3), "1.00×10⁻⁷");
  EXPECT_EQ(number(-1.5e7, 2), "-1.5×10⁷");
  EXPECT_EQ(number(999999.9, 3), "1.00×10⁶");
  EXPECT_EQ(number(3.125e13, 4), "3.125×10¹³");
  EXPECT_EQ(number(1e-4, 2), "0.00010");
}

TEST(Number, IsNeverMinusZeroAndNamesWhatIsNotFinite) {
  EXPECT_EQ(number(-0.0, 3), "0");
  EXPECT_EQ(number(0.0, 3), "0");
  EXPECT_EQ(number(std::numeric_limits<double>::quiet_NaN(), 3), "–");
  EXPECT_EQ(number(std::numeric_limits<double>::infinity(), 3), "∞");
  EXPECT_EQ(number(-std::numeric_limits<double>::infinity(), 3), "-∞");
}

TEST(Number, TakesAnyCountOfDigitsAndAnyMagnitude) {
  EXPECT_EQ(number(12.5, 0), "12");  // one digit; half goes to even
  EXPECT_EQ(number(12.5, 99), "12.500000000000000");
  EXPECT_EQ(number(std::numeric_limits<double>::max(), 2), "1.8×10³⁰⁸");
  EXPECT_EQ(number(5e-324, 1), "5×10⁻³²⁴");
}

TEST(Fixed, HasTheDecimalsAskedForWhateverTheMagnitude) {
  EXPECT_EQ(fixed(1234.5678, 2), "1234.57");
  EXPECT_EQ(fixed(-0.04, 1), "0.0");
  EXPECT_EQ(fixed(-0.06, 1), "-0.1");
  EXPECT_EQ(fixed(2.0, -3), "2");
  EXPECT_EQ(fixed(std::numeric_limits<double>::max(), 99).size(), 309 + 1 + 30);
  EXPECT_EQ(fixed(std::numeric_limits<double>::quiet_NaN(), 3), "-");
  EXPECT_EQ(fixed(-std::numeric_limits<double>::infinity(), 3), "-");
}

TEST(DisplayWidth, CountsColumnsOfTheTerminalNotBytes) {
  EXPECT_EQ(display_width("force"), 5U);
  EXPECT_EQ(display_width("λ·µ – 10⁻³"), 10U);
  EXPECT_EQ(display_width("x\u0302"), 1U);  // x with a combining circumflex
  EXPECT_EQ(display_width("力"), 2U);
  EXPECT_EQ(display_width(""), 0U);
}

TEST(Printable, LetsNoControlCharacterReachTheTerminal) {
  EXPECT_EQ(printable("a\x1b[31mb\nc\x7f"), "a [31mb c ");
  EXPECT_EQ(printable("\u0085"), " ");
}

TEST(Printable, ReplacesBytesThatAreNotUtf8) {
  EXPECT_EQ(printable("a\xff"
                      "b"),
            "a\uFFFDb");
  EXPECT_EQ(printable("\xc3"), "\uFFFD");                      // cut off
  EXPECT_EQ(printable("\xc0\xaf"), "\uFFFD\uFFFD");            // overlong
  EXPECT_EQ(printable("\xed\xa0\x80"), "\uFFFD\uFFFD\uFFFD");  // surrogate
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\uFFFD\uFFFD\uFFFD\uFFFD");
  EXPECT_EQ(printable("µ力\U0001F600"), "µ力\U0001F600");
}

TEST(Escape, MakesEveryReservedCharacterInert) {
  EXPECT_EQ(escape("<a href=\"x\">'&amp;'</a>"), "&lt;a href=&quot;x&quot;&gt;&#39;&amp;amp;&#39;&lt;/a&gt;");
  EXPECT_EQ(escape("a\nb\tc\rd\x01"), "a\nb\tc d ");
  EXPECT_EQ(escape("\xfe µ \uFFFE"), "\uFFFD µ  ");
}

TEST(WithUnit, TiesTheBracketToTheName) {
  EXPECT_EQ(with_unit("force on the hand", "N"), "force on the hand\u00A0(N)");
  EXPECT_EQ(with_unit("sample", ""), "sample");
  EXPECT_EQ(with_unit("", "N"), "(N)");
}

}  // namespace text_test
}  // namespace tactus::report
