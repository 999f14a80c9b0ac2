// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/core/parameters.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

namespace tactus {

std::string format_number(double value) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  return std::string(buffer, end);
}

std::string rounded_number(double value) {
  std::string exact = format_number(value);
  const std::string_view digits = std::string_view(exact).substr(0, exact.find('e'));
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  if (std::count_if(digits.begin(), digits.end(), is_digit) <= 9) return exact;
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, 6).ptr;
  return std::string(buffer, end);
}

namespace {
std::string with_unit(double value, const Unit& unit) {
  std::string text = rounded_number(value);
  if (unit.symbol[0] != '\0') text += std::string(" ") + unit.symbol;
  return text;
}
}  // namespace

std::string describe_bounds(const Bounds& bounds, const Unit& unit) {
  const bool below = std::isfinite(bounds.lower);
  const bool above = std::isfinite(bounds.upper);
  const std::string lower = bounds.lower_open ? "greater than " : "at least ";
  if (below && above) {
    return "must be " + lower + with_unit(bounds.lower, unit) + " and at most " + with_unit(bounds.upper, unit);
  }
  if (below) return "must be finite and " + lower + with_unit(bounds.lower, unit);
  if (above) return "must be finite and at most " + with_unit(bounds.upper, unit);
  return "must be finite";
}

Error out_of_bounds(std::string_view parameter, double value, const Bounds& bounds, const Unit& unit) {
  // A value that is outside by less than the rounding is shown exactly.
  const std::string text = format_number(value), rounded = rounded_number(value);
  double shown = value;
  if (rounded != text) {
    constexpr double digits = 6.0;  // as rounded_number has
    const double scale = std::pow(10.0, digits - 1.0 - std::floor(std::log10(std::abs(value))));
    shown = std::round(value * scale) / scale;
  }
  const std::string unit_text = unit.symbol[0] == '\0' ? "" : std::string(" ") + unit.symbol;
  const std::string given = (bounds.contain(shown) ? text : rounded) + unit_text;
  return {.code = ErrorCode::out_of_bounds,
          .parameter = std::string(parameter),
          .message = given + " is out of bounds: it " + describe_bounds(bounds, unit),
          .place = {},
          .value = given,
          .bounds = describe_bounds(bounds, unit)};
}

namespace detail {

void check_number(const Key& key, double value, Check& found) {
  if (!key.bounds.contain(value)) found = out_of_bounds(key.name, value, key.bounds, key.unit);
}

void found_in(const char* group, Check& found) {
  if (found) found = under(group, *std::move(found));
}

}  // namespace detail

}  // namespace tactus
