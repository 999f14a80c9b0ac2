// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>

namespace tactus::report {
namespace {

struct Character {
  char32_t code;
  std::size_t bytes;
};

constexpr char32_t replacement = 0xFFFD;

/// The character at the start of `text`, which is not empty. Overlong forms, surrogates, values beyond U+10FFFF and
/// incomplete sequences decode to U+FFFD and consume one byte.
Character decode(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  const std::uint8_t first = byte(0);
  if (first < 0x80) return {first, 1};
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < length) return {replacement, 1};
  char32_t code = first & (0xFFU >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return {replacement, 1};
    code = (code << 6) | (byte(i) & 0x3FU);
  }
  constexpr std::array<char32_t, 5> smallest{0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xD800 && code <= 0xDFFF;
  if (code < smallest[length] || surrogate || code > 0x10FFFF) return {replacement, 1};
  return {code, length};
}

bool is_control(char32_t code) { return code < 0x20 || (code >= 0x7F && code < 0xA0); }

struct Range {
  char32_t first, last;
};

// Unicode 15, reduced to whole blocks: what labels in engineering reports can meet.
constexpr std::array<Range, 9> zero_width{{{0x0300, 0x036F},
                                           {0x0483, 0x0489},
                                           {0x1AB0, 0x1AFF},
                                           {0x1DC0, 0x1DFF},
                                           {0x200B, 0x200F},
                                           {0x2060, 0x2064},
                                           {0x20D0, 0x20F0},
                                           {0xFE00, 0xFE0F},
                                           {0xFE20, 0xFE2F}}};
constexpr std::array<Range, 9> double_width{{{0x1100, 0x115F},
                                             {0x2E80, 0x303E},
                                             {0x3041, 0xA4CF},
                                             {0xAC00, 0xD7A3},
                                             {0xF900, 0xFAFF},
                                             {0xFE30, 0xFE4F},
                                             {0xFF00, 0xFF60},
                                             {0xFFE0, 0xFFE6},
                                             {0x1F300, 0x1FAFF}}};

template <std::size_t N>
bool within(const std::array<Range, N>& ranges, char32_t code) {
  return std::any_of(ranges.begin(), ranges.end(), [&](Range r) { return code >= r.first && code <= r.last; });
}

/// Rewrites every character through `write(out, code, bytes of the character)`.
template <class Write>
std::string rewrite(std::string_view text, Write&& write) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const Character character = decode(text);
    const bool broken = character.code == replacement && character.bytes == 1;
    write(out, character.code, broken ? std::string_view("\uFFFD") : text.substr(0, character.bytes));
    text.remove_prefix(character.bytes);
  }
  return out;
}

}  // namespace

std::string fixed(double value, int decimals) {
  if (!std::isfinite(value)) return "-";
  std::array<char, 400> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), std::abs(value),
                                 std::chars_format::fixed, std::clamp(decimals, 0, 30))
                       .ptr;
  const std::string digits(buffer.data(), end);
  const bool zero = digits.find_first_not_of("0.") == std::string::npos;
  return value < 0.0 && !zero ? "-" + digits : digits;
}

std::string power_of_ten(int exponent) {
  constexpr std::array<const char*, 10> digits{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = exponent < 0 ? "10⁻" : "10";
  for (const char digit : std::to_string(std::abs(exponent))) text += digits[static_cast<std::size_t>(digit - '0')];
  return text;
}

std::string number(double value, int significant_digits) {
  if (std::isnan(value)) return "–";
  if (std::isinf(value)) return value < 0 ? "-∞" : "∞";
  if (value == 0.0) return "0";
  const int decimals = std::clamp(significant_digits, 1, 17) - 1;
  // Rounding can carry into a new digit (9.996 becomes 10.0), so the exponent is taken from the rounded text.
  std::array<char, 64> buffer{};
  char* const end = buffer.data() + buffer.size();
  char* last = std::to_chars(buffer.data(), end, value, std::chars_format::scientific, decimals).ptr;
  const std::string scientific(buffer.data(), last);
  const std::size_t e = scientific.find('e');
  const int exponent = std::atoi(scientific.c_str() + e + 1);
  if (exponent < -4 || exponent >= 6) return scientific.substr(0, e) + "×" + power_of_ten(exponent);
  last = std::to_chars(buffer.data(), end, value, std::chars_format::fixed, std::max(0, decimals - exponent)).ptr;
  return std::string(buffer.data(), last);
}

std::string with_unit(std::string_view name, std::string_view unit) {
  if (unit.empty()) return std::string(name);
  std::string text(name);
  if (!text.empty()) text += "\u00A0";
  text += '(';
  text += unit;
  text += ')';
  return text;
}

std::size_t display_width(std::string_view text) {
  std::size_t width = 0;
  while (!text.empty()) {
    const Character character = decode(text);
    if (!within(zero_width, character.code)) width += within(double_width, character.code) ? 2U : 1U;
    text.remove_prefix(character.bytes);
  }
  return width;
}

std::string printable(std::string_view text) {
  return rewrite(text, [](std::string& out, char32_t code, std::string_view bytes) {
    out += is_control(code) ? std::string_view(" ") : bytes;
  });
}

std::string escape(std::string_view text) {
  return rewrite(text, [](std::string& out, char32_t code, std::string_view bytes) {
    switch (code) {
      case U'&':
        out += "&amp;";
        break;
      case U'<':
        out += "&lt;";
        break;
      case U'>':
        out += "&gt;";
        break;
      case U'"':
        out += "&quot;";
        break;
      case U'\'':
        out += "&#39;";
        break;
      default:
        // XML 1.0 forbids most control characters and the two non-characters, even when escaped.
        if (code == 0xFFFE || code == 0xFFFF || (is_control(code) && code != U'\n' && code != U'\t')) {
          out += ' ';
        } else {
          out += bytes;
        }
    }
  });
}

namespace {
std::size_t columns_of_terminal = 80;
}  // namespace

std::size_t text_width() { return columns_of_terminal; }

void set_text_width(std::size_t columns) { columns_of_terminal = std::max<std::size_t>(40, columns); }

}  // namespace tactus::report
