// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

/// Text as a user sees it: numbers, widths and escaping. Allocates; never for the servo path.
namespace tactus::report {

/// A number for a table. Fixed notation with `significant_digits` (clamped to 1 to 17) for magnitudes from 1e-4 up to
/// 1e6, where digits before the decimal point are never rounded away (1234.5 with three digits is `1235`), and
/// `1.00×10⁻⁷` beyond. Trailing zeros stay, since they show how much is known. An exact zero is `0`, never `-0`; NaN is
/// `–`, infinities are `∞` and `-∞`. The decimal sign is a point in every locale.
std::string number(double value, int significant_digits);

/// A number with so many `decimals` (clamped to 0 to 30) whatever its magnitude, as a column of one unit shows it. What
/// rounds to zero has no sign; NaN and infinities are `-`. The decimal sign is a point in every locale.
std::string fixed(double value, int decimals);

/// `10⁻³`, with the exponent in Unicode superscripts.
std::string power_of_ten(int exponent);

/// `name (unit)`, or what there is of the two. The bracket is tied to the last word of the name.
std::string with_unit(std::string_view name, std::string_view unit);

/// Columns that `text` takes in a terminal: combining and zero-width characters take none, East Asian wide characters
/// and emoji two. Expects text as `printable` leaves it.
std::size_t display_width(std::string_view text);

/// Columns of the terminal that text is written for: 80 until `set_text_width` changes it.
std::size_t text_width();
/// To be called before any text is made, from one thread; less than 40 is taken as 40.
void set_text_width(std::size_t columns);

/// The text as valid UTF-8 on one line: control characters (line breaks and escape sequences of a terminal among them)
/// become blanks, and bytes that are not UTF-8 become U+FFFD.
std::string printable(std::string_view text);

/// The text made safe between tags and inside double-quoted attributes of XML and HTML. Line feeds and tabs stay, other
/// control characters become blanks, bytes that are not UTF-8 become U+FFFD.
std::string escape(std::string_view text);

}  // namespace tactus::report
